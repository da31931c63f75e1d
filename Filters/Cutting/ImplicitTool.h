// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeImplicitTool_h
#define DeformVolumeImplicitTool_h

#include "Carving.h"

class vtkImplicitFunction;

namespace deformvolume
{

/// Makes a tool that carves where a function of world coordinates is negative. The tool holds a
/// reference to the function. Unless the class of the function is known to be thread-safe, only one
/// thread evaluates it at a time. Spheres and boxes without a transform have bounds. The distance
/// from the boundary is a first-order approximation.
CarvingTool MakeImplicitTool(vtkImplicitFunction* function);

} // namespace deformvolume

#endif
