// SPDX-License-Identifier: BSD-3-Clause
// What the tests of OutsideMode KEEP have in common.
#ifndef KeepTesting_h
#define KeepTesting_h

#include "FilterTesting.h"

namespace filterTesting
{

/// What is left of a displacement outside, where 1 is FadeDistance.
inline double Fade(double s)
{
  return s < 1.0 ? 1.0 - 3.0 * s * s + 2.0 * s * s * s : 0.0;
}

struct Kept : Deformed
{
  Kept(vtkDataObject* volume, vtkDataObject* deformation, double fadeDistance)
    : Deformed(volume, deformation)
  {
    this->Filter->SetOutsideModeToKeep();
    this->Filter->SetFadeDistance(fadeDistance);
  }
};

} // namespace filterTesting

#endif
