// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeRatios_h
#define DeformVolumeVolumeRatios_h

#include "Extent.h"
#include "FiveTetrahedra.h"
#include "ParallelFor.h"
#include "VoxelJacobians.h" // for HiddenTetrahedra

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace deformvolume
{

/// The coordinates of a displacement that does not exist.
inline constexpr double NotDefined = std::numeric_limits<double>::quiet_NaN();

/// The edges at rest, in output voxels, from the first vertex of each tetrahedron of a cell to its
/// other vertices, for all ways in which the split of a cell is mirrored.
class CellEdges
{
public:
  explicit CellEdges(const glm::dmat3& matrix)
  {
    for (int mirror = 0; mirror < 8; ++mirror)
    {
      for (std::size_t t = 0; t < 5; ++t)
      {
        Shape& shape = this->Shapes[static_cast<std::size_t>(mirror)][t];
        const glm::dvec3 first = GetOffset(FiveTetrahedra[t][0] ^ mirror);
        for (int k = 0; k < 3; ++k)
        {
          shape.Edges[k] = matrix * (GetOffset(FiveTetrahedra[t][k + 1] ^ mirror) - first);
        }
        shape.Inverse = 1.0 / glm::determinant(shape.Edges);
      }
    }
  }

  // Returns the deformed volume of a tetrahedron, divided by its volume at rest. displacements: of
  // the vertices of the cell. NaN if one of them is NaN.
  double GetRatio(int mirror, std::size_t t, const std::array<glm::dvec3, 8>& displacements) const
  {
    const Shape& shape = this->Shapes[static_cast<std::size_t>(mirror)][t];
    const auto displacement = [&](int k) -> const glm::dvec3&
    { return displacements[static_cast<std::size_t>(FiveTetrahedra[t][k] ^ mirror)]; };
    const glm::dvec3& first = displacement(0);
    const glm::dmat3 change(
      displacement(1) - first, displacement(2) - first, displacement(3) - first);
    return glm::determinant(shape.Edges + change) * shape.Inverse;
  }

private:
  static glm::dvec3 GetOffset(int v)
  {
    return glm::dvec3(DEFORMVOLUME_OFFSET_X(v), DEFORMVOLUME_OFFSET_Y(v), DEFORMVOLUME_OFFSET_Z(v));
  }

  struct Shape
  {
    glm::dmat3 Edges;
    double Inverse = 0.0; // of the determinant
  };
  std::array<std::array<Shape, 5>, 8> Shapes;
};

/// Computes the volume ratios of the voxels in planes of constant z.
///
/// Source describes the deformation. Displace(voxel, index): the displacement of a voxel, in output
/// voxels, or NaN if it has none. GetRatioOfCell(vertices): the ratio of a cell whose vertices all
/// follow one tetrahedron of a mesh, or else NaN. IsBridge(a, b): whether the deformation is split
/// between two voxels. GetOtherwise(voxel, index): the ratio of a voxel whose tetrahedra are all
/// hidden.
template <typename Source>
class PlaneRatios
{
public:
  // crossed: numbers of hidden cells, in ascending order.
  PlaneRatios(const Extent& voxels, const CellEdges& edges, const HiddenTetrahedra& hidden,
    const std::vector<std::int64_t>& crossed, const Source& source)
    : Voxels(voxels)
    , Edges(edges)
    , Hidden(hidden)
    , Crossed(crossed)
    , Deformation(source)
  {
    this->Displacements.fill(std::vector<glm::dvec3>(static_cast<std::size_t>(this->Plane)));
    this->Volumes.fill(std::vector<Sums>(static_cast<std::size_t>(this->Plane)));
  }

  // Computes the planes from begin to before end, counted from the first plane of the volume.
  void Compute(std::int64_t begin, std::int64_t end, float* ratios)
  {
    const std::int64_t first = std::max<std::int64_t>(begin - 1, 0);
    this->DisplacePlane(first);
    for (std::int64_t z = first; z < end; ++z)
    {
      if (z + 1 < GetSize(this->Voxels, 2))
      {
        this->DisplacePlane(z + 1);
        this->AddLayer(z);
      }
      this->FinishPlane(z, z >= begin ? ratios : nullptr);
    }
  }

private:
  // Volumes of the tetrahedra around a voxel, in sixths of the volume of a voxel.
  struct Sums
  {
    double Rest = 0.0;
    double Deformed = 0.0;
  };

  // Calls body(point, index) for the points of a plane, or for the lower corners of the cells above
  // it. point: number of the point in the plane.
  template <typename Body>
  void ForEach(std::int64_t z, bool cells, const Body& body) const
  {
    Extent plane = this->Voxels;
    plane[4] += static_cast<int>(z);
    plane[5] = plane[4];
    plane[1] -= cells ? 1 : 0;
    plane[3] -= cells ? 1 : 0;
    ForEachPoint(plane,
      [&](int x, int y, int layer) {
        body((y - this->Voxels[2]) * this->Width + x - this->Voxels[0], glm::ivec3(x, y, layer));
      });
  }

  void DisplacePlane(std::int64_t z)
  {
    std::vector<glm::dvec3>& plane = this->Displacements[static_cast<std::size_t>(z % 2)];
    this->ForEach(z, false,
      [&](std::int64_t point, const glm::ivec3& index)
      {
        const std::int64_t voxel = z * this->Plane + point;
        const bool isBlanked =
          this->Hidden.Blanked && (this->Hidden.Blanked[voxel] & this->Hidden.BlankedBits) != 0;
        plane[static_cast<std::size_t>(point)] =
          isBlanked ? glm::dvec3(NotDefined) : this->Deformation.Displace(voxel, index);
      });
  }

  // Adds the volumes of the cells between the planes z and z + 1.
  void AddLayer(std::int64_t z)
  {
    std::int64_t cell = z * (this->Width - 1) * (GetSize(this->Voxels, 1) - 1);
    auto next = std::lower_bound(this->Crossed.begin(), this->Crossed.end(), cell);
    this->ForEach(z, true,
      [&](std::int64_t point, const glm::ivec3& index)
      {
        int shown = this->Hidden.Active ? this->Hidden.Active[cell] : DEFORMVOLUME_ALL_TETRAHEDRA;
        shown &= this->Hidden.Cut ? ~this->Hidden.Cut[cell] : shown;
        if (next != this->Crossed.end() && *next == cell)
        {
          shown = 0;
          ++next;
        }
        if (shown != 0)
        {
          this->AddCell(shown, z, point, index);
        }
        ++cell;
      });
  }

  // shown: the shown tetrahedra, as bits. point: the lower corner of the cell.
  void AddCell(int shown, std::int64_t z, std::int64_t point, const glm::ivec3& index)
  {
    std::array<std::int64_t, 8> vertices;
    std::array<Sums*, 8> sums;
    std::array<glm::dvec3, 8> displacements;
    double sum = 0.0;
    for (std::size_t v = 0; v < 8; ++v)
    {
      const std::int64_t ofPlane =
        point + DEFORMVOLUME_OFFSET_X(v) + DEFORMVOLUME_OFFSET_Y(v) * this->Width;
      const std::int64_t layer = z + DEFORMVOLUME_OFFSET_Z(v);
      const auto parity = static_cast<std::size_t>(layer % 2);
      vertices[v] = layer * this->Plane + ofPlane;
      sums[v] = &this->Volumes[parity][static_cast<std::size_t>(ofPlane)];
      displacements[v] = this->Displacements[parity][static_cast<std::size_t>(ofPlane)];
      sum += displacements[v].x;
    }
    const double ofCell = std::isnan(sum) ? NotDefined : this->Deformation.GetRatioOfCell(vertices);
    const int mirror = DEFORMVOLUME_MIRROR(index.x, index.y, index.z);
    for (std::size_t t = 0; t < 5; ++t)
    {
      if ((shown >> t & 1) == 0)
      {
        continue;
      }
      std::array<std::size_t, 4> corners;
      for (std::size_t k = 0; k < 4; ++k)
      {
        corners[k] = static_cast<std::size_t>(FiveTetrahedra[t][k] ^ mirror);
      }
      const double ratio =
        std::isnan(ofCell) ? this->Edges.GetRatio(mirror, t, displacements) : ofCell;
      if (!std::isnan(ratio) &&
        !(this->Hidden.OpenSplits &&
          this->IsBridge({ { vertices[corners[0]], vertices[corners[1]], vertices[corners[2]],
            vertices[corners[3]] } })))
      {
        const double rest = t == 4 ? 2.0 : 1.0; // the central tetrahedron is twice as large
        for (const std::size_t corner : corners)
        {
          sums[corner]->Rest += rest;
          sums[corner]->Deformed += rest * ratio;
        }
      }
    }
  }

  bool IsBridge(const std::array<std::int64_t, 4>& corners) const
  {
    for (std::size_t i = 1; i < 4; ++i)
    {
      for (std::size_t k = 0; k < i; ++k)
      {
        if (this->Deformation.IsBridge(corners[i], corners[k]))
        {
          return true;
        }
      }
    }
    return false;
  }

  // Writes the ratios of a plane, unless ratios is null, and clears its sums.
  void FinishPlane(std::int64_t z, float* ratios)
  {
    std::vector<Sums>& plane = this->Volumes[static_cast<std::size_t>(z % 2)];
    this->ForEach(z, false,
      [&](std::int64_t point, const glm::ivec3& index)
      {
        const Sums sums = std::exchange(plane[static_cast<std::size_t>(point)], Sums());
        const std::int64_t voxel = z * this->Plane + point;
        if (ratios)
        {
          ratios[voxel] =
            static_cast<float>(sums.Rest > 0.0 ? sums.Deformed / sums.Rest
                                               : this->Deformation.GetOtherwise(voxel, index));
        }
      });
  }

  const Extent& Voxels;
  const std::int64_t Width = GetSize(Voxels, 0);
  const std::int64_t Plane = Width * GetSize(Voxels, 1);
  const CellEdges& Edges;
  const HiddenTetrahedra& Hidden;
  const std::vector<std::int64_t>& Crossed;
  Source Deformation; // a copy, since it may keep what it has computed
  // Two planes of voxels: those of even and of odd z.
  std::array<std::vector<glm::dvec3>, 2> Displacements;
  std::array<std::vector<Sums>, 2> Volumes;
};

/// Computes the volume ratios of VoxelJacobians. atRest: the linear part of the map to the output.
/// The other arguments are those of PlaneRatios.
template <typename Source>
void ComputeRatios(const Extent& voxels, const glm::dmat3& atRest, const HiddenTetrahedra& hidden,
  const std::vector<std::int64_t>& crossed, const Source& source, float* ratios)
{
  const CellEdges edges(atRest);
  const std::int64_t planes = GetSize(voxels, 2);
  constexpr std::int64_t planesOfPart = 8;
  ParallelForItems((planes + planesOfPart - 1) / planesOfPart, 1,
    [&](std::int64_t part)
    {
      const std::int64_t begin = part * planesOfPart;
      PlaneRatios<Source>(voxels, edges, hidden, crossed, source)
        .Compute(begin, std::min(begin + planesOfPart, planes), ratios);
    });
}

} // namespace deformvolume

#endif
