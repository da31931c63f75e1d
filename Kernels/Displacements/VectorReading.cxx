// SPDX-License-Identifier: BSD-3-Clause
#include "VectorReading.h"

#include "DeviceVectorsInternals.h"
#include "DisplacementBuffer.h"
#include "FieldParameters.h"
#include "HostMemory.h"
#include "KernelText.h"
#include "MappingProgram.h"
#include "ParallelFor.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

constexpr cl_uint NoPoint = 0xFFFFFFFFU;

} // namespace

std::optional<PointRanges> VectorReading::Begin(const std::shared_ptr<DeviceVectors>& vectors,
  const DisplacementField& field, std::size_t numberOfPoints)
{
  CheckVectors(vectors.get(), this->Device, numberOfPoints);
  const bool isSame =
    this->Vectors == vectors && this->Field.ToDisplacement == field.ToDisplacement;
  std::optional<PointRanges> changes = isSame ? vectors->GetChanges(this->Revision) : std::nullopt;
  this->Vectors = vectors;
  this->Field.ToDisplacement = field.ToDisplacement;
  this->Revision = vectors->GetRevision();
  return changes;
}

void VectorReading::Forget()
{
  this->Vectors.reset();
  std::vector<float>().swap(this->Displacements);
}

bool VectorReading::CanConvert() const
{
  return !this->Vectors->AreInHostMemory() &&
    (HasDouble(this->Device.GetContext()) || HasDisplacements(this->Field));
}

void VectorReading::Convert(const cl::Buffer& displacements, const char* what)
{
  OpenCLContext& context = this->Device.GetContext();
  const cl::CommandQueue& queue = this->Device.GetQueue();
  const std::size_t count = this->Vectors->GetNumberOfPoints();
  const cl::Buffer& vectors = this->Vectors->GetInternals().GetBuffer();
  cl_uint bad = NoPoint;
  const cl::Buffer firstBad(context.GetContext(), CL_MEM_READ_WRITE, sizeof(bad));
  const QueueGuard guard(queue);
  queue.enqueueFillBuffer(firstBad, bad, 0, sizeof(bad));
  cl::Kernel kernel(GetConversionProgram(context), "ConvertVectors");
  cl_uint i = 0;
  kernel.setArg(i++, vectors);
  kernel.setArg(i++, MakeMatrixParameters(this->Field));
  kernel.setArg(i++, cl_ulong{ count });
  kernel.setArg(i++, static_cast<cl_float>(LargestDisplacement));
  kernel.setArg(i++, displacements);
  kernel.setArg(i++, firstBad);
  const std::size_t group = this->Device.GetGroupSize(kernel);
  context.Launch(
    queue, kernel, cl::NDRange((count + group - 1) / group * group), cl::NDRange(group));
  // This read also waits for the kernel, since the vectors may be written after the return.
  queue.enqueueReadBuffer(firstBad, CL_TRUE, 0, sizeof(bad), &bad);
  if (bad != NoPoint)
  {
    ThrowBadDisplacement(what, bad);
  }
}

void VectorReading::Check(const std::optional<PointRanges>& changes, const char* what)
{
  DisplacementField field = this->Field;
  field.Vectors = this->Vectors->Read();
  const std::size_t count = this->Vectors->GetNumberOfPoints();
  std::atomic<std::size_t> bad{ count };
  for (const auto& range : changes ? *changes : PointRanges{ { { 0, count } } })
  {
    ParallelForParts(range[1] - range[0], 1 << 14,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t point = range[0] + begin; point < range[0] + end; ++point)
        {
          const std::array<float, 3> moved =
            GetDisplacement(field, static_cast<std::int64_t>(point));
          const float largest =
            std::max({ std::abs(moved[0]), std::abs(moved[1]), std::abs(moved[2]) });
          const float sum = moved[0] + moved[1] + moved[2]; // NaN if a component is NaN
          if (!(largest <= LargestDisplacement) || std::isnan(sum))
          {
            Lower(bad, point);
            return;
          }
        }
      });
  }
  if (bad < count)
  {
    this->Forget();
    ThrowBadDisplacement(what, bad);
  }
}

const float* VectorReading::GetDisplacements(const std::optional<PointRanges>& changes)
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
