// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshContents_h
#define DeformVolumeMeshContents_h

#include <vtkDataSet.h>
#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

/// A dataset, or one of the blocks of a composite one.
struct MeshPart
{
  vtkSmartPointer<vtkDataSet> Data;
  /// "", or the name of the block in quotation marks.
  std::string Block;
};

/// All datasets in an object that a file held.
std::vector<MeshPart> FindParts(vtkDataObject* object);

/// Whether a part is a grid with three-dimensional cells, which can deform a volume.
bool HasVolumeCells(vtkDataSet* data);

/// Throws a Failure, which says what the file holds, where it cannot deform a volume: it has no
/// three-dimensional cells and is no image, a polyhedron lacks its faces, or a part lacks the point
/// array of displacements. displacement: its name, or "" where none is needed.
void CheckMesh(vtkDataObject* mesh, const std::string& displacement, const std::string& path);

/// The longest side of the box of all parts that can deform a volume.
double GetMeshLength(vtkDataObject* mesh);

/// Throws a Failure where an image lacks the point array of displacements. Without a name that is
/// the active vectors, or else the only array of three components.
void CheckField(vtkImageData* field, const std::string& displacement, const std::string& path);

/// Throws a Failure where a file holds no triangles or other polygons.
void CheckSheet(vtkDataObject* sheet, const std::string& path);

#endif
