/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef Cube_h
#define Cube_h

#include "deformvolume.h"

#include <string.h>

static const double Spacing = 2.0;

/* A volume of the same number of voxels on each axis. */
static dv_grid MakeCube(int size)
{
  dv_grid grid;
  int axis = 0;
  memset(&grid, 0, sizeof(grid));
  grid.struct_size = sizeof(grid);
  for (axis = 0; axis < 3; ++axis)
  {
    grid.extent[2 * axis + 1] = size - 1;
    grid.spacing[axis] = Spacing;
    grid.direction[4 * axis] = 1.0;
  }
  return grid;
}

#endif
