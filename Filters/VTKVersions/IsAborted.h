// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIsAborted_h
#define DeformVolumeIsAborted_h

#include "vtkAlgorithm.h"

namespace deformvolume
{

namespace detail
{
// vtkAlgorithm::CheckAbort() also finds an abort upstream in the pipeline. VTK 9.1 does not have
// it. It is detected by overload resolution and not by the version, because ParaView 5.11 has it in
// a VTK with the version 9.2.
template <typename Algorithm>
auto CheckAbort(Algorithm* algorithm, int) -> decltype(static_cast<bool>(algorithm->CheckAbort()))
{
  return algorithm->CheckAbort();
}

template <typename Algorithm>
bool CheckAbort(Algorithm* algorithm, long)
{
  return algorithm->GetAbortExecute() != 0;
}
} // namespace detail

/// Whether the execution of this algorithm has to be aborted.
inline bool IsAborted(vtkAlgorithm* algorithm)
{
  return detail::CheckAbort(algorithm, 0);
}

} // namespace deformvolume

#endif
