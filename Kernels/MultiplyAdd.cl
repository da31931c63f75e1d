// SPDX-License-Identifier: BSD-3-Clause
// A product and a sum: fused where that is one instruction, and the same everywhere on a device.
// PoCL does not define the macro that OpenCL has for it.
#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define MULTIPLY_ADD(a, b, c) fma(a, b, c)
#else
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#endif

