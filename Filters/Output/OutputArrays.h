// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputArrays_h
#define DeformVolumeOutputArrays_h

#include "DeformRequest.h"
#include "VolumeArrays.h"

#include "vtkSmartPointer.h"

#include <cstdint>
#include <vector>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

/// The arrays of a filter's output. Those of the last execution serve again where nobody else holds
/// them: to write memory for the first time costs more than to deform a volume.
class OutputArrays
{
public:
  /// Drops what cannot serve for arrays like these, of so many tuples; returns the bytes of what
  /// can. The output holds no array when this is called.
  std::uint64_t Prepare(const std::vector<SourceArray>& sources, vtkIdType numberOfTuples);

  /// Gives the image a point array like each of the sources and vtkValidPointMask, and the request
  /// their memory, and that of the last output where nobody has changed it. After Prepare() with
  /// the same arguments.
  void Make(const std::vector<SourceArray>& sources, vtkImageData* image, DeformRequest& request);

  /// Keeps what Make() made, now that it is written, for the next execution.
  void Keep();
  void Forget();

private:
  using Arrays = std::vector<vtkSmartPointer<vtkDataArray>>;

  vtkIdType NumberOfTuples = 0;
  Arrays Last;
  Stamp LastStamp;
  Arrays Made;
};

} // namespace deformvolume

#endif
