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

/// Selects the Hamming window, the only one before VTK 9.4 and no longer the default since. With
/// the new default and the few iterations that are used here, the filter finds no offset that keeps
/// the size of a surface: a ball grows by a third of its volume.
inline void UseHammingWindow(vtkWindowedSincPolyDataFilter* filter)
{
  detail::UseHammingWindow(filter, 0);
}

} // namespace deformvolume

#endif
