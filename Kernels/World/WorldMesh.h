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

/// Converts a deformation mesh and its displacements in world coordinates to the units of the
/// kernels.
class WorldMesh
{
public:
  /// Set the mesh. points: the nodes at rest, which are copied. Removes the displacements.
  void Set(const VectorView& points, MeshCells&& cells);
  /// Set the displacements: one vector for each node. They are copied. Throws an Error if the
  /// number of vectors is not the number of nodes.
  void SetVectors(const VectorView& vectors);

  /// Updates nodes and displacements for a volume and its map to the output. Throws an Error if a
  /// point or vector of a node that a tetrahedron uses is not finite, or a displacement is too
  /// long.
  void Update(const ImageGeometry& volume, const OutputMap& toOutput);

  ///@{
  /// Return the positions at rest and the displacements of all nodes in world coordinates, with the
  /// derived nodes. Throw an Error if a node that a tetrahedron uses is not finite, or if there are
  /// no displacements.
  std::vector<glm::dvec3> GetWorldPoints() const;
  std::vector<glm::dvec3> GetWorldDisplacements() const;
  ///@}

  std::size_t GetNumberOfNodes() const { return this->WorldPoints.size(); }
  /// Whether the points were given in single precision.
  bool ArePointsFloats() const { return this->PointsAreFloats; }
  const MeshCells& GetCells() const { return this->Cells; }

  ///@{
  /// Valid after Update(). Points and displacements of derived nodes follow those of the nodes.
  MeshAtRest GetAtRest() const
  {
    return { this->Cells.Tetrahedra, this->Points, this, this->ShapeVersion };
  }
  const std::vector<float>& GetDisplacements() const { return this->Displacements; }
  /// These versions change with the points at rest, and with the displacements.
  std::uint64_t GetShapeVersion() const { return this->ShapeVersion; }
  std::uint64_t GetVectorsVersion() const { return this->VectorsVersion; }
  ///@}

private:
  void CheckVectors() const;
  std::vector<glm::dvec3> AddDerived(std::vector<glm::dvec3> vectors) const;
  void UpdatePoints(const ImageGeometry& volume);
  void UpdateDisplacements(const OutputMap& toOutput);

  MeshCells Cells;
  std::vector<glm::dvec3> WorldPoints;
  std::vector<glm::dvec3> WorldVectors;
  bool PointsAreFloats = false;
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
