// SPDX-License-Identifier: BSD-3-Clause
#include "VectorConverter.h"

#include "DeviceVectorsInternals.h"
#include "DisplacementBuffer.h"
#include "FieldParameters.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "KernelText.h"
#include "MappingProgram.h"
#include "ParallelFor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

constexpr std::size_t VectorSize = 3 * sizeof(float);
constexpr cl_uint NoPoint = 0xFFFFFFFFU;

// Converts vectors on the device to displacements, four floats per point.
class Conversion
{
public:
  Conversion(WorkDevice& device, const DisplacementField& field, const cl::Buffer& displacements)
    : Device(device)
    , FirstBad(device.GetContext().GetContext(), CL_MEM_READ_WRITE, sizeof(NoPoint))
    , Guard(device.GetQueue())
    , Kernel(GetConversionProgram(device.GetContext()), "ConvertVectors")
  {
    device.GetQueue().enqueueFillBuffer(this->FirstBad, NoPoint, 0, sizeof(NoPoint));
    this->Kernel.setArg(1, MakeMatrixParameters(field));
    SetArguments(
      this->Kernel, 4, static_cast<cl_float>(LargestDisplacement), displacements, this->FirstBad);
  }

  // Begins to convert the vectors of `count` points, beginning at point `first`.
  void Launch(const cl::Buffer& vectors, std::size_t first, std::size_t count)
  {
    this->Kernel.setArg(0, vectors);
    SetArguments(this->Kernel, 2, cl_ulong{ first }, cl_ulong{ count });
    this->Device.Launch(this->Kernel, count);
  }

  // Waits for the launches. Throws Error if a displacement is too large or not finite.
  void Finish(const char* what)
  {
    cl_uint bad = NoPoint;
    this->Device.GetQueue().enqueueReadBuffer(this->FirstBad, CL_TRUE, 0, sizeof(bad), &bad);
    if (bad != NoPoint)
    {
      ThrowBadDisplacement(what, bad);
    }
  }

private:
  WorkDevice& Device;
  cl::Buffer FirstBad;
  QueueGuard Guard;
  cl::Kernel Kernel;
};

} // namespace

std::optional<PointRanges> VectorConverter::Begin(const std::shared_ptr<DeviceVectors>& vectors,
  const DisplacementField& field, std::size_t numberOfPoints)
{
  CheckVectors(vectors.get(), this->Device, numberOfPoints);
  const bool isSame =
    this->Vectors == vectors && this->Field.ToDisplacement == field.ToDisplacement;
  std::optional<PointRanges> changes = isSame ? vectors->GetChanges(this->Revision) : std::nullopt;
  this->Portion = cl::Buffer();
  this->Vectors = vectors;
  this->Field.ToDisplacement = field.ToDisplacement;
  this->Revision = vectors->GetRevision();
  return changes;
}

void VectorConverter::Forget()
{
  this->ForgetVectors();
  this->Portion = cl::Buffer();
}

void VectorConverter::ForgetVectors()
{
  this->Vectors.reset();
  std::vector<float>().swap(this->Displacements);
}

bool VectorConverter::CanConvert(const DisplacementField& field) const
{
  return !this->Device.GetDevice().IsProcessor &&
    (HasDouble(this->Device.GetContext()) || HasDisplacements(field));
}

void VectorConverter::Convert(const cl::Buffer& displacements, const char* what)
{
  Conversion conversion(this->Device, this->Field, displacements);
  conversion.Launch(
    this->Vectors->GetInternals().GetBuffer(), 0, this->Vectors->GetNumberOfPoints());
  // Also waits for the kernel, since the vectors may be written after the return.
  conversion.Finish(what);
}

void VectorConverter::Convert(const DisplacementField& field,
  const std::array<std::size_t, 2>& range, const cl::Buffer& displacements, const char* what)
{
  this->ForgetVectors();
  const std::size_t most =
    std::min(static_cast<std::size_t>(GetNumberOfPoints(field)), PointsOfPortion);
  Reserve(this->Device.GetContext(), this->Portion, most * VectorSize);
  Conversion conversion(this->Device, field, displacements);
  for (std::size_t first = range[0]; first < range[1]; first += most)
  {
    const std::size_t count = std::min(most, range[1] - first);
    Write(this->Device.GetQueue(), this->Portion, 0, count * VectorSize, field.Vectors + 3 * first);
    conversion.Launch(this->Portion, first, count);
  }
  conversion.Finish(what);
}

void VectorConverter::Check(const std::optional<PointRanges>& changes, const char* what)
{
  DisplacementField field = this->Field;
  field.Vectors = this->Vectors->Read();
  const std::size_t count = this->Vectors->GetNumberOfPoints();
  std::size_t bad = count;
  for (const auto& range : changes ? *changes : PointRanges{ { { 0, count } } })
  {
    const std::size_t size = range[1] - range[0];
    const std::size_t found = FindFirst(size, 1 << 14,
      [&](std::size_t i)
      {
        const std::array<float, 3> moved =
          GetDisplacement(field, static_cast<std::int64_t>(range[0] + i));
        // The negated comparison is true for NaN, too.
        return std::any_of(moved.begin(), moved.end(),
          [](float component) { return !(std::abs(component) <= LargestDisplacement); });
      });
    bad = found < size ? std::min(bad, range[0] + found) : bad;
  }
  if (bad < count)
  {
    this->Forget();
    ThrowBadDisplacement(what, bad);
  }
}

const float* VectorConverter::GetDisplacements(const std::optional<PointRanges>& changes)
{
  const float* vectors = this->Vectors->Read();
  if (HasDisplacements(this->Field))
  {
    return vectors;
  }
  DisplacementField field = this->Field;
  field.Vectors = vectors;
  const std::size_t points = this->Vectors->GetNumberOfPoints();
  const bool isKept = changes && this->Displacements.size() == 3 * points;
  this->Displacements.resize(3 * points);
  for (const auto& range : isKept ? *changes : PointRanges{ { { 0, points } } })
  {
    MapVectors(field, range, this->Displacements.data());
  }
  return this->Displacements.data();
}

} // namespace deformvolume
