// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeParallelFor_h
#define DeformVolumeParallelFor_h

#include <vtkSMPTools.h>

#include <cstring>
#include <string>

namespace deformvolume
{

/// Calls body(begin, end) for parts of a range in parallel; a part has grain items, 0: chosen by
/// the backend. body must not throw. A backend that is sequential is replaced by standard threads
/// meanwhile, because that is ParaView's default and not a choice of its users.
template <typename Body>
void ParallelFor(vtkIdType first, vtkIdType last, vtkIdType grain, Body&& body)
{
  auto run = [&]() { vtkSMPTools::For(first, last, grain, body); };
  const char* backend = vtkSMPTools::GetBackend();
  if (backend && std::strcmp(backend, "Sequential") == 0)
  {
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ std::string("STDThread") }, run);
  }
  else
  {
    run();
  }
}

} // namespace deformvolume

#endif
