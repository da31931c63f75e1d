// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgressReport_h
#define DeformVolumeProgressReport_h

#include "AbortCheck.h"

#include "vtkAlgorithm.h"

#include <chrono>

namespace deformvolume
{

/// Tells the observers of an algorithm how far its execution has come, now and then: they may draw.
class ProgressReport
{
public:
  explicit ProgressReport(vtkAlgorithm* algorithm)
    : Algorithm(algorithm)
  {
  }

  /// done: 0 to 1. Returns false where the execution is to be given up.
  bool Tell(double done)
  {
    if (this->IsDue())
    {
      this->Algorithm->UpdateProgress(done);
    }
    return !IsAborted(this->Algorithm);
  }
  /// The same where nobody knows how much there is to do: each time a tenth of the rest.
  bool Tell()
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
