// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformationMesh_h
#define DeformVolumeDeformationMesh_h

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
constexpr const char* MESH_NAME = "deformation mesh on input port 1";
constexpr const char* REST_NAME = "rest configuration on input port 2";

/// The grids that make up a mesh: one, or the leaves of a composite dataset. Nodes are counted
/// through all of them, in order.
using MeshParts = std::vector<vtkUnstructuredGrid*>;

/// Tells two states of VTK objects apart: addresses and modification times.
using Stamp = std::vector<std::pair<const void*, vtkMTimeType>>;

/// The grids in a data object, which may have none, or be null.
MeshParts FindGrids(vtkDataObject* object);

/// The grids in a data object, which the Errors thrown call by `name`: there must be one, and it
/// must have points.
MeshParts GetMeshParts(vtkDataObject* object, const std::string& name);

std::size_t GetNumberOfNodes(const MeshParts& parts);

/// The points, in world coordinates.
std::vector<glm::dvec3> ReadPoints(const MeshParts& parts, const std::string& name);

/// Finds the vectors of a dataset, or null.
using ArraySelector = std::function<vtkDataArray*(vtkDataSet*)>;

/// The array that a selector finds, checked to be one of three components, with as many tuples as
/// the dataset has points. `wanted` says in words what is looked for.
vtkDataArray* FindVectors(vtkDataSet* dataSet, const ArraySelector& selector,
  const std::string& wanted, const std::string& name);

/// Vectors of all points, one part's after the other's. memories: of the last reading, where they
/// were taken to the same places; null: all are taken. memories, takeFloats: see ReadVectors.
void ReadPointVectors(const MeshParts& parts, const ArraySelector& selector,
  const std::string& wanted, const std::string& name, const VectorTaker& take,
  std::vector<VectorMemory>* memories = nullptr, const FloatTaker& takeFloats = {});

///@{
/// What the functions above depend on.
Stamp GetPointsStamp(const MeshParts& parts);
Stamp GetPointVectorsStamp(const MeshParts& parts);
///@}

} // namespace deformvolume

#endif
