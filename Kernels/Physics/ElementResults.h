// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementResults_h
#define DeformVolumeElementResults_h

#include <array>
#include <cmath>

namespace deformvolume
{

/// The stress and deformation of a tetrahedron.
struct ElementResults
{
  /// Cauchy stress in Pa: xx yy zz xy yz xz. It is derived from the elastic forces divided by the
  /// determinant, with the sign of the determinant if the tetrahedron is inverted. 0 if
  /// IsFlat(Determinant).
  std::array<double, 6> Stress{ { 0, 0, 0, 0, 0, 0 } };
  /// Strain energy per volume at rest, in J/m^3.
  double StrainEnergyDensity = 0.0;
  /// The volume divided by the volume at rest. Negative if the tetrahedron is inverted.
  double Determinant = 1.0;
};

/// Whether a tetrahedron with this determinant has no volume, up to rounding. Its forces are
/// finite, but its stress is undefined: the stress of tetrahedra that become flat tends to
/// infinity.
inline bool IsFlat(double determinant)
{
  return std::abs(determinant) < 1e-12;
}

} // namespace deformvolume

#endif
