#include "api.h"
#include "collocation.hpp"
#include "loci.hpp"
#include "moving_mesh.hpp"
#include "math.hpp"
#include "record.hpp"
#include "march.hpp"
#include "scan.hpp"
#include "simulation.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

// Whether this processor and its operating system can run the variant `avx2`.
EXPORT whole core_avx2() {
#if defined(__x86_64__)
    unsigned a, b, c, d;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & (1u << 27)) || !(c & (1u << 28))) return 0;
    unsigned low, high;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 6) != 6) return 0;  // the system keeps the wide registers
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return 0;
    return (b >> 5) & 1;
#else
    return 0;
#endif
}

// The sources from which this library was built.
EXPORT const char* core_digest() { return CORE_DIGEST; }

EXPORT void core_sines_cosines(whole count, const double* x, double* sines, double* cosines) {
    for (whole i = 0; i < count; i++) {
        double s, c;
        sine_cosine(x[i], s, c);
        sines[i] = s, cosines[i] = c;
    }
}

EXPORT void core_exponentials(whole count, const double* x, double* values) {
    for (whole i = 0; i < count; i++) values[i] = exponential(x[i]);
}

// ---- compiled problems -----------------------------------------------------------------------------------------------------------
// The tables of the built-in machines' cycles, and of loci of any compiled problem.
EXPORT const Table* core_machine_table(whole number) {
    return with_machine(number, [](auto machine) { return &cycles::CycleKernels<typename decltype(machine)::Cycles>::table; });
}
EXPORT const Table* core_loci_table() { return &loci::table; }

EXPORT double core_newton(const Table* table, void* data, void* work, whole size, double* u, double* p, double* room, const double* border,
                          double* step, double* tangent, double tolerance, whole limit, whole* iterations) {
    return cycles::newton(*table, data, work, size, u, p, room, border, step, tangent, tolerance, limit, iterations);
}

EXPORT whole core_march(continuation::Frame* frame, double* points, double* values, double* tangents, double* rows, double* signs, double* corrections,
                        whole first, whole stop, double* h, const continuation::Control* control, continuation::Judge judge, whole* filled) {
    return continuation::march(*frame, {points, values, tangents, rows, signs, corrections}, first, stop, h, *control,
                               judge ? judge : continuation::by_angle, filled);
}

EXPORT whole core_points(continuation::Frame* frame, const double* chord, double start, double length, const double* places, whole count,
                         const double* border, const double* along, whole max_sweeps, double* u, double* tangents, double* rows, double* numbers,
                         const continuation::Aim* aim) {
    return continuation::points(*frame, chord, start, length, places, count, border, along, max_sweeps, {u, tangents, rows, numbers}, *aim);
}

EXPORT whole core_scan(const continuation::Scanner* scanner, whole count, double flat, const double* points, const double* values, const double* tangents,
                       const double* rows, const double* signs, double* found) {
    return continuation::scan({*scanner, count, flat, points, values, tangents, rows, signs, found});
}

// ---- algebra ---------------------------------------------------------------------------------------------------------------------
EXPORT whole core_multipliers(const double* A, const double* D, whole length, whole n, double twist, double* re, double* im, double* scratch) {
    return algebra::multipliers(A, D, length, int(n), twist, re, im, scratch);
}
EXPORT whole core_periodic_multipliers(const double* A, const double* D, whole length, whole n, double twist, double* re, double* im, double* scratch) {
    return algebra::periodic_multipliers(A, D, length, int(n), twist, re, im, scratch);
}

// ---- cycles of flows -------------------------------------------------------------------------------------------------------------
EXPORT void core_cycle_points(const collocation::Cycle* cycle, const double* x) { collocation::at_gauss_points(*cycle, x); }
EXPORT double core_cycle_assemble(const collocation::Cycle* cycle, const double* widths, double period, const double* f, const double* jacobian, const double* slope) {
    return collocation::assemble(*cycle, widths, period, f, jacobian, slope);
}
EXPORT double core_cycle_evaluate(const collocation::Cycle* cycle, const collocation::Rates* rates, const double* x, const double* widths, double period) {
    return collocation::evaluate(*cycle, *rates, x, widths, period);
}
EXPORT double core_cycle_bordered(const collocation::Cycle* cycle, double closure, double corner, const double* border, double n, double* step, double* tangent) {
    return collocation::bordered(*cycle, closure, corner, border, n, step, tangent);
}
EXPORT double core_collocation(const collocation::System* system) { return collocation::solve(*system); }
EXPORT whole core_collocation_room(whole count, whole inner, whole d, whole k, whole s) { return collocation::room_for(count, inner, d, k, s); }
EXPORT double core_cycle_distance_to_rest(const collocation::Cycle* cycle, const double* f, const double* jacobian) {
    return collocation::distance_to_rest(*cycle, f, jacobian);
}
EXPORT void core_cycle_steer(const moving_mesh::Ring* ring, const double* u, const double* row, double* tangent) { moving_mesh::steer(*ring, u, row, tangent); }
EXPORT double core_cycle_across(const collocation::Cycle* cycle, const double* speeds, double* maps) { return collocation::across(*cycle, speeds, maps); }
