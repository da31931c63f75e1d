// SPDX-License-Identifier: BSD-3-Clause
// A check for tests that update a mesh.
#ifndef UpdateChecks_h
#define UpdateChecks_h

#include "FilterTesting.h"

#include <string>

namespace filterTesting
{

/// Checks that a filter whose inputs were edited has the same output as a new filter with the same
/// inputs. Increments parts if only a part of the output was resampled. what: the edit, for the
/// message.
inline void CompareWithFresh(Deformed& tested, Deformed& fresh, const std::string& what, int& parts)
{
  SCOPED_TRACE(what);
  EXPECT_TRUE(AreEqual(tested.Update(), fresh.Update()));
  const auto compare = [&](auto getter)
  { EXPECT_EQ((tested.Filter->*getter)(), (fresh.Filter->*getter)()); };
  compare(&vtkDeformVolumeFilter::GetNumberOfCoveredVoxels);
  compare(&vtkDeformVolumeFilter::GetNumberOfInvertedTetrahedra);
  compare(&vtkDeformVolumeFilter::GetNumberOfFlatTetrahedra);
  EXPECT_GT(fresh.Filter->GetNumberOfCoveredVoxels(), 0);
  parts += GetReported(tested.Filter, "Bricks resampled") <
      GetReported(tested.Filter, "Bricks of the volume")
    ? 1
    : 0;
}

} // namespace filterTesting

#endif
