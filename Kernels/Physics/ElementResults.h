// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementResults_h
#define DeformVolumeElementResults_h

#include <array>
#include <cmath>

namespace deformvolume
{

/// What a tetrahedron undergoes.
struct ElementResults
{
  /// Cauchy stress in Pa: xx yy zz xy yz xz. The one of the forces by the determinant, with its
  /// sign where the tetrahedron is inside out; 0 where it IsFlat.
  std::array<double, 6> Stress{ { 0, 0, 0, 0, 0, 0 } };
  /// In J/m^3 of the volume at rest.
  double StrainEnergyDensity = 0.0;
  /// How many times the volume at rest it has; less than 0 where it is inside out.
  double Determinant = 1.0;
};

/// Whether a tetrahedron of this determinant has no volume, but for rounding. Its forces are
/// finite, and no stress causes them: of nearly flat ones the stress grows beyond all bounds,
/// either way.
inline bool IsFlat(double determinant)
{
  return std::abs(determinant) < 1e-12;
}

} // namespace deformvolume

#endif
