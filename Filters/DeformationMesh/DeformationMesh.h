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

/// Names of the meshes in messages.
constexpr const char* MESH_NAME = "deformation mesh";
constexpr const char* REST_NAME = "mesh at rest";

/// The grids that make up a mesh: one, or the leaves of a composite dataset. Node indices are
/// counted over all grids, in order.
struct MeshParts : std::vector<vtkUnstructuredGrid*>
{
  using std::vector<vtkUnstructuredGrid*>::vector;
  /// The name or number of each block of a composite dataset; empty for a single grid.
  std::vector<std::string> Blocks;
  /// The blocks that are image data, separated by commas. They are not part of the mesh.
  std::string Ignored;
};

/// Returns a warning that names the ignored blocks; "" if there are none.
std::string DescribeIgnored(const MeshParts& parts);

/// The name of a part of a mesh in messages. name: the name of the mesh.
std::string DescribePart(const MeshParts& parts, std::size_t part, const std::string& name);

/// Throws an Error if there is no part, there is no point in all parts, or there are too many
/// points. object: the data object in which MeshGrids has found the parts. name: the name of the
/// mesh in messages.
void CheckParts(const MeshParts& parts, vtkDataObject* object, const std::string& name);

std::size_t GetNumberOfNodes(const MeshParts& parts);

/// The points in world coordinates. Throws an Error if tetrahedra use a point that is not finite.
std::vector<glm::dvec3> ReadPoints(
  const MeshParts& parts, const std::string& name, const std::vector<Tetrahedron>& tetrahedra);

/// Throws an Error if tetrahedra use a point that is not finite.
void CheckPoints(const MeshParts& parts, const std::string& name, const NodeFaults& faults,
  const std::vector<Tetrahedron>& tetrahedra);

/// Finds the vectors of a dataset, or null.
using ArraySelector = std::function<vtkDataArray*(vtkDataSet*)>;

/// Returns the array that a selector finds. Throws an Error if there is none, or if it does not
/// have three components and one tuple for each point of the dataset. wanted: describes the array
/// in messages.
vtkDataArray* FindVectors(vtkDataSet* dataSet, const ArraySelector& selector,
  const std::string& wanted, const std::string& name);

/// Whether an array, which may be null, has three components and one tuple for each point of a
/// dataset.
bool HaveVectors(vtkDataSet* dataSet, vtkDataArray* vectors);

/// Reads the vectors of all points, part by part. Vectors that are not finite, and those of parts
/// without a usable array, are marked in faults, after `take` received zeros for them. memories:
/// the last reading of each part, see ReadVectors(); null: all vectors are read.
void ReadPointVectors(const MeshParts& parts, const ArraySelector& selector, NodeFaults& faults,
  const VectorTaker& take, std::vector<VectorMemory>* memories = nullptr);

/// Throws an Error if tetrahedra use a node without a vector, or with a vector that is not finite.
/// The caller handles nodes that move too far.
void CheckPointVectors(const MeshParts& parts, const ArraySelector& selector,
  const std::string& wanted, const std::string& name, const NodeFaults& faults,
  const std::vector<Tetrahedron>& tetrahedra);

///@{
/// Differ if the functions above may give another result.
Stamp GetPointsStamp(const MeshParts& parts);
Stamp GetPointVectorsStamp(const MeshParts& parts);
///@}

} // namespace deformvolume

#endif
