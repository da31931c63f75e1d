// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementResults_h
#define DeformVolumeElementResults_h

#include <array>

namespace deformvolume
{

/// What a tetrahedron undergoes.
struct ElementResults
{
  /// Cauchy stress in Pa: xx yy zz xy yz xz.
  std::array<double, 6> Stress{ { 0, 0, 0, 0, 0, 0 } };
  /// In J/m^3 of the volume at rest.
  double StrainEnergyDensity = 0.0;
  /// How many times the volume at rest it has; less than 0 where it is inside out.
  double Determinant = 1.0;
};

} // namespace deformvolume

#endif
