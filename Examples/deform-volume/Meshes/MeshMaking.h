// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshMaking_h
#define DeformVolumeMeshMaking_h

#include "Options.h"
#include "Volume.h"

#include <vtkDataObject.h>
#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

class Messages;
class vtkUnstructuredGrid;

/// The deformation of the volume, and descriptions of it that the program prints.
struct Deformation
{
  /// A mesh or a displacement field; null: the volume is not deformed.
  vtkSmartPointer<vtkDataObject> Data;
  /// The mesh at rest, if Data is the deformed mesh.
  vtkSmartPointer<vtkDataObject> Rest;
  /// If Rest is null: the name of the array of displacements; "": the only array of vectors.
  std::string Displacement;
  /// The isovalue that TetGen's mesh was made with.
  std::optional<double> Isovalue;
  /// Result of a model, and of the cuts in its mesh.
  std::string Motion;
  std::string Cut;
  /// Number of fixed nodes of a model.
  std::string Fixed;
  /// Numbers of voxels of the body that was meshed, and lengths of edges.
  std::string Body;
  std::vector<std::string> Edges;
};

/// Reads or computes the deformation of the options. grid: the grid of the result without
/// --padding; --transform is sampled on the grid with padding. Calls takeFrame with each frame of a
/// model, including the last one. Throws a Failure if that is not possible.
Deformation MakeDeformation(const Options& options, const Volume& volume, vtkImageData* grid,
  Messages& messages, const FrameTaker& takeFrame);

/// Returns the volume of a tetrahedron of a mesh.
double GetVolume(vtkUnstructuredGrid* mesh, vtkIdType tetrahedron);

/// Sets the deformation of a vtkDeformVolumeFilter or vtkDeformGeometryFilter, and the options that
/// apply to it.
template <typename Filter>
void SetDeformation(Filter* filter, const Options& options, const Deformation& deformation)
{
  filter->SetDeformationData(deformation.Data);
  if (deformation.Rest)
  {
    filter->SetRestData(deformation.Rest);
  }
  else
  {
    filter->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, deformation.Displacement.c_str());
  }
  filter->SetDisplacementScale(options.Scale);
  filter->SetPointsAreDeformed(options.PointsAreDeformed);
  filter->SetFieldIsInverse(options.FieldIsInverse);
  filter->SetOutsideMode(options.KeepDistance ? Filter::KEEP
      : options.Outside == "extrapolate"      ? Filter::EXTRAPOLATE
                                              : Filter::DISCARD);
  filter->SetFadeDistance(options.KeepDistance.value_or(0.0));
}

#endif
