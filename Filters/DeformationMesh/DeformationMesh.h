// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformationMesh_h
#define DeformVolumeDeformationMesh_h

#include "NodeFaults.h"
#include "Stamp.h"
#include "VectorArray.h"

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <functional>
#include <string>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkDataObject;
class vtkDataSet;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// What errors call the meshes.
constexpr const char* MESH_NAME = "deformation mesh";
constexpr const char* REST_NAME = "rest configuration";

/// The grids that make up a mesh: one, or the leaves of a composite dataset. Nodes are counted
/// through all of them, in order.
struct MeshParts : std::vector<vtkUnstructuredGrid*>
{
  using std::vector<vtkUnstructuredGrid*>::vector;
  /// The name or number of each block of a composite dataset; empty for a single grid.
  std::vector<std::string> Blocks;
};

/// What errors call a part of the mesh that they call by `name`.
std::string DescribePart(const MeshParts& parts, std::size_t part, const std::string& name);

/// Throws an Error, which calls the mesh by `name`, where there is no part, or no point in all of
/// them. object: where the parts were found (see MeshGrids).
void CheckParts(const MeshParts& parts, vtkDataObject* object, const std::string& name);

std::size_t GetNumberOfNodes(const MeshParts& parts);

/// The points, in world coordinates. Throws an Error where tetrahedra use one that is not finite.
std::vector<glm::dvec3> ReadPoints(
  const MeshParts& parts, const std::string& name, const std::vector<Tetrahedron>& tetrahedra);

/// Throws an Error where tetrahedra use a point that is not finite.
void CheckPoints(const MeshParts& parts, const std::string& name, const NodeFaults& faults,
  const std::vector<Tetrahedron>& tetrahedra);

/// Finds the vectors of a dataset, or null.
using ArraySelector = std::function<vtkDataArray*(vtkDataSet*)>;

/// The array that a selector finds, checked to be one of three components, with as many tuples as
/// the dataset has points. `wanted` says in words what is looked for.
vtkDataArray* FindVectors(vtkDataSet* dataSet, const ArraySelector& selector,
  const std::string& wanted, const std::string& name);

/// Whether a dataset has these as one vector of three components for each point; they may be null.
bool HaveVectors(vtkDataSet* dataSet, vtkDataArray* vectors);

/// Vectors of all points, one part's after the other's. Those that are not finite, and those of
/// parts without a usable array, are marked in faults, after they have been taken as zeros.
/// memories: of the last reading (see ReadVectors), where they were taken to the same places; null:
/// all are taken.
void ReadPointVectors(const MeshParts& parts, const ArraySelector& selector, NodeFaults& faults,
  const VectorTaker& take, std::vector<VectorMemory>* memories = nullptr);

/// Throws an Error where tetrahedra use a node without a vector, or with one that is not finite.
/// Those that are too far are left to the caller.
void CheckPointVectors(const MeshParts& parts, const ArraySelector& selector,
  const std::string& wanted, const std::string& name, const NodeFaults& faults,
  const std::vector<Tetrahedron>& tetrahedra);

///@{
/// What the functions above depend on.
Stamp GetPointsStamp(const MeshParts& parts);
Stamp GetPointVectorsStamp(const MeshParts& parts);
///@}

} // namespace deformvolume

#endif
