// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the mesh rasterization kernels, shared by C++ and OpenCL. All members have four
// bytes, so that both sides have the same layout.
#ifndef DeformVolumeRasterParameters_h
#define DeformVolumeRasterParameters_h

// A tile of output voxels has 32 x 8 x 8 voxels. Tiles are aligned to multiples of their size in
// structured indices, so that results do not depend on where an output begins. The bits of a uint
// stand for the voxels of a row.
#define DEFORMVOLUME_TILE_BITS_X 5
#define DEFORMVOLUME_TILE_BITS_Y 3
#define DEFORMVOLUME_TILE_BITS_Z 3
#define DEFORMVOLUME_TILE_ROWS 64
#define DEFORMVOLUME_TILE_VOXELS 2048

// The number of tetrahedra that the work-items of a work-group set up for each other at a time: as
// many as fit into 32 KB of local memory with the other data of a tile and a small reserve.
#define DEFORMVOLUME_TILE_SHARED 15

// The largest extent of a tetrahedron on an axis, in output voxels, for which edge functions fit
// into 64 bits: for e in 1/256 voxel, they are at most 2 e^3, and their partial sums 3 e^3.
#define DEFORMVOLUME_LARGEST_TETRAHEDRON 5000

// Counters over all tetrahedra.
#define DEFORMVOLUME_BINNED_INVERTED 0
#define DEFORMVOLUME_BINNED_OVERSTRETCHED 1
#define DEFORMVOLUME_BINNED_COUNTERS 2

// The largest number of key bits that one sorting pass handles (EntryLists.cl).
#define DEFORMVOLUME_DIGIT_BITS 8

// Counters of a tile.
#define DEFORMVOLUME_TILE_COVERED 0  // the number of covered voxels
#define DEFORMVOLUME_TILE_OVERLAPS 1 // whether tetrahedra overlap
#define DEFORMVOLUME_TILE_COUNTERS 2

// Voxels count as inside a field up to this distance, in points of the field.
#define DEFORMVOLUME_LOOKUP_TOLERANCE (1.0 / 1024)

#ifndef __OPENCL_VERSION__
namespace deformvolume
{
#endif

typedef struct
{
  int Size[3];        // voxels of the volume on each axis
  int First[3];       // structured index of its first voxel
  int OutputFirst[3]; // structured index of the first output voxel in the buffers
  int OutputSize[3];  // output voxels in the buffers on each axis
  int TileFirst[3]; // structured index of the first tile's first voxel, divided by the tile's size
  int TileCount[3];
  int TileBegin;       // first tile of a launch
  int Tetrahedra;      // number of tetrahedra of the deformation mesh
  int FractionBits[3]; // of rest coordinates, see MeshRasterization.cl
  int Tolerance[3];    // largest distance of a rest coordinate outside the volume, in its unit
  int HasActive;       // whether there is a mask of active tetrahedra
  int HasBlanked;      // whether there is a mask of blanked voxels
  int HasDistances;    // whether there are boundary distances
  // The map from an output index to an index of the volume: Inverse * index - Offset. Row-major 3 x
  // 3, each element the sum of two floats. HasTurnedAxes: whether the matrix is not diagonal.
  float Inverse[9];
  float InverseRest[9];
  float Offset[3];
  float OffsetRest[3];
  int HasTurnedAxes;
} RasterParameters;

#define INVERSE_ELEMENT(p, row, column)                                                            \
  ((REAL)(p)->Inverse[3 * (row) + (column)] + (REAL)(p)->InverseRest[3 * (row) + (column)])
#define OFFSET_ELEMENT(p, row) ((REAL)(p)->Offset[row] + (REAL)(p)->OffsetRest[row])

// A corner of a piece at the boundary of the deformation mesh (MeshBoundary).
typedef struct
{
  int Whole[3];      // position at rest in 1/256 output voxel, rounded
  float Fraction[3]; // the remainder of that position
  float Weights[4];  // weights of the nodes; for a field, its continuous index in the first three
  int Tetrahedron;   // number of the tetrahedron in the mesh
  int Node;          // which of the four nodes the corner is, or -1
} BoundaryCorner;

// The bits of the keys by which one pass sorts the entries (EntryLists.cl).
typedef struct
{
  unsigned int Entries;
  unsigned int Shift; // the lowest bit
  unsigned int Bits;
} DigitParameters;

// An inverse displacement field. OutputToField: row-major 3 x 4, from the index of an output voxel
// to a continuous index of the field; each element the sum of two floats.
typedef struct
{
  float OutputToField[12];
  float OutputToFieldRest[12];
  int Dimensions[3];
  int Extrapolate; // whether voxels outside the field follow its border
  float Fading[3]; // DisplacementField::Fading
} LookupParameters;

#ifndef __OPENCL_VERSION__
} // namespace deformvolume
#endif

#endif
