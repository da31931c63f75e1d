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

/// Reads the mesh of a file: a vtkUnstructuredGrid, vtkStructuredGrid, vtkRectilinearGrid or a
/// composite dataset with three-dimensional cells; or a vtkImageData, which is a displacement
/// field. If there are several time steps, reads the last one, or the first one of a mesh at rest,
/// and warns. If `displacement` is not
/// "", all parts with three-dimensional cells must have the point array of this name. Points and
/// displacements are converted to the world coordinates of the volume. Throws a Failure that says
/// what the file holds and what is needed.
vtkSmartPointer<vtkDataObject> ReadMesh(const std::string& path, const std::string& displacement,
  bool isRest, const Options& options, const Volume& volume, Messages& messages);

/// Reads a sheet of triangles or other polygons, and converts it to the world coordinates of the
/// volume. Throws a Failure if the file has no polygons or cannot be read.
vtkSmartPointer<vtkPolyData> ReadSheet(
  const std::string& path, const Options& options, const Volume& volume, Messages& messages);

/// Reads a .vtp or .vtu file, in the world coordinates of the file. Throws a Failure if it cannot
/// be read.
vtkSmartPointer<vtkPointSet> ReadGeometry(
  const std::string& path, const Options& options, Messages& messages);

#endif
