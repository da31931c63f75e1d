// SPDX-License-Identifier: BSD-3-Clause
// What the launches of the kernels work on. Shared by the C++ code and the kernels: four-byte
// numbers only, so that both sides lay it out alike.
//
// "Local" indices count from 0 at the voxel grid's first voxel. Vertex data of the volume lie in
// chunks of whole planes of constant z.
#ifndef DeformVolumeKernelParameters_h
#define DeformVolumeKernelParameters_h

#ifndef __OPENCL_VERSION__
namespace deformvolume
{
#endif

typedef struct
{
  int Size[3];     // voxels on each axis
  int First[3];    // structured index of the first voxel; its parity decides the 5T split
  int IsMirrored;  // 1 where upright tetrahedra are mirror images of those of the volume, else 0
  int ChunkFirst;  // local z of the first vertex plane, and of the first cell layer, in the chunk
  int PlanesBegin; // local z of the first vertex plane to work on
  int PlanesEnd;   // and one past the last
  int LayersBegin; // local z of the first layer of cells to work on
  int LayersEnd;   // and one past the last
  int OutputFirst[3]; // structured index of the first output voxel in the output buffers
  int OutputSize[3];  // output voxels in the buffers on each axis
  int WholeFirst[3];  // the output that these are a part of: its first voxel, and one past the last
  int WholeEnd[3];    // one, counted from the first voxel in the buffers
  int IsPart;         // whether there are voxels beyond those in the buffers
  int Pass;           // one of the passes below
  int KeepsPatches;   // whether some patches of the output stay as they are
  int HasActive;      // whether a mask of active tetrahedra is there; without one all are active
  int HasDistances;   // whether there are boundary distances; without them nothing is clipped
  int HasState;       // whether the vertices have a state; without one all that could be is there
  int BrickOrigin[3]; // local index of the first cell of the first brick; may lie before the volume
  int BrickCount[3];  // bricks on each axis
  int ListBegin; // place in the list, of bricks or of pieces of cells, of the first one to work on
  int ListEnd;   // and one past the last
  int Portion;   // bricks of the list that a work-item takes at once
  int MostLargeCells; // room in the list of large cells
} KernelParameters;

// A vertex of a cell with crossed tetrahedra: those that a smooth cut divides where their vertices
// lie on both sides.
typedef struct
{
  int X, Y, Z; // local index
  unsigned int
    Tetrahedra;   // the crossed ones of the cell that begins at it, as bits; and the bit below
  float Distance; // signed, from the sheet; only its sign and its ratio to others matter
} CutVertex;
#define DEFORMVOLUME_CUT_CORNER 32 // the vertex belongs to a crossed tetrahedron

// Copies of a vertex that are no further than this from it on each axis, in 1/256 output voxel, lie
// where it does: extrapolation is right to second order only, and a cut that is not open must not
// show.
#define DEFORMVOLUME_CLOSED_GAP 64

// The undeformed position of the voxels with one index on an axis, in 1/256 output voxel: a whole
// number and what misses to it.
typedef struct
{
  int Whole;
  float Fraction;
} RestPosition;

// The same where axes of the volume are not those of the output: what an index on an axis adds to
// the position. Fractions are multiples of 1/256 below 1, so that all sums are exact, in any order,
// and a voxel has the same position whatever it is a part of. An index on z or y adds the fraction
// that it has in the whole volume, and counts whole numbers from the first one there is; those on x
// have the rest.
typedef struct
{
  int Whole[3];
  float Fraction[3];
} RestVector;

// A displacement field. IndexToField: row-major 3 x 4, from an index counted from the first voxel
// of the whole volume to a continuous index of the field.
typedef struct
{
  float IndexToField[12];
  int First[3]; // of the voxel grid, counted so
  int Dimensions[3];
  int Extrapolate; // whether voxels outside the field follow its border
  float Fading[3]; // DisplacementField::Fading
  int SameGrid;    // whether voxels are points of the field, and all lie in it: the point of voxel
  int Offset[3];   // (i, j, k) is (i, j, k) + Offset
  int IsMapped;    // of vectors that are read where they lie: whether the matrix is to be applied
  unsigned int ToDisplacement[18]; // row-major 3 x 3, of each double the lower four bytes first
} FieldParameters;

// The displacement in a tetrahedron of the deformation mesh, in output voxels; 64 bytes. That of
// the voxel with the local index (x, y, z) is, in this order,
//   Displacement +
//     ((AlongY * (y - Origin[1]) + AlongZ * (z - Origin[2])) + AlongX * (x - Origin[0])).
typedef struct
{
  float Displacement[3]; // at Origin
  float AlongX[3];       // its derivatives
  float AlongY[3];
  float AlongZ[3];
  float Origin[3]; // local index of a voxel in the tetrahedron
  float Padding;
} TetrahedronRecord;

// Tetrahedra on the device name a node by its place in units of 8 bytes, of which it takes this
// many: processors add eight times a number to an address at no cost, but not sixteen times.
#define DEFORMVOLUME_NODE_PLACES 2

// Passes of the exact resampling kernel. What comes after the first is for voxels that several
// cells write, and for those on a crease, which none does. All others keep what the first pass gave
// them: a voxel never depends on others, and so not on how the output is divided.
#define DEFORMVOLUME_PASS_DIRECT 0 // write, and count the writes
#define DEFORMVOLUME_PASS_OWNERS 1 // the same, and find voxels that several cells write: who wins
#define DEFORMVOLUME_PASS_MARK 2   // find who wins of those that only hold a voxel not settled
#define DEFORMVOLUME_PASS_WINNER 3 // write where this tetrahedron is the winner
#define DEFORMVOLUME_PASS_COUNT 4  // count the tetrahedra that write each voxel; write none
// Whether every tetrahedron that holds a voxel takes part, and not only the one that writes it.
#define DEFORMVOLUME_IS_CLOSED(pass)                                                               \
  ((pass) == DEFORMVOLUME_PASS_MARK || (pass) == DEFORMVOLUME_PASS_WINNER)
// Whether values are written.
#define DEFORMVOLUME_IS_WRITING(pass) ((pass) != DEFORMVOLUME_PASS_MARK)

// Cells of a brick, which begins at even structured indices: the parity of a place in a brick is
// that of the structured index. It is long on x, in whose direction memory is contiguous.
#define DEFORMVOLUME_BRICK_X 192
#define DEFORMVOLUME_BRICK_Y 16
#define DEFORMVOLUME_BRICK_Z 16
// Bricks begin at structured indices that are multiples of these numbers.
#define DEFORMVOLUME_BRICK_STEPS                                                                   \
  {                                                                                                \
    2, DEFORMVOLUME_BRICK_Y, DEFORMVOLUME_BRICK_Z                                                  \
  }
// What can be run of a brick by itself: spans of so many cells on x, and halves on y and z.
#define DEFORMVOLUME_SPAN 32
#define DEFORMVOLUME_SPANS (DEFORMVOLUME_BRICK_X / DEFORMVOLUME_SPAN)
#define DEFORMVOLUME_SECTIONS (4 * DEFORMVOLUME_SPANS)

// What a work-item of the kernel ResampleBricks takes, and some work-groups of the kernels Resample
// and ResampleColumns:
// the number of a brick, and above that a bit for each span, and for y and z a bit for the lower
// half and one for the upper half. ResampleBricks takes all spans from the lowest to the highest.
#define DEFORMVOLUME_BRICK_BITS 22
#define DEFORMVOLUME_WHOLE_BRICK ((1 << (DEFORMVOLUME_SPANS + 4)) - 1)

// Cells of a cuboid, whose vertices a work-group of the kernel Resample maps into local memory.
#define DEFORMVOLUME_CUBOID_X 64
#define DEFORMVOLUME_CUBOID_Y 4
#define DEFORMVOLUME_CUBOID_Z 4
// Vertices of a cuboid.
#define DEFORMVOLUME_CUBOID_VERTICES                                                               \
  ((DEFORMVOLUME_CUBOID_X + 1) * (DEFORMVOLUME_CUBOID_Y + 1) * (DEFORMVOLUME_CUBOID_Z + 1))

// Counters of a section of a brick: number (brick * 4 + 2 (upper z) + (upper y)) * SPANS +
// span.
#define DEFORMVOLUME_COUNT_WRITES 0
#define DEFORMVOLUME_COUNT_INVERTED 1
#define DEFORMVOLUME_COUNT_OVERSTRETCHED 2
#define DEFORMVOLUME_COUNT_MISSING 3    // cells on the border with flat tetrahedra or left-out ones
#define DEFORMVOLUME_COUNT_ASSUMED 4    // nonzero where it was assumed that there are none such
#define DEFORMVOLUME_COUNT_CANDIDATES 5 // voxels that cells may have won
#define DEFORMVOLUME_COUNT_TOUCHED 6 // nonzero where cells hold samples that others write, or none
#define DEFORMVOLUME_COUNT_LARGE 7   // cells that were put into the list of large ones
#define DEFORMVOLUME_COUNTERS 8

// Partial sums of these, and of the voxels that bits say are covered (the kernel SumParts): how
// many, and how many parts there are.
#define DEFORMVOLUME_SUMMED_COVERED DEFORMVOLUME_COUNTERS
#define DEFORMVOLUME_SUMMED (DEFORMVOLUME_COUNTERS + 1)
#define DEFORMVOLUME_PARTS 128

// What the counters of all sections add up to (the kernel Summarize): two words each, the lower one
// first, of writes, voxels covered and inverted tetrahedra; then overstretched ones, and the flags.
#define DEFORMVOLUME_SUMMARY_WORDS 8
#define DEFORMVOLUME_SUMMARY_MISSING_WHERE_ASSUMED 1 // missing and assumed ones, somewhere
#define DEFORMVOLUME_SUMMARY_LARGE 2                 // large cells

// Samples that a work-item tries of one cell. A cell whose box has more is large: it goes into a
// list, and what that lists is resampled in pieces, by kernels that follow (LargeCells.cl).
#define DEFORMVOLUME_PIECE 65536
// Room in that list, for four integers a cell: local x, y and z, and in how many pieces. Cells that
// find no room there are resampled where they are found.
#define DEFORMVOLUME_MOST_LARGE_CELLS 65536
// Pieces in a launch.
#define DEFORMVOLUME_PIECES 1024

// Voxels of a patch of the output on each axis: what is cleared where a part is made anew and what
// it covers may change, and what is looked at where voxels are not settled.
#define DEFORMVOLUME_PATCH 8
// Patches that so many voxels on an axis lie in.
#define DEFORMVOLUME_PATCHES(voxels) (((voxels) + DEFORMVOLUME_PATCH - 1) / DEFORMVOLUME_PATCH)
// What is known of a patch.
#define DEFORMVOLUME_PATCH_UNSETTLED 1 // voxels have to be won
#define DEFORMVOLUME_PATCH_TOUCHED 2   // cells may hold voxels that others write, or none
#define DEFORMVOLUME_PATCH_KEPT 4      // its voxels stay as they are

// Voxels of which a work-item makes bytes of the bits of coverage at a time: half a word of these.
#define DEFORMVOLUME_EXPANDED 16

// Bytes that a work-item of the kernels Fill1 to Fill8 writes.
#define DEFORMVOLUME_FILLED_BYTES 65536

// State of a vertex of the sampling mesh.
#define DEFORMVOLUME_VERTEX_SOURCE 1 // it has a deformed position and may be interpolated
// All tetrahedra that it could belong to are there, but for those in cells that the boundary of the
// deformation mesh crosses.
#define DEFORMVOLUME_VERTEX_INTERIOR 2
#define DEFORMVOLUME_CELL_WHOLE 4     // of the cell that begins at it, all tetrahedra are there
#define DEFORMVOLUME_VERTEX_REGULAR 8 // interior, but that it may lie on the border of the volume
#define DEFORMVOLUME_VERTEX_UNCLIPPED 16 // a source, not on the far side of the boundary
#define DEFORMVOLUME_CELL_UNCROSSED 32   // a smooth cut crosses no tetrahedron of that cell
#define DEFORMVOLUME_VERTEX_TOGETHER 64  // both sides of the cut see it where it is

// Beside the active tetrahedra of a cell: the boundary of the deformation mesh crosses it or one of
// its neighbours; and it crosses the cell itself.
#define DEFORMVOLUME_CELL_AT_BOUNDARY 32
#define DEFORMVOLUME_CELL_CROSSED 64

#ifdef __OPENCL_VERSION__

// On which axes the split of a cell is mirrored; x, y, z are local indices.
static int Mirror(int x, int y, int z, const KernelParameters* p)
{
  return DEFORMVOLUME_MIRROR(p->First[0] + x, p->First[1] + y, p->First[2] + z);
}

// Whether tetrahedra of a cell, but for the central one, are mirror images of those of the cell at
// index 0.
static int IsTurned(int x, int y, int z, const KernelParameters* p)
{
  return (p->First[0] + x + p->First[1] + y + p->First[2] + z + p->IsMirrored) & 1;
}

// Places of a vertex, and of a cell, in what a chunk has of each.
static size_t VertexInChunk(int x, int y, int z, const KernelParameters* p)
{
  return ((size_t)(z - p->ChunkFirst) * p->Size[1] + y) * p->Size[0] + x;
}

static size_t CellInChunk(int x, int y, int z, const KernelParameters* p)
{
  return ((size_t)(z - p->ChunkFirst) * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x;
}

#if HAS_CUT // whether a program knows smooth cuts (CutVertex)
// The place of a vertex in the list of cut vertices, which is in the order of rows along x, then y,
// then z; -1 where it is not there. rows: where each row begins in the list, and where the last one
// ends.
static int FindCutVertex(__global const uint* rows, __global const CutVertex* vertices, int x,
  int y, int z, const KernelParameters* p)
{
  const size_t row = (size_t)z * p->Size[1] + y;
  const uint end = rows[row + 1];
  uint low = rows[row];
  uint high = end;
  while (low < high)
  {
    const uint middle = low + (high - low) / 2;
    if (vertices[middle].X < x)
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  return low < end && vertices[low].X == x ? (int)low : -1;
}
#endif

// Patches of the output along x that hold the voxels with an y and a z: number of the first one.
static size_t PatchRow(size_t y, size_t z, const KernelParameters* p)
{
  const size_t width = DEFORMVOLUME_PATCHES(p->OutputSize[0]);
  const size_t height = DEFORMVOLUME_PATCHES(p->OutputSize[1]);
  return (z / DEFORMVOLUME_PATCH * height + y / DEFORMVOLUME_PATCH) * width;
}

// The first plane of voxels behind all patches.
static size_t PatchedPlanes(const KernelParameters* p)
{
  return (size_t)DEFORMVOLUME_PATCHES(p->OutputSize[2]) * DEFORMVOLUME_PATCH;
}

// Local index of the first cell of a brick (DEFORMVOLUME_BRICK_BITS), which may lie before the
// volume.
static int3 FirstOfBrick(uint item, const KernelParameters* p)
{
  const int brick = item & ((1u << DEFORMVOLUME_BRICK_BITS) - 1);
  return (int3)(brick % p->BrickCount[0] * DEFORMVOLUME_BRICK_X + p->BrickOrigin[0],
    brick / p->BrickCount[0] % p->BrickCount[1] * DEFORMVOLUME_BRICK_Y + p->BrickOrigin[1],
    brick / p->BrickCount[0] / p->BrickCount[1] * DEFORMVOLUME_BRICK_Z + p->BrickOrigin[2]);
}

// Whether a section of a brick is to be run. section: as counters number them.
static int IsSectionRun(uint item, size_t section)
{
  const uint inBrick = section % DEFORMVOLUME_SECTIONS;
  const uint halves = inBrick / DEFORMVOLUME_SPANS;
  const uint spans = item >> DEFORMVOLUME_BRICK_BITS;
  const uint halvesY = spans >> DEFORMVOLUME_SPANS;
  const uint halvesZ = halvesY >> 2;
  return spans >> inBrick % DEFORMVOLUME_SPANS & halvesY >> (halves & 1) &
    halvesZ >> (halves >> 1) & 1;
}

// The section of a brick that a cell lies in, as counters number them.
static size_t SectionOf(int x, int y, int z, const KernelParameters* p)
{
  const int inBricks[3] = { x - p->BrickOrigin[0], y - p->BrickOrigin[1], z - p->BrickOrigin[2] };
  const size_t brick = ((size_t)(inBricks[2] / DEFORMVOLUME_BRICK_Z) * p->BrickCount[1] +
                         inBricks[1] / DEFORMVOLUME_BRICK_Y) *
      p->BrickCount[0] +
    inBricks[0] / DEFORMVOLUME_BRICK_X;
  const int halves = inBricks[1] % DEFORMVOLUME_BRICK_Y / (DEFORMVOLUME_BRICK_Y / 2) +
    inBricks[2] % DEFORMVOLUME_BRICK_Z / (DEFORMVOLUME_BRICK_Z / 2) * 2;
  return DEFORMVOLUME_SECTIONS * brick + halves * DEFORMVOLUME_SPANS +
    inBricks[0] / DEFORMVOLUME_SPAN % DEFORMVOLUME_SPANS;
}

#else
} // namespace deformvolume
#endif

#endif
