// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePipelineExecution_h
#define DeformVolumePipelineExecution_h

#include <functional>

class vtkAlgorithm;

namespace deformvolume
{

/// What comes of the executions of an algorithm that throw Error and Aborted.
class PipelineExecution
{
public:
  /// Calls body, and returns what RequestData returns. Errors are displayed; noMemory: the one
  /// where there is not enough memory. What body has put into an output by then stays there.
  int Run(vtkAlgorithm* algorithm, const char* noMemory, const std::function<void()>& body);

  /// For ComputePipelineMTime: an aborted output is not up to date, but the executive takes it for
  /// that. The algorithm is modified then.
  void RenewAborted(vtkAlgorithm* algorithm);

private:
  bool IsAborted = false;
};

} // namespace deformvolume

#endif
