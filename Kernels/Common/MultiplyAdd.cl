// SPDX-License-Identifier: BSD-3-Clause
// Multiply-add that rounds in the same way everywhere on a device: fused where the device has an instruction for that.
// Compilers may contract a * b + c in one expression and not in another, and some ignore FP_CONTRACT. Therefore use
// these macros for each sum with a product that may be rounded. PoCL does not define FP_FAST_FMAF; its compiler, Clang,
// defines __FMA__.
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
