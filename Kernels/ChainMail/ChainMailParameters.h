// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the ChainMail kernels, shared by C++ and OpenCL. All members have four bytes, so
// that both sides have the same layout.
#ifndef DeformVolumeChainMailParameters_h
#define DeformVolumeChainMailParameters_h

// A block has 8 x 8 x 8 voxels, which are consecutive in memory, in rows along x.
#define DEFORMVOLUME_BLOCK 8
#define DEFORMVOLUME_BLOCK_ROWS 64
#define DEFORMVOLUME_BLOCK_VOXELS 512

// Displacements are integers in this fraction of the voxel spacing on their axis.
#define DEFORMVOLUME_CHAINMAIL_UNITS 65536
// No displacement exceeds 1 << 28. So a limit of DEFORMVOLUME_NO_LIMIT or more never has an effect,
// and the sum of two such limits does not overflow.
#define DEFORMVOLUME_NO_LIMIT (1 << 29)

// Flags of a voxel during a step. Bit "system": the system or a handle has moved the voxel, which
// therefore bounds other voxels in this system. The number of a system is the axis of the
// displacement, plus 3 if voxels are pushed up rather than pulled down.
#define DEFORMVOLUME_SYSTEMS 6
#define DEFORMVOLUME_ALL_SYSTEMS 63
#define DEFORMVOLUME_HELD 64   // held by a handle: other voxels do not move it
#define DEFORMVOLUME_FIXED 128 // held by a handle that does not yield to other handles

// Properties of a voxel. Bit "axis": there is a link to the next voxel on this axis.
#define DEFORMVOLUME_LINKS 7
#define DEFORMVOLUME_ELEMENT 8
#define DEFORMVOLUME_PINNED 16

// The result of a visit of a block: bits of the faces with changed voxels (-x, +x, -y, +y, -z, +z),
// then bits of the systems that changed voxels, then the following flags.
#define DEFORMVOLUME_CHANGED_SYSTEMS 6
#define DEFORMVOLUME_SAVED (1 << 12) // the state of the block before the step is saved

// Indices in the array `shared`, which all blocks use. Its first six numbers are, for each system,
// the largest distance by which voxels that do not yield would have to move.
#define DEFORMVOLUME_CONFLICTS 6 // whether two systems move a voxel in opposite directions
#define DEFORMVOLUME_VIOLATION 7 // the largest violation of a limit
#define DEFORMVOLUME_NEEDED 8    // bits of the systems in which handles move their voxels
#define DEFORMVOLUME_SHARED 9

typedef struct
{
  int Size[3];   // number of voxels on each axis
  int Blocks[3]; // number of blocks on each axis
  float ToWorld[9];
} ChainMailGrid;

#endif
