// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementField_h
#define DeformVolumeDisplacementField_h

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>

namespace deformvolume
{

/// Displacements over so many output voxels are refused: the kernels could not round them.
constexpr double LargestDisplacement = 16383.0;

/// Steps between points of a field by which a voxel may lie outside it and count as inside: that of
/// DeformationMapping.cl.
constexpr double FieldTolerance = 1e-3;

/// A displacement field on a regular grid, trilinear between its points.
struct DisplacementField
{
  /// Points on each axis.
  std::array<int, 3> Dimensions{ { 0, 0, 0 } };
  /// Three floats a point, x varying fastest.
  const float* Vectors = nullptr;
  /// Row-major 3 x 3 matrix that takes a vector to a displacement in output voxels. It is applied
  /// in double precision (see GetFactor), and the result rounded to float.
  std::array<double, 9> ToDisplacement{ { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  /// What keeps Vectors where they are and as they are. With it a device that is a processor, and
  /// has double precision, reads Vectors where they lie, at each Deform(), where each voxel is a
  /// point of the field, and holds the owner until it has another deformation. They are not
  /// checked then: tetrahedra with displacements that are not finite, or too large, are skipped.
  /// Nor are they compared: all is made anew where they are set again, unless it is said which have
  /// changed. Else Vectors are checked, converted and copied during the call. Null by default.
  std::shared_ptr<const void> Owner;
  /// Row-major 3 x 4 matrix that takes a structured index of the volume to a continuous index of
  /// the field, 0 being the field's first point.
  std::array<double, 12> IndexToField{ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
  /// True: voxels outside the field take the displacement of its nearest point on the border.
  /// False: they are discarded.
  bool Extrapolate = false;
  /// How the displacement of the border fades with the distance from the field, where voxels
  /// outside take it: what a step of one point on each axis adds to a distance that is 1 where the
  /// displacement is zero. 0: it does not fade.
  std::array<double, 3> Fading{ { 0.0, 0.0, 0.0 } };
};

/// Whether the displacement fades outside a field.
inline bool IsFading(const DisplacementField& field)
{
  return field.Fading[0] > 0.0;
}

/// The points of a field; 0 where it has none on an axis.
inline std::int64_t GetNumberOfPoints(const DisplacementField& field)
{
  std::int64_t points = 1;
  for (const int dimension : field.Dimensions)
  {
    points *= dimension > 0 ? dimension : 0;
  }
  return points;
}

/// Whether displacements are the vectors of a field as they are.
inline bool HasDisplacements(const DisplacementField& field)
{
  return field.ToDisplacement == DisplacementField().ToDisplacement;
}

/// A factor rounded to 29 bits, so that its product with a float is exact in double precision. Then
/// it does not matter whether a compiler, of the host or of the device, fuses products with sums.
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

/// An element of the matrix of a field as it is applied.
inline double GetFactor(const DisplacementField& field, int element)
{
  return RoundFactor(field.ToDisplacement[element]);
}

/// The displacement of a point of a field, to the last bit as the kernels have it.
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
