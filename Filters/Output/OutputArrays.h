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

/// The arrays of a filter's output. The arrays of the last execution are used again if nobody else
/// holds references to them: writing to new memory for the first time costs more than deforming a
/// volume. If others hold references, as mappers do, the arrays of the execution before the last
/// one are used, so that two sets of arrays alternate.
class OutputArrays
{
public:
  /// Drops kept arrays that cannot be used again for arrays like the sources with this number of
  /// tuples. The output must not hold the arrays when this is called.
  void Prepare(const std::vector<SourceArray>& sources, vtkIdType numberOfTuples);
  /// Returns the size in bytes of the kept arrays that the next output uses again. Call it after
  /// Prepare().
  std::uint64_t GetReusableBytes();

  /// Makes an array like each of the sources, and vtkValidPointMask. Sets the memory of these
  /// arrays in the request, and that of the last output if nobody has changed it. Call this after
  /// Prepare() with the same arguments.
  void Make(const std::vector<SourceArray>& sources, DeformRequest& request);

  /// Adds the arrays to the image as point arrays, after the request is done. If the values are on
  /// the device, adds arrays that download them at the first access instead. Integers of 64 bits
  /// are downloaded at once, and the time for this is added to the report.
  void Give(DeformReport& report, vtkImageData* image);

  /// Keeps the arrays of Make() for the next execution.
  void Keep(const DeformReport& report);
  void Forget();

  /// Number of arrays of the last output that are still on the device, because nobody has read
  /// them.
  int GetNumberOfUnread() const;

private:
  // An array of an output, and its state when it was kept.
  struct KeptArray
  {
    vtkSmartPointer<vtkDataArray> Array;
    const void* Values = nullptr;
    vtkMTimeType Modified = 0;
    std::uint64_t Revision = 0;
    std::shared_ptr<DeviceOutput> OnDevice; // null: the values are on the host

    /// Whether the array has this number of tuples and still the values of the output.
    bool IsUnchanged(vtkIdType numberOfTuples) const;
    bool IsHeldByOthers() const;
  };

  /// The kept array that is used for an array of the next output; empty if there is none.
  KeptArray& GetReusable(std::size_t array);
  /// The revision of the output that the arrays in BeforeLast hold, if these are used next; 0 if
  /// they hold several revisions.
  std::uint64_t GetReusableRevision();

  vtkIdType NumberOfTuples = 0;
  std::vector<KeptArray> Last;
  std::vector<KeptArray>
    BeforeLast; // of the execution before the last one, used if others hold Last
  std::vector<vtkSmartPointer<vtkDataArray>> Made;
};

} // namespace deformvolume

#endif
