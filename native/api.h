// The native core: hot arithmetic of contvines and orbits in C++20 without its library.
//
// How it is built
//   `core.cpp` includes every header and is compiled once for each variant (`baseline`, on x86-64 also `avx2`) into one shared
//   library each; `contvines/core/build.py` holds the command. No exceptions, no run-time types, no allocation, no global state,
//   no C++ library: templates, plain structs and <math.h>.
//
// Same bits on every processor
//   The compiler contracts nothing (-ffp-contract=off) and reorders nothing; both variants give the same bits. Of <math.h> only
//   functions that are exact everywhere may be called: sqrt, fabs, floor, ceil, rint, copysign, frexp, ldexp, isfinite, isnan and fma where
//   a fused operation is meant. Sines, cosines, exponentials and the like come from `math.hpp`.
//
// How Python calls it
//   Functions are declared EXPORT and called through ctypes (`contvines.core.library`). Arguments are numbers (`double`, `whole`
//   = int64) and pointers; arrays are C-contiguous, of doubles or of `whole`, and their sizes are passed as well. Longer lists of
//   arguments are plain structs whose members are all eight bytes long (double, whole, pointer). Python fills such a struct from a
//   NamedTuple whose fields have the same names in the same order (`contvines.core.table`): arrays become pointers, integers
//   `whole`, floats double. A struct and the arrays it points to are owned by Python; native code keeps neither.
//   Functions return a status or a number; they never fail otherwise. NaN and infinity in, NaN and infinity out.
//
// Compiled problems
//   A problem that the continuation march can follow is a `Table` of C functions. `data` and `work` are the problem's own structs, the
//   first and last argument of the kernels in the protocol (contvines/problems/protocol.py), which says the rest.
#pragma once
#include <math.h>
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT extern "C" __declspec(dllexport)
#else
#define EXPORT extern "C" __attribute__((visibility("default")))
#endif

using whole = int64_t;

struct Table {
    double (*linearise)(void* data, const double* u, double p, void* work);  // largest residual, infinity where it cannot be evaluated
    double (*bordered)(void* data, void* work, const double* border, double target, double* step, double* tangent);  // determinant's sign
    void (*inspect)(void* data, const double* u, double p, void* work, double* row);  // multipliers and margins
    // For loci against a second parameter; null where there are none.
    void (*assign)(void* data, void* other, double value);
    void (*flip)(void* data, void* work, double sign);
    void (*transpose)(void* data, void* work, const double* column, void* other);
};
