// SPDX-License-Identifier: BSD-3-Clause
// A product and a sum: fused where that is one instruction, and the same everywhere on a device. Compilers may
// fuse a * b + c or not, from one place to the next, and some do so whatever FP_CONTRACT says: a sum with a
// product that may be rounded is written with these. PoCL does not define the macros that OpenCL has for it.
#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define MULTIPLY_ADD(a, b, c) fma(a, b, c)
#else
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#endif
#if !REAL_IS_DOUBLE
#define MULTIPLY_ADD_REAL(a, b, c) MULTIPLY_ADD(a, b, c)
#elif defined(FP_FAST_FMA) || defined(__FMA__)
#define MULTIPLY_ADD_REAL(a, b, c) fma(a, b, c)
#else
#define MULTIPLY_ADD_REAL(a, b, c) ((a) * (b) + (c))
#endif
