// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementField_h
#define DeformVolumeDisplacementField_h

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>

namespace deformvolume
{

/// Largest displacement, in output voxels. Larger displacements are refused: the kernels cannot
/// round them.
constexpr double LargestDisplacement = 16383.0;

/// Distance from a field, in steps between its points, up to which a voxel counts as inside. Equal
/// to the tolerance of DeformationMapping.cl.
constexpr double FieldTolerance = 1e-3;

/// A displacement field on a regular grid. Displacements between the points are interpolated
/// trilinearly.
struct DisplacementField
{
  /// Number of points on each axis.
  std::array<int, 3> Dimensions{ { 0, 0, 0 } };
  /// Three floats per point, with x varying fastest.
  const float* Vectors = nullptr;
  /// Row-major 3 x 3 matrix that maps a vector to a displacement in output voxels. It is applied in
  /// double precision (see GetFactor()), and the result is rounded to float. Default: the identity.
  std::array<double, 9> ToDisplacement{ { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  /// Owner of Vectors. While an object holds the owner, Vectors must stay valid and unchanged.
  /// Default: null. Without an owner, the call checks, converts and copies Vectors.
  ///
  /// With an owner, a CPU device that supports double precision reads Vectors in place at each
  /// Deform(), if each voxel is a point of the field. It holds the owner until another deformation
  /// is set. Vectors in place are not checked: tetrahedra whose displacements are too large or not
  /// finite are skipped. Vectors in place are not compared either: when the same Vectors are set
  /// again, all of the output is resampled, unless the caller states which vectors have changed.
  std::shared_ptr<const void> Owner;
  /// Row-major 3 x 4 matrix that maps a structured index of the volume to a continuous index of the
  /// field. The first point of the field has the index 0. Default: the identity.
  std::array<double, 12> IndexToField{ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
  /// True: voxels outside the field use the displacement of the nearest point on its border.
  /// False: voxels outside the field are discarded.
  bool Extrapolate = false;
  /// Fading of extrapolated displacements, for each axis: the inverse of the distance from the
  /// field, in steps between its points, at which the displacement becomes zero. 0: it does not
  /// fade.
  std::array<double, 3> Fading{ { 0.0, 0.0, 0.0 } };
};

/// Whether the displacement fades outside a field.
inline bool IsFading(const DisplacementField& field)
{
  return field.Fading[0] > 0.0;
}

/// Returns the number of points of a field. 0 if an axis has none.
inline std::int64_t GetNumberOfPoints(const DisplacementField& field)
{
  std::int64_t points = 1;
  for (const int dimension : field.Dimensions)
  {
    points *= dimension > 0 ? dimension : 0;
  }
  return points;
}

/// Whether the vectors of a field are its displacements (ToDisplacement is the identity).
inline bool HasDisplacements(const DisplacementField& field)
{
  return field.ToDisplacement == DisplacementField().ToDisplacement;
}

/// Rounds a factor to 29 bits, so that its product with a float is exact in double precision. The
/// result is then the same whether or not the compiler of host or device fuses multiply and add.
inline double RoundFactor(double exact)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &exact, sizeof(bits));
  constexpr std::uint64_t unit = 1 << 24;
  bits = (bits + unit / 2) & ~(unit - 1);
  double factor = 0.0;
  std::memcpy(&factor, &bits, sizeof(factor));
  return factor;
}

/// Returns an element of ToDisplacement, rounded as it is applied.
inline double GetFactor(const DisplacementField& field, int element)
{
  return RoundFactor(field.ToDisplacement[element]);
}

/// Returns the displacement of a point of a field. Bitwise equal to the result of the kernels.
inline std::array<float, 3> GetDisplacement(const DisplacementField& field, std::int64_t point)
{
  const float* vector = field.Vectors + 3 * point;
  std::array<float, 3> displacement;
  for (int axis = 0; axis < 3; ++axis)
  {
    displacement[axis] =
      static_cast<float>(GetFactor(field, 3 * axis) * static_cast<double>(vector[0]) +
        GetFactor(field, 3 * axis + 1) * static_cast<double>(vector[1]) +
        GetFactor(field, 3 * axis + 2) * static_cast<double>(vector[2]));
  }
  return displacement;
}

} // namespace deformvolume

#endif
