// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFloatingPointTrapGuard_h
#define DeformVolumeFloatingPointTrapGuard_h

#include <cfenv>

namespace deformvolume
{

/// Turns floating-point traps off during the lifetime of the object. Some programs enable them, but
/// OpenCL compilers and kernels may raise harmless floating-point exceptions.
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
