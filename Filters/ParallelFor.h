// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeParallelFor_h
#define DeformVolumeParallelFor_h

#include "FirstException.h"
#include "HostThreads.h"

#include <vtkSMPTools.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>

namespace deformvolume
{

/// How many threads the user of VTK's threads has asked for: vtkSMPTools::Initialize() or the
/// environment variable VTK_SMP_MAX_THREADS; 0 where the number is left open.
inline int GetChosenThreads()
{
  const vtkSMPTools::Config config(vtk::detail::smp::vtkSMPToolsAPI::GetInstance());
  const char* variable = std::getenv("VTK_SMP_MAX_THREADS");
  return config.MaxNumberOfThreads > 0 ? config.MaxNumberOfThreads
                                       : (variable ? std::max(0, std::atoi(variable)) : 0);
}

/// How many threads of our own to use instead of VTK's, 0: none. VTK's are set for the whole
/// process, so that changing them for one filter would disturb all others. They do not serve where
/// - VTK is sequential because it was built so, as ParaView's is, and nobody has chosen that with
///   VTK_SMP_BACKEND_IN_USE;
/// - they are more than this process's share of the processors, and nobody has chosen their number.
inline int GetOwnThreads()
{
  const int chosen = GetChosenThreads();
  const int share = GetProcessorShare();
  if (std::string(vtkSMPTools::GetBackend()) == "Sequential")
  {
    const bool byDefault =
      VTK_SMP_DEFAULT_IMPLEMENTATION_SEQUENTIAL && !std::getenv("VTK_SMP_BACKEND_IN_USE");
    return byDefault ? (chosen > 0 ? chosen : share) : 0;
  }
  return chosen == 0 && vtkSMPTools::GetEstimatedNumberOfThreads() > share ? share : 0;
}

/// Calls body(begin, end) for parts of a range in parallel; a part has grain items, 0: chosen by
/// the backend. What a call throws first is thrown once all have ended; parts that had not begun
/// are left out then. The settings of vtkSMPTools are respected and stay as they are.
template <typename Body>
void ParallelFor(vtkIdType first, vtkIdType last, vtkIdType grain, Body&& body)
{
  const int threads = GetOwnThreads();
  if (threads > 0)
  {
    constexpr vtkIdType partsOfThread = 4;
    const vtkIdType size = std::max<vtkIdType>(0, last - first);
    const vtkIdType step =
      grain > 0 ? grain : std::max<vtkIdType>(1, size / (threads * partsOfThread));
    RunOnThreads(static_cast<std::size_t>((size + step - 1) / step),
      static_cast<std::size_t>(threads),
      [&](std::size_t part)
      {
        const vtkIdType begin = first + static_cast<vtkIdType>(part) * step;
        body(begin, std::min(last, begin + step));
      });
    return;
  }
  FirstException failure;
  vtkSMPTools::For(first, last, grain,
    [&](vtkIdType begin, vtkIdType end) { failure.Run([&] { body(begin, end); }); });
  failure.Rethrow();
}

} // namespace deformvolume

#endif
