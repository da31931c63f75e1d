// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldMesh_h
#define DeformVolumeWorldMesh_h

#include "CellReader.h"
#include "ImageGeometry.h"
#include "IndexDeformation.h"
#include "VectorView.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{

/// A deformation mesh that is given in world coordinates. Points and displacements of derived nodes
/// follow those of the nodes.
class WorldMesh : public IndexDeformation
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

  /// Valid after Update().
  MeshAtRest GetMeshAtRest() const override
  {
    return { this->Cells.Tetrahedra, this->Points, this, this->ShapeVersion, this->ShapeVersion };
  }

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

  std::vector<glm::dvec3> Points; // in continuous indices of the volume
  bool PointsAreOld = true;
  bool DisplacementsAreOld = true;
  ImageGeometry Volume;
  OutputMap ToOutput;
  std::uint64_t ShapeVersion = 0;
};

} // namespace deformvolume

#endif
