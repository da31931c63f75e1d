// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeAbortCheck_h
#define DeformVolumeAbortCheck_h

#include "vtkAlgorithm.h"

namespace deformvolume
{

namespace detail
{
// vtkAlgorithm::CheckAbort() also hears of an abort further up the pipeline; VTK 9.1 lacks it.
// Looked for by overload, because ParaView 5.11 has it in a VTK that calls itself 9.2.
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

/// Whether the execution of this algorithm is to be given up.
inline bool IsAborted(vtkAlgorithm* algorithm)
{
  return detail::CheckAbort(algorithm, 0);
}

} // namespace deformvolume

#endif
