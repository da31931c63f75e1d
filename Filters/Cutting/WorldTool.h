// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldTool_h
#define DeformVolumeWorldTool_h

#include "Carving.h"
#include "ImageGeometry.h"

class vtkImplicitFunction;

namespace deformvolume
{

/// The tool that a function in world coordinates is: it carves out where the function is negative.
/// The tool holds the function. Functions that VTK is not known to evaluate in several threads at a
/// time are evaluated in one. Spheres and boxes without a transform have bounds.
CarvingTool MakeWorldTool(vtkImplicitFunction* function);

/// A tool in world coordinates as one in continuous indices of a volume.
CarvingTool GetInIndices(const CarvingTool& tool, const ImageGeometry& volume);

} // namespace deformvolume

#endif
