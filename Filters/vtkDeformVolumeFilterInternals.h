// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeformVolumeFilterInternals_h
#define vtkDeformVolumeFilterInternals_h

#include "Deformation.h"
#include "DeformedBounds.h"
#include "DeviceSession.h"
#include "ImageGeometry.h"
#include "MappingCache.h"
#include "OutputArrays.h"

#include "vtkDeformVolumeFilter.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTimeStamp.h"

#include <functional>
#include <set>
#include <string>
#include <vector>

class vtkImageData;

/// What vtkDeformVolumeFilter keeps from one execution to the next, and what it computes from its
/// settings.
class vtkDeformVolumeFilter::vtkInternals
{
public:
  explicit vtkInternals(vtkDeformVolumeFilter* self)
    : Self(self)
  {
  }

  /// The output's spacing and whole extent, as far as settings and volume decide them.
  deformvolume::ImageGeometry GetOutputGeometry(const deformvolume::ImageGeometry& volume) const;

  deformvolume::DeformationSource MakeSource(
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest) const;

  /// The bounds of the deformed volume, united over the time steps of the deformation.
  deformvolume::IndexBounds GetDeformedBounds(
    const deformvolume::ImageGeometry& volume, vtkInformation* output);

  /// The resampler for the current deformation, which also becomes ResamplerInUse. checkMemory
  /// throws an Error where the memory does not suffice for one.
  deformvolume::Resampling ChooseResampler(
    const std::function<void(deformvolume::Resampling)>& checkMemory) const;

  /// The executive unites the extents asked for until an execution succeeds: after a failure the
  /// next one must start anew.
  static void ForgetRequestedExtent(vtkInformation* output);

  /// Whether the output is given up as soon as those after it have used it.
  static bool IsReleased(vtkInformation* output);

  /// Warns where what is ignored changed since the last call.
  void WarnOfIgnored(vtkImageData* volume, const std::vector<std::string>& leftOut);

  /// A progress callback for the part of the execution between two fractions.
  std::function<bool(double)> GetProgress(double from, double to) const;

  std::set<std::string> CategoricalArrays;
  vtkNew<vtkStringArray> DeviceChoices;
  deformvolume::Deformation Deformation;
  deformvolume::MappingCache Mapping;
  deformvolume::DeviceSession Device;
  deformvolume::OutputArrays Outputs;

  // An error is told once: what comes after a failed information pass is silent.
  bool InformationFailed = false;
  // What is wrong where that is told with the data only.
  std::string MissingInput;
  // An aborted execution leaves the filter out of date, and the next pass has to see that.
  bool Aborted = false;
  vtkTimeStamp AbortTime;

private:
  deformvolume::IndexBounds ReadBounds(
    const deformvolume::ImageGeometry& volume, vtkInformation* output, const double* time);

  vtkDeformVolumeFilter* Self;

  // What the cached bounds were computed for.
  struct BoundsKey
  {
    deformvolume::Stamp Inputs;
    deformvolume::ImageGeometry Volume;
    glm::dvec3 Scale{ 0.0 };
    double DisplacementScale = 0.0;
    std::string Choice;
    int OutsideMode = -1;
    bool operator==(const BoundsKey& other) const
    {
      return this->Inputs == other.Inputs && this->Volume == other.Volume &&
        this->Scale == other.Scale && this->DisplacementScale == other.DisplacementScale &&
        this->Choice == other.Choice && this->OutsideMode == other.OutsideMode;
    }
  };
  BoundsKey Key;
  deformvolume::IndexBounds Bounds;

  // Of the mesh at rest, and which that is.
  deformvolume::MeshBoundsPlan Plan;
  std::uint64_t PlanRestVersion = 0;
  deformvolume::Extent PlanExtent{ { 0, -1, 0, -1, 0, -1 } };

  std::string WarnedOf;
};

#endif
