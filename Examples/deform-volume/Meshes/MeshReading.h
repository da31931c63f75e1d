// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshReading_h
#define DeformVolumeMeshReading_h

#include <vtkDataObject.h>
#include <vtkPointSet.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <string>

class Messages;
struct Options;
struct Volume;

/// The mesh of a file: a vtkUnstructuredGrid, vtkStructuredGrid, vtkRectilinearGrid or a composite
/// dataset with three-dimensional cells; or a vtkImageData, which is a displacement field. Of a
/// series in time it is the last step, which a warning says. All parts with three-dimensional cells
/// have the point array of displacements, if it is named. Points and displacements are turned into
/// the world of the volume. Throws a Failure that says what the file holds and what is needed.
vtkSmartPointer<vtkDataObject> ReadMesh(const std::string& path, const std::string& displacement,
  const Options& options, const Volume& volume, Messages& messages);

/// The sheet of a file, which has triangles or other polygons, in the world of the volume. Throws a
/// Failure as well.
vtkSmartPointer<vtkPolyData> ReadSheet(
  const std::string& path, const Options& options, const Volume& volume, Messages& messages);

/// What a .vtp or .vtu file holds, in the world of the file. Throws a Failure as well.
vtkSmartPointer<vtkPointSet> ReadGeometry(
  const std::string& path, const Options& options, Messages& messages);

#endif
