// SPDX-License-Identifier: BSD-3-Clause
#include "Evaluation.h"
#include "../Reported.h"

#include <vtkImageData.h>

Measurement MeasureUpdate(BenchmarkCase& subject)
{
  vtkDeformVolumeFilter* filter = subject.GetFilter();
  const vtkIdType builds = GetReported(filter, "Static mappings made");
  const vtkIdType uploads = GetReported(filter, "Volumes sent");
  const UpdateTimes times = subject.Update();
  const auto voxels = static_cast<double>(subject.GetNumberOfVoxels());
  Measurement measurement;
  measurement.Seconds = times.Update;
  measurement.Counters = {
    { "mapping", times.Mapping },
    { "resampling", times.Resampling },
    { "kernels", times.GetKernels() },
    { "transfer", times.Transfer },
    { "preprocessing", times.Preprocessing },
    { "voxels", voxels },
    { "output_voxels", static_cast<double>(filter->GetOutput()->GetNumberOfPoints()) },
    { "tetrahedra_of_mesh", static_cast<double>(subject.GetNumberOfTetrahedra()) },
    { "resampler_in_use", static_cast<double>(filter->GetResamplerInUse()) },
    { "device_bytes_per_voxel", static_cast<double>(filter->GetDeviceMemory()) / voxels },
    { "mapping_builds", static_cast<double>(GetReported(filter, "Static mappings made") - builds) },
    { "volume_uploads", static_cast<double>(GetReported(filter, "Volumes sent") - uploads) },
  };
  return measurement;
}

Measurement Measure(BenchmarkCase& subject, Pose pose, Grid grid)
{
  subject.Move(pose, grid);
  return MeasureUpdate(subject);
}

std::string GetName(const std::array<int, 3>& dimensions)
{
  return std::to_string(dimensions[0]) + "x" + std::to_string(dimensions[1]) + "x" +
    std::to_string(dimensions[2]);
}
