// SPDX-License-Identifier: BSD-3-Clause
// A filter and the fade function for the tests of OutsideMode KEEP.
#ifndef KeepTesting_h
#define KeepTesting_h

#include "FilterTesting.h"

namespace filterTesting
{

/// The weight of a displacement outside the deformation. s: the distance divided by FadeDistance.
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
