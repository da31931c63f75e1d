// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePipelineExecution_h
#define DeformVolumePipelineExecution_h

#include <functional>

class vtkAlgorithm;

namespace deformvolume
{

/// The outcome of the requests of an algorithm that throw Error and Aborted.
class PipelineExecution
{
public:
  /// Calls body, and returns the result of the request: 0 after an error, which is reported; 1
  /// after an abort. noMemory: the message if there is not enough memory. Data that body has put
  /// into an output remain there.
  int Run(vtkAlgorithm* algorithm, const char* noMemory, const std::function<void()>& body);

  /// Whether a request has failed since Renew() was last called, which happens before each update.
  bool HasFailed() const { return this->Failed; }

  /// For ComputePipelineMTime: the executive regards the output of an execution that failed or was
  /// aborted as up to date. This function marks the algorithm as modified, so that the next update
  /// executes it again.
  void Renew(vtkAlgorithm* algorithm);

private:
  bool Incomplete = false; // failed, or aborted
  bool Failed = false;
};

} // namespace deformvolume

#endif
