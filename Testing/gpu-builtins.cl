// SPDX-License-Identifier: BSD-3-Clause
// Built-in functions of OpenCL that libclc 15 does not have for NVIDIA's GPUs, for
// Testing/gpu-compilers.sh.

ulong __attribute__((overloadable))
atom_cmpxchg(volatile __global ulong* place, ulong expected, ulong value)
{
  return __sync_val_compare_and_swap_8((volatile __global long*)place, expected, value);
}

ulong __attribute__((overloadable)) atom_min(volatile __global ulong* place, ulong value)
{
  ulong old;
  __asm__ volatile("atom.global.min.u64 %0, [%1], %2;"
                   : "=l"(old)
                   : "l"(place), "l"(value)
                   : "memory");
  return old;
}
