// SPDX-License-Identifier: BSD-3-Clause
// What the ChainMail kernels work on. Shared by the C++ code and the kernels: four-byte numbers
// only, so that both sides lay it out alike.
#ifndef DeformVolumeChainMailParameters_h
#define DeformVolumeChainMailParameters_h

// A block has 8 x 8 x 8 voxels, which lie together in memory, in rows along x.
#define DEFORMVOLUME_BLOCK 8
#define DEFORMVOLUME_BLOCK_ROWS 64
#define DEFORMVOLUME_BLOCK_VOXELS 512

// Displacements are whole numbers of this fraction of the voxel spacing on their axis.
#define DEFORMVOLUME_CHAINMAIL_UNITS 65536
// No displacement is larger than 1 << 28. A limit of DEFORMVOLUME_NO_LIMIT or more then never
// matters, and the sum of two of these does not overflow.
#define DEFORMVOLUME_NO_LIMIT (1 << 29)

// Flags of a voxel in a step. Bit "system": the voxel was moved by that system, which is the axis
// of the displacement, plus 3 where it was pushed up rather than pulled down.
#define DEFORMVOLUME_SYSTEMS 6
#define DEFORMVOLUME_ALL_SYSTEMS 63
#define DEFORMVOLUME_HELD 64   // by a handle: no other voxel moves it
#define DEFORMVOLUME_FIXED 128 // by a handle that others must not pull: they yield instead

// What a voxel is. Bit "axis": the link to the next voxel on this axis is there.
#define DEFORMVOLUME_LINKS 7
#define DEFORMVOLUME_ELEMENT 8
#define DEFORMVOLUME_PINNED 16

// What a visit of a block has changed: bits of the faces with changed voxels (-x, +x, -y, +y, -z,
// +z), then bits of the systems that changed something, then these.
#define DEFORMVOLUME_CHANGED_SYSTEMS 6
#define DEFORMVOLUME_UNFINISHED (1 << 12) // to be visited again
#define DEFORMVOLUME_SAVED (1 << 13)      // what the block was before the step is saved

// Sweeps over a block in a visit.
#define DEFORMVOLUME_MOST_SWEEPS 24

// Numbers that all blocks share: how far each system would have to move voxels that do not yield;
// ...
#define DEFORMVOLUME_CONFLICTS 6 // ... whether two handles pull a voxel beyond each other,
#define DEFORMVOLUME_VIOLATION 7 // the largest violation of a limit,
#define DEFORMVOLUME_NEEDED 8    // and the systems in which handles move their voxels
#define DEFORMVOLUME_SHARED 9

typedef struct
{
  int Size[3];   // voxels
  int Blocks[3]; // blocks that these lie in
  float ToWorld[9];
} ChainMailGrid;

#endif
