// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSincWindow_h
#define DeformVolumeSincWindow_h

#include "vtkWindowedSincPolyDataFilter.h"

namespace deformvolume
{

namespace detail
{
template <typename Filter>
auto UseHammingWindow(Filter* filter, int) -> decltype(filter->SetWindowFunctionToHamming())
{
  filter->SetWindowFunctionToHamming();
}

template <typename Filter>
void UseHammingWindow(Filter*, long)
{
}
} // namespace detail

/// The window that surfaces are smoothed with: Hamming's, the only one there was before VTK 9.4,
/// and not the default since. With that one, and as few iterations as we make, the filter finds no
/// offset that keeps the size of a surface: a ball grows by a third of its volume.
inline void UseHammingWindow(vtkWindowedSincPolyDataFilter* filter)
{
  detail::UseHammingWindow(filter, 0);
}

} // namespace deformvolume

#endif
