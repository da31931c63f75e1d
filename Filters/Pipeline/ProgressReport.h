// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgressReport_h
#define DeformVolumeProgressReport_h

#include "IsAborted.h"

#include "vtkAlgorithm.h"

#include <chrono>

namespace deformvolume
{

/// Reports the progress of an algorithm to its observers, at most every 20 ms: observers may
/// render.
class ProgressReport
{
public:
  explicit ProgressReport(vtkAlgorithm* algorithm)
    : Algorithm(algorithm)
  {
  }

  /// done: 0 to 1. Returns false if the execution has to be aborted.
  bool Report(double done)
  {
    if (this->IsDue())
    {
      this->Algorithm->UpdateProgress(done);
    }
    return !IsAborted(this->Algorithm);
  }
  /// The same for executions of unknown length: each report adds a tenth of the rest.
  bool Report()
  {
    if (this->IsDue())
    {
      this->Done += 0.1 * (1.0 - this->Done);
      this->Algorithm->UpdateProgress(this->Done);
    }
    return !IsAborted(this->Algorithm);
  }

private:
  bool IsDue()
  {
    const auto now = std::chrono::steady_clock::now();
    const bool isDue = now >= this->Next;
    this->Next = isDue ? now + std::chrono::milliseconds(20) : this->Next;
    return isDue;
  }

  vtkAlgorithm* Algorithm;
  std::chrono::steady_clock::time_point Next = std::chrono::steady_clock::now();
  double Done = 0.0;
};

} // namespace deformvolume

#endif
