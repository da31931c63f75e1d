// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFloatingPointTrapGuard_h
#define DeformVolumeFloatingPointTrapGuard_h

#include <cfenv>

namespace deformvolume
{

/// Some hosts trap floating-point exceptions, which OpenCL compilers and kernels may raise
/// harmlessly: traps are off during the life of this object.
class FloatingPointTrapGuard
{
public:
  FloatingPointTrapGuard() { std::feholdexcept(&this->Environment); }
  ~FloatingPointTrapGuard() { std::fesetenv(&this->Environment); }
  FloatingPointTrapGuard(const FloatingPointTrapGuard&) = delete;
  FloatingPointTrapGuard& operator=(const FloatingPointTrapGuard&) = delete;

private:
  std::fenv_t Environment;
};

} // namespace deformvolume

#endif
