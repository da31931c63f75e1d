// SPDX-License-Identifier: BSD-3-Clause
#include "VTKThreads.h"

#include "ParallelFor.h"
#include "Processors.h"

#include <vtkSMPTools.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace deformvolume
{
namespace
{

/// The number of our own threads to use instead of VTK's; 0: use VTK's. VTK's threads are not
/// reconfigured, since their settings affect the whole process. Own threads are used if
/// - VTK was built with the sequential backend, as ParaView's VTK is, and VTK_SMP_BACKEND_IN_USE is
///   not set;
/// - VTK has more threads than this process's share of the processors, and VTK_SMP_MAX_THREADS does
///   not set their number.
int GetOwnThreads()
{
  const char* variable = std::getenv("VTK_SMP_MAX_THREADS");
  const int chosen = variable ? std::max(0, std::atoi(variable)) : 0;
  const int share = GetProcessorShare();
  if (std::string(vtkSMPTools::GetBackend()) == "Sequential")
  {
    const bool byDefault =
      VTK_SMP_DEFAULT_IMPLEMENTATION_SEQUENTIAL && !std::getenv("VTK_SMP_BACKEND_IN_USE");
    return byDefault ? (chosen > 0 ? chosen : share) : 0;
  }
  return chosen == 0 && vtkSMPTools::GetEstimatedNumberOfThreads() > share ? share : 0;
}

void RunLoop(std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body)
{
  const int threads = GetOwnThreads();
  if (threads > 0)
  {
    RunOnOwnThreads(first, last, grain, body, threads);
    return;
  }
  vtkSMPTools::For(first, last, grain, [&](vtkIdType begin, vtkIdType end) { body(begin, end); });
}

} // namespace

void UseVTKThreads()
{
  SetParallelLoop(RunLoop);
}

} // namespace deformvolume
