// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of the mesh rasterisation work on. Shared by the C++ code and the kernels:
// four-byte numbers only, so that both sides lay it out alike.
#ifndef DeformVolumeRasterParameters_h
#define DeformVolumeRasterParameters_h

// A tile of output voxels: 32 x 8 x 8. Tiles are aligned to multiples of their size in structured
// indices, so that no result depends on where an output begins. The bits of an uint stand for the
// voxels of a row.
#define DEFORMVOLUME_TILE_BITS_X 5
#define DEFORMVOLUME_TILE_BITS_Y 3
#define DEFORMVOLUME_TILE_BITS_Z 3
#define DEFORMVOLUME_TILE_ROWS 64
#define DEFORMVOLUME_TILE_VOXELS 2048

// Tetrahedra that the items of a work-group set up for each other at a time: as many as go into
// local memory of 32 KB with what a tile needs, and leave a little of it.
#define DEFORMVOLUME_TILE_SHARED 15

// Tetrahedra over more output voxels than this on an axis do not fit the 64 bits of the edge
// functions: with e in 1/256 voxel, they are at most 2 e^3, and their partial sums 3 e^3.
#define DEFORMVOLUME_LARGEST_TETRAHEDRON 5000

// Counters of all tetrahedra.
#define DEFORMVOLUME_BINNED_INVERTED 0
#define DEFORMVOLUME_BINNED_OVERSTRETCHED 1
#define DEFORMVOLUME_BINNED_COUNTERS 2

// Entries are sorted by so many bits of their keys at a time, at most (EntryLists.cl).
#define DEFORMVOLUME_DIGIT_BITS 8

// Counters of a tile.
#define DEFORMVOLUME_TILE_COVERED 0  // voxels
#define DEFORMVOLUME_TILE_OVERLAPS 1 // whether tetrahedra overlap
#define DEFORMVOLUME_TILE_COUNTERS 2

// Points of a field by which a voxel may lie outside it.
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
  int TileFirst[3];   // index of the first tile: of its first voxel, divided by the tile's size
  int TileCount[3];
  int TileBegin;       // first tile of a launch
  int Tetrahedra;      // of the deformation mesh
  int FractionBits[3]; // of rest coordinates, see MeshRasterization.cl
  int Tolerance[3];    // by which a rest coordinate may leave the volume, in its own unit
  int HasActive;       // whether a mask of active tetrahedra is there
  int HasBlanked;      // whether a mask of blanked voxels is there
  int HasDistances;    // whether there are boundary distances
  // What takes an output index to one of the volume: Inverse * index - Offset. Row-major 3 x 3,
  // each element the sum of two floats. HasTurnedAxes: whether it is not diagonal.
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
  int Whole[3];      // where it lies at rest, in 1/256 output voxel: a whole number
  float Fraction[3]; // and what misses to it
  float Weights[4];  // of the nodes; of a field: its continuous index there in the first three
  int Tetrahedron;   // its number in the mesh
  int Node;          // the one of the four that the corner is, or -1
} BoundaryCorner;

// What entries are sorted by (EntryLists.cl): some bits of their keys.
typedef struct
{
  unsigned int Entries;
  unsigned int Shift; // the lowest bit
  unsigned int Bits;
} DigitParameters;

// An inverse displacement field. OutputToField: row-major 3 x 4, from the index of an output voxel
// to a continuous index of the field; a sum of two floats.
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
