// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeImplicitTool_h
#define DeformVolumeImplicitTool_h

#include "Carving.h"

class vtkImplicitFunction;

namespace deformvolume
{

/// The tool that a function in world coordinates is: it carves out where the function is negative.
/// The tool holds the function. Functions that VTK is not known to evaluate in several threads at a
/// time are evaluated in one. Spheres and boxes without a transform have bounds. The distance from
/// the boundary is to first order.
CarvingTool MakeImplicitTool(vtkImplicitFunction* function);

} // namespace deformvolume

#endif
