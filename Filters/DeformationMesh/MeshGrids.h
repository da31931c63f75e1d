// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshGrids_h
#define DeformVolumeMeshGrids_h

#include "DeformationMesh.h"

#include "vtkSmartPointer.h"

#include <vector>

class vtkDataSet;
class vtkPoints;

namespace deformvolume
{

/// Finds the grids of a mesh, and makes unstructured ones of structured and rectilinear grids,
/// which share their points and point arrays, and of grids whose points are deformed already, which
/// have the points at rest. Keeps what it made until it is not as it was.
class MeshGrids
{
public:
  /// The grids in a data object, which may have none, or be null. They are valid until the next
  /// call. made: see DeformationSource::ShapeIsMade. displacements: where the points are deformed
  /// already, finds what is taken from them; else null.
  MeshParts Find(vtkDataObject* object, bool made, const ArraySelector* displacements = nullptr);

private:
  struct Conversion
  {
    vtkSmartPointer<vtkUnstructuredGrid> Grid;
    Stamp Cells;
    Stamp Points;
    Stamp PointData;
    vtkMTimeType Time = 0; // of the source itself
    vtkSmartPointer<vtkUnstructuredGrid> Rest;
    Stamp RestPoints;
  };

  static void Update(Conversion& conversion, vtkDataSet* source, bool made);
  static vtkUnstructuredGrid* UpdateRest(Conversion& conversion, vtkUnstructuredGrid* deformed,
    vtkDataArray* displacements, vtkMTimeType time);

  std::vector<Conversion> Conversions; // one for each grid
};

struct DeformationSource;

/// The grids of a deformation and of its rest configuration.
struct DeformationGrids
{
  MeshGrids Shape;
  MeshGrids Rest;

  /// Gives a source its parts. They are valid until the next call.
  void Find(DeformationSource& source);
};

} // namespace deformvolume

#endif
