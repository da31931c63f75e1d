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

/// Finds the grids of a mesh. Converts structured and rectilinear grids to unstructured grids,
/// which share the point arrays, and if possible the points. Converts grids with deformed points to
/// grids with the points at rest. The converted grids are kept until the originals change.
class MeshGrids
{
public:
  /// The grids in a data object, which may have none or be null. They are valid until the next
  /// call. made: see DeformationSource::ShapeIsMade. displacements: if the points are deformed,
  /// finds the displacements to subtract from them; else null.
  MeshParts Find(vtkDataObject* object, bool made, const ArraySelector* displacements = nullptr);

private:
  struct Conversion
  {
    vtkSmartPointer<vtkUnstructuredGrid> Grid;
    Stamp Cells;
    Stamp Points;
    Stamp PointData;
    vtkMTimeType Time = 0; // modification time of the source
    vtkSmartPointer<vtkUnstructuredGrid> Rest;
    Stamp RestPoints;
  };

  static void Update(Conversion& conversion, vtkDataSet* source, bool made);
  static vtkUnstructuredGrid* UpdateRest(Conversion& conversion, vtkUnstructuredGrid* deformed,
    vtkDataArray* displacements, vtkMTimeType time);

  std::vector<Conversion> Conversions; // one for each grid
};

struct DeformationSource;

/// Finds the grids of a deformation and of its mesh at rest.
struct DeformationGrids
{
  MeshGrids Shape;
  MeshGrids Rest;

  /// Sets ShapeParts and RestParts of a source. They are valid until the next call.
  void Find(DeformationSource& source);
};

} // namespace deformvolume

#endif
