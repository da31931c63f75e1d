// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputArrays_h
#define DeformVolumeOutputArrays_h

#include "DeformRequest.h"
#include "VolumeArrays.h"

#include "vtkSmartPointer.h"

#include <cstdint>
#include <memory>
#include <vector>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

/// The arrays of a filter's output. Those of the last execution serve again where nobody else holds
/// them: to write memory for the first time costs more than to deform a volume. Where somebody
/// does, as mappers do, two take turns: the one of the execution before the last one serves.
class OutputArrays
{
public:
  /// Drops what cannot serve for arrays like these, of so many tuples; returns the bytes of what
  /// can. The output holds no array when this is called.
  std::uint64_t Prepare(const std::vector<SourceArray>& sources, vtkIdType numberOfTuples);

  /// Makes an array like each of the sources and vtkValidPointMask, and gives the request their
  /// memory, and that of the last output where nobody has changed it. After Prepare() with the same
  /// arguments.
  void Make(const std::vector<SourceArray>& sources, DeformRequest& request);

  /// Gives the image these arrays, now that the request is done, as point arrays. Where the values
  /// have stayed on the device, what reads them there; but integers of 64 bits go to the host at
  /// once, which is added to the report.
  void Give(DeformReport& report, vtkImageData* image);

  /// Keeps what Make() made for the next execution.
  void Keep(const DeformReport& report);
  void Forget();

  /// How many arrays of the last output nobody has read, and are on the device.
  int GetNumberOfUnread() const;

private:
  // An array of an output, as it was kept.
  struct Kept
  {
    vtkSmartPointer<vtkDataArray> Array;
    const void* Values = nullptr;
    vtkMTimeType Modified = 0;
    std::uint64_t Revision = 0;
    std::shared_ptr<DeviceOutput> OnDevice; // null: the values came to the host at once

    /// Whether it is of so many tuples, has the values of the output, and nobody has written to it.
    bool IsAsKept(vtkIdType numberOfTuples) const;
    bool IsHeldByOthers() const;
  };

  /// What serves for an array, or an empty one.
  Kept& GetServing(std::size_t array);
  /// The revision of what the arrays hold that serve in place of others, where that is one.
  std::uint64_t GetServingRevision();

  vtkIdType NumberOfTuples = 0;
  std::vector<Kept> Last;
  std::vector<Kept> Older; // of the execution before, those that serve in turn
  std::vector<vtkSmartPointer<vtkDataArray>> Made;
};

} // namespace deformvolume

#endif
