// SPDX-License-Identifier: BSD-3-Clause
// A reference implementation of the resampling of a deformed sampling mesh, on the host. It tests
// every tetrahedron against every voxel of its closed bounding box in exact integers, and computes
// values in extended precision. It shares nothing with the kernels, not even the table of
// tetrahedra, so that an error on either side is found.
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
  /// One position per voxel, x varying fastest.
  std::vector<Position> Positions;
  /// Whether each voxel is linked and not blanked; empty: all are.
  std::vector<bool> Present;
  /// Bit t of a cell: tetrahedron t is active; empty: all are active.
  std::vector<unsigned char> Active;
  /// The signed distance of each voxel from the boundary; empty: nothing is clipped.
  std::vector<float> Distances;
  /// Bit t of a cell: a smooth cut crosses tetrahedron t; empty: there is no smooth cut.
  std::vector<unsigned char> Crossed;
  /// For smooth cuts: the signed distance of each voxel from the sheet, and its displacement from
  /// its rest position.
  std::vector<float> CutDistances;
  std::vector<Position> Displacements;
  /// Whether the map from the volume at rest to the output mirrors.
  bool IsMirrored = false;
};

/// A tetrahedron whose closed region contains an output voxel.
struct Containing
{
  std::int64_t Cell = 0;
  int Tetrahedron = 0;
  bool Inverted = false;
  /// The side of the cut of a divided tetrahedron: 1 for negative distances, else 0.
  int Side = 0;
  /// Whether it also contains the voxel moved by (e, e^2, e^3), e -> 0.
  bool Generic = false;
  /// Voxels of the volume, and their barycentric weights as Numerators / Denominator.
  std::array<std::int64_t, 4> Vertices{};
  std::array<Position, 4> Points{};
  std::array<std::int64_t, 4> Numerators{};
  std::int64_t Denominator = 1;

  /// Upright tetrahedra come before inverted ones, then the lowest cell, tetrahedron and side.
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

  /// The vertex of the largest weight; among equal weights the lowest vertex.
  std::int64_t GetNearestVertex() const;
  /// Whether both place the voxel on the same vertex, edge or face, or in the same interior, of the
  /// mesh.
  bool SharesSimplex(const Containing& other) const;
  /// The only vertex of positive weight; -1 if there are several.
  std::int64_t GetSingleVertex() const;
};

struct Result
{
  /// For each output voxel, all tetrahedra whose closed region contains it, the best first. If a
  /// single tetrahedron writes the voxel by the fill rule, the tetrahedra with the voxel in the
  /// same simplex come first. The others follow in the order of Containing.
  std::vector<std::vector<Containing>> Voxels;
  std::int64_t NumberOfCoveredVoxels = 0;
  std::int64_t NumberOfInvertedTetrahedra = 0;
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// The number of voxels that more than one tetrahedron contains generically.
  std::int64_t NumberOfOverlappedVoxels = 0;
  /// The number of voxels at which faces, edges or vertices meet that are separate at rest,
  /// including overlapped voxels.
  std::int64_t NumberOfTouchedVoxels = 0;
};

Result Resample(const SamplingMesh& mesh, const Box& output);

} // namespace reference

#endif
