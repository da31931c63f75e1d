// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshContents_h
#define DeformVolumeMeshContents_h

#include <vtkDataSet.h>
#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

/// A dataset, or one of the blocks of a composite dataset.
struct MeshPart
{
  vtkSmartPointer<vtkDataSet> Data;
  /// "", or the name of the block in quotation marks.
  std::string Block;
};

/// Returns a dataset, or all datasets of a composite dataset.
std::vector<MeshPart> FindParts(vtkDataObject* object);

/// Throws a Failure, which says what the file holds, if it cannot deform a volume: it has no
/// three-dimensional cells and is not an image, a polyhedron has no faces, or a part does not have
/// the point array of displacements. displacement: name of the array, or "" if none is needed.
void CheckMesh(vtkDataObject* mesh, const std::string& displacement, const std::string& path);

/// Throws a Failure if an image does not have the point array of displacements. If displacement is
/// "", that is the active vectors, or else the only array of three components.
void CheckField(vtkImageData* field, const std::string& displacement, const std::string& path);

/// Throws a Failure if a file holds no triangles or other polygons.
void CheckSheet(vtkDataObject* sheet, const std::string& path);

#endif
