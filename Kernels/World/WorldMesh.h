// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldMesh_h
#define DeformVolumeWorldMesh_h

#include "CellReader.h"
#include "ImageGeometry.h"
#include "MeshAtRest.h"
#include "NodeFaults.h"
#include "Tetrahedron.h"
#include "VectorView.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{

/// A deformation mesh and its displacements, given in world coordinates, in the units of the
/// kernels.
class WorldMesh
{
public:
  /// points: at rest; they are copied. There are no displacements then.
  void Set(const VectorView& points, MeshCells&& cells);
  /// One vector for each node; they are copied. Throws an Error where their number is another one.
  void SetVectors(const VectorView& vectors);

  /// Makes what follows from a volume and from where it lies in the output. Throws an Error where a
  /// point or a vector that tetrahedra use is not finite, or too long.
  void Update(const ImageGeometry& volume, const OutputMap& toOutput);

  bool HasVectors() const { return this->VectorsAreSet; }
  std::size_t GetNumberOfNodes() const { return this->WorldPoints.size(); }
  const MeshCells& GetCells() const { return this->Cells; }

  ///@{
  /// After Update. Points and displacements are those of the nodes, and then of the derived ones.
  MeshAtRest GetAtRest() const
  {
    return { this->Cells.Tetrahedra, this->Points, this, this->ShapeVersion };
  }
  const std::vector<float>& GetDisplacements() const { return this->Displacements; }
  /// Change with these.
  std::uint64_t GetShapeVersion() const { return this->ShapeVersion; }
  std::uint64_t GetVectorsVersion() const { return this->VectorsVersion; }
  ///@}

private:
  void UpdatePoints(const ImageGeometry& volume);
  void UpdateDisplacements(const OutputMap& toOutput);

  MeshCells Cells;
  std::vector<glm::dvec3> WorldPoints;
  std::vector<glm::dvec3> WorldVectors;
  bool VectorsAreSet = false;
  NodeFaults PointFaults;
  NodeFaults VectorFaults;

  std::vector<glm::dvec3> Points;   // in continuous indices of the volume
  std::vector<float> Displacements; // in output voxels
  bool PointsAreOld = true;
  bool DisplacementsAreOld = true;
  ImageGeometry Volume;
  OutputMap ToOutput;
  std::uint64_t ShapeVersion = 0;
  std::uint64_t VectorsVersion = 0;
};

} // namespace deformvolume

#endif
