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

/// What deforms the volume.
struct Deformation
{
  /// A mesh or a displacement field; null: the volume stays where it is.
  vtkSmartPointer<vtkDataObject> Data;
  /// The mesh at rest, if Data is the deformed mesh.
  vtkSmartPointer<vtkDataObject> Rest;
  /// Otherwise the name of the array of displacements; "": the only one there is.
  std::string Displacement;
  /// The isovalue of the surface that was meshed.
  std::optional<double> Isovalue;
  /// What a model has moved, and what has been cut of its mesh.
  std::string Motion;
  std::string Cut;
  /// What became of the voxels of the body that was meshed, and how long edges are where.
  std::string Body;
  std::vector<std::string> Edges;
  long long NumberOfNodes = 0;
  long long NumberOfCells = 0;
};

/// Reads or makes what the options ask for. grid: the voxels of the result, for a --transform.
/// takeFrame is called with each frame of a model, the last one included. Throws a Failure where it
/// is impossible.
Deformation MakeDeformation(const Options& options, const Volume& volume, vtkImageData* grid,
  Messages& messages, const FrameTaker& takeFrame);

/// Gives a vtkDeformVolumeFilter or vtkDeformGeometryFilter the deformation, and what the options
/// say of it.
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
      : options.Extrapolate                   ? Filter::EXTRAPOLATE
                                              : Filter::DISCARD);
  filter->SetFadeDistance(options.KeepDistance.value_or(0.0));
}

#endif
