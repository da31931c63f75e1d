// SPDX-License-Identifier: BSD-3-Clause
// The resampling of a deformed sampling mesh, done once more on the host: every tetrahedron against
// every voxel of its closed box, in exact integers, values in extended precision. It shares nothing
// with the kernels, the table of tetrahedra included, so that an error on either side shows.
#ifndef Reference_h
#define Reference_h

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace reference
{

/// x min, x max, y min, y max, z min, z max.
using Box = std::array<int, 6>;

inline std::int64_t GetSize(const Box& box, int axis)
{
  return static_cast<std::int64_t>(box[2 * axis + 1]) - box[2 * axis] + 1;
}
inline std::int64_t GetNumberOfVoxels(const Box& box)
{
  return GetSize(box, 0) * GetSize(box, 1) * GetSize(box, 2);
}

/// Output indices in units of 1/256 voxel.
using Position = std::array<std::int64_t, 3>;

struct SamplingMesh
{
  Box Voxels;
  /// One position a voxel, x varying fastest.
  std::vector<Position> Positions;
  /// Whether a voxel is linked and not blanked; empty: all are.
  std::vector<bool> Present;
  /// Bit t of a cell: its tetrahedron t is active; empty: all are.
  std::vector<unsigned char> Active;
  /// Signed distance of each voxel to the boundary; empty: nothing is clipped.
  std::vector<float> Distances;
  /// Bit t of a cell: a smooth cut crosses its tetrahedron t; empty: there is none.
  std::vector<unsigned char> Crossed;
  /// Signed distance of each voxel from the sheet, and how far it is from where it rests; for
  /// smooth cuts.
  std::vector<float> CutDistances;
  std::vector<Position> Displacements;
  /// Whether voxels that have not moved lie in the output as in a mirror.
  bool IsMirrored = false;
};

/// A tetrahedron whose closed region contains an output voxel.
struct Containing
{
  std::int64_t Cell = 0;
  int Tetrahedron = 0;
  bool Inverted = false;
  /// Of a divided tetrahedron, on which side of the cut it is: 1 where distances are negative.
  int Side = 0;
  /// Whether it contains the voxel also when that is moved by (e, e^2, e^3), e -> 0.
  bool Generic = false;
  /// Voxels of the volume, and their barycentric weights as Numerators / Denominator.
  std::array<std::int64_t, 4> Vertices{};
  std::array<Position, 4> Points{};
  std::array<std::int64_t, 4> Numerators{};
  std::int64_t Denominator = 1;

  /// Upright before inverted, then the lowest cell, tetrahedron and side.
  bool operator<(const Containing& other) const;

  template <typename T>
  long double Interpolate(const T* values, int components, int component) const
  {
    long double sum = 0.0L;
    for (int k = 0; k < 4; ++k)
    {
      if (this->Numerators[k] > 0)
      {
        const T value = values[this->Vertices[k] * components + component];
        sum += static_cast<long double>(this->Numerators[k]) * static_cast<long double>(value);
      }
    }
    return sum / static_cast<long double>(this->Denominator);
  }

  /// Sum of weight times magnitude: the scale of rounding errors.
  template <typename T>
  long double Magnitude(const T* values, int components, int component) const
  {
    long double sum = 0.0L;
    for (int k = 0; k < 4; ++k)
    {
      if (this->Numerators[k] > 0)
      {
        const T value = values[this->Vertices[k] * components + component];
        sum += static_cast<long double>(this->Numerators[k]) *
          std::fabs(static_cast<long double>(value));
      }
    }
    return sum / static_cast<long double>(this->Denominator);
  }

  /// The vertex of the largest weight, the lowest one among equals.
  std::int64_t GetNearestVertex() const;
  /// Whether both place the voxel on the same vertex, edge, face or interior of the mesh.
  bool SharesSimplex(const Containing& other) const;
  /// The only vertex of positive weight, or -1.
  std::int64_t GetSingleVertex() const;
};

struct Result
{
  /// For each output voxel all tetrahedra whose closed region contains it, the best first: where a
  /// single one writes the voxel by the fill rule, those that have it in the same simplex, and
  /// then in the order of Containing.
  std::vector<std::vector<Containing>> Voxels;
  std::int64_t NumberOfCoveredVoxels = 0;
  std::int64_t NumberOfInvertedTetrahedra = 0;
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// Voxels that more than one tetrahedron contains generically.
  std::int64_t NumberOfOverlappedVoxels = 0;
  /// Voxels at which faces, edges or vertices meet that are apart at rest, those above included.
  std::int64_t NumberOfTouchedVoxels = 0;
};

Result Resample(const SamplingMesh& mesh, const Box& output);

} // namespace reference

#endif
