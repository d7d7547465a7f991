#include "api.h"
#include "math.hpp"

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
