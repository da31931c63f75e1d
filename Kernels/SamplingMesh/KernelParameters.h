// SPDX-License-Identifier: BSD-3-Clause
// Parameters of kernel launches, shared by the C++ code and the kernels. All members have four
// bytes, so that the layout is the same in both languages.
//
// "Local" indices count from 0 at the first voxel of the voxel grid. The vertex data of the volume
// are divided into chunks of whole planes of constant z.
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
  int IsMirrored;  // 1 if the map from the volume to the output is a reflection, else 0
  int ChunkFirst;  // local z of the first vertex plane, and of the first cell layer, in the chunk
  int PlanesBegin; // local z of the first vertex plane to process
  int PlanesEnd;   // one past the last vertex plane to process
  int LayersBegin; // local z of the first layer of cells to process
  int LayersEnd;   // one past the last layer of cells to process
  int OutputFirst[3]; // structured index of the first output voxel in the output buffers
  int OutputSize[3];  // output voxels in the buffers on each axis
  int WholeFirst[3];  // the whole output: its first voxel, counted from the first voxel in the
  int WholeEnd[3];    // buffers, and one past its last voxel
  int IsPart;         // whether the output has voxels that are not in the buffers
  int Pass;           // one of the passes below
  int KeepsPatches;   // whether some patches of the output keep their values
  int HasActive;      // whether there is a mask of active tetrahedra; otherwise all are active
  int HasDistances;   // whether there are boundary distances; otherwise nothing is clipped
  int HasState;       // whether the vertices have a state; otherwise all vertices are sources
  int BrickOrigin[3]; // local index of the first cell of the first brick; may be negative
  int BrickCount[3];  // bricks on each axis
  int ListBegin; // index of the first entry to process, in the list of bricks or of cell pieces
  int ListEnd;   // one past the last entry to process
  int Portion;   // bricks of the list per work-item
  int MostLargeCells; // capacity of the list of large cells
} KernelParameters;

// A vertex of a cell with crossed tetrahedra. A smooth cut divides a crossed tetrahedron that has
// vertices on both sides.
typedef struct
{
  int X, Y, Z;             // local index
  unsigned int Tetrahedra; // bits: crossed tetrahedra of the cell that begins at the vertex, and
                           // DEFORMVOLUME_CUT_CORNER
  float Distance;          // signed distance from the sheet, in any unit
} CutVertex;
#define DEFORMVOLUME_CUT_CORNER 32 // the vertex belongs to a crossed tetrahedron

// A distance, in 1/256 output voxel. A copy of a vertex that is no farther from the vertex on each
// axis is moved onto the vertex: extrapolation has an error of second order, and a closed cut must
// not be visible.
#define DEFORMVOLUME_CLOSED_GAP 64

// The undeformed position of the voxels with one index on an axis, in 1/256 output voxel: a whole
// number plus a fraction.
typedef struct
{
  int Whole;
  float Fraction;
} RestPosition;

// The undeformed position if the axes of the volume are not those of the output. It is a sum of one
// RestVector for each axis. Fractions are multiples of 1/256 below 1. So all sums are exact in any
// order, and a voxel has the same position in the whole volume and in each part. The vector of an
// index on y or z has the fraction of this index in the whole volume, and whole numbers relative to
// the first index of the part. The vectors on x contain the remainder.
typedef struct
{
  int Whole[3];
  float Fraction[3];
} RestVector;

// A displacement field. Indices of voxels count from the first voxel of the whole volume.
typedef struct
{
  float IndexToField[12]; // row-major 3 x 4, from a voxel to a continuous index of the field
  int First[3];           // first voxel of the voxel grid
  int Dimensions[3];
  int Extrapolate; // whether voxels outside the field follow its border
  float Fading[3]; // DisplacementField::Fading
  int SameGrid;    // whether each voxel is a point of the field
  int Offset[3];   // if SameGrid: voxel (i, j, k) is point (i, j, k) + Offset
  int IsMapped;    // for vectors that are read in place: whether to apply ToDisplacement
  unsigned int ToDisplacement[18]; // row-major 3 x 3 doubles, lower four bytes first
} FieldParameters;

// The displacement in a tetrahedron of the deformation mesh, in output voxels; 64 bytes. The
// displacement of the voxel with the local index (x, y, z) is, in this order of operations,
//   Displacement +
//     ((AlongY * (y - Origin[1]) + AlongZ * (z - Origin[2])) + AlongX * (x - Origin[0])).
typedef struct
{
  float Displacement[3]; // at Origin
  float AlongX[3];       // derivatives of the displacement
  float AlongY[3];
  float AlongZ[3];
  float Origin[3]; // local index of a voxel in the tetrahedron
  float Padding;
} TetrahedronRecord;

// Numbers that describe a tetrahedron of the deformation mesh at rest: the origin, and the weights
// of three nodes at the origin and their gradients (RunEvaluation.cl).
#define DEFORMVOLUME_REST_NUMBERS 15

// Units of 8 bytes per node. Tetrahedra on the device refer to a node by its offset in such units:
// CPUs multiply an index by 8 in an address at no cost, but not by 16.
#define DEFORMVOLUME_NODE_STRIDE 2

// Passes of the exact resampling kernel. The passes after the first are for voxels that several
// cells write, and for voxels on a crease, which no cell writes. All other voxels keep the value of
// the first pass. So no voxel depends on other voxels, nor on how the output is divided.
#define DEFORMVOLUME_PASS_DIRECT 0 // write, and count the writes
#define DEFORMVOLUME_PASS_OWNERS 1 // as DIRECT; and find winners of voxels that several cells write
// Find the winners of unsettled voxels, among all tetrahedra that contain the voxel.
#define DEFORMVOLUME_PASS_MARK 2
#define DEFORMVOLUME_PASS_WINNER 3 // write the voxels of which this tetrahedron is the winner
#define DEFORMVOLUME_PASS_COUNT 4  // count the tetrahedra that write each voxel; write nothing
// Whether the pass uses closed tetrahedra: all that contain a voxel, including their boundaries,
// and not only the one that owns it by the fill rule.
#define DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(pass)                                                  \
  ((pass) == DEFORMVOLUME_PASS_MARK || (pass) == DEFORMVOLUME_PASS_WINNER)
// Whether the pass writes values.
#define DEFORMVOLUME_IS_WRITING(pass) ((pass) != DEFORMVOLUME_PASS_MARK)

// Cells of a brick. Bricks begin at even structured indices, so an index within a brick has the
// parity of the structured index. Bricks are long on x, since rows are contiguous in memory.
#define DEFORMVOLUME_BRICK_X 192
#define DEFORMVOLUME_BRICK_Y 16
#define DEFORMVOLUME_BRICK_Z 16
// Bricks begin at structured indices that are multiples of these numbers.
#define DEFORMVOLUME_BRICK_STEPS                                                                   \
  {                                                                                                \
    2, DEFORMVOLUME_BRICK_Y, DEFORMVOLUME_BRICK_Z                                                  \
  }
// Sections of a brick, which can be resampled separately: spans of DEFORMVOLUME_SPAN cells on x,
// and halves on y and z.
#define DEFORMVOLUME_SPAN 32
#define DEFORMVOLUME_SPANS (DEFORMVOLUME_BRICK_X / DEFORMVOLUME_SPAN)
#define DEFORMVOLUME_SECTIONS (4 * DEFORMVOLUME_SPANS)

// An entry in the list of bricks: the number of a brick, and above it the bits of its sections.
// There is one bit for each span, then one for the lower and one for the upper half on y, then the
// same on z. A work-item of the kernel ResampleBricks processes one entry, with all spans from the
// first to the last selected one. Several work-groups of the kernels Resample and ResampleColumns
// process one entry.
#define DEFORMVOLUME_BRICK_BITS 22
#define DEFORMVOLUME_WHOLE_BRICK ((1 << (DEFORMVOLUME_SPANS + 4)) - 1)

// Cells of a cuboid, whose vertices a work-group of the kernel Resample maps into local memory.
#define DEFORMVOLUME_CUBOID_X 64
#define DEFORMVOLUME_CUBOID_Y 4
#define DEFORMVOLUME_CUBOID_Z 4
// Vertices of a cuboid.
#define DEFORMVOLUME_CUBOID_VERTICES                                                               \
  ((DEFORMVOLUME_CUBOID_X + 1) * (DEFORMVOLUME_CUBOID_Y + 1) * (DEFORMVOLUME_CUBOID_Z + 1))

// Counters of a section. Its number is (brick * 4 + 2 * (upper z) + (upper y)) * SPANS + span.
#define DEFORMVOLUME_COUNT_WRITES 0
#define DEFORMVOLUME_COUNT_INVERTED 1
#define DEFORMVOLUME_COUNT_OVERSTRETCHED 2
#define DEFORMVOLUME_COUNT_MISSING 3 // cells on the border with flat or omitted tetrahedra
#define DEFORMVOLUME_COUNT_ASSUMED 4 // nonzero if the kernel assumed that there are no such cells
#define DEFORMVOLUME_COUNT_CANDIDATES 5 // voxels that cells may have won
// Nonzero if cells contain samples that another cell writes, or no cell.
#define DEFORMVOLUME_COUNT_TOUCHED 6
#define DEFORMVOLUME_COUNT_LARGE 7 // cells that were added to the list of large cells
#define DEFORMVOLUME_COUNTERS 8

// Partial sums of the counters and of the covered voxels (the kernel SumParts): the number of sums,
// and the number of parts.
#define DEFORMVOLUME_SUMMED_COVERED DEFORMVOLUME_COUNTERS
#define DEFORMVOLUME_SUMMED (DEFORMVOLUME_COUNTERS + 1)
#define DEFORMVOLUME_PARTS 128

// Totals of all sections (the kernel Summarize). Two words each, the lower word first: writes,
// covered voxels and inverted tetrahedra. One word each: overstretched tetrahedra, and flags.
#define DEFORMVOLUME_SUMMARY_WORDS 8
#define DEFORMVOLUME_SUMMARY_MISSING_WHERE_ASSUMED 1 // flag: COUNT_MISSING and COUNT_ASSUMED
#define DEFORMVOLUME_SUMMARY_LARGE 2                 // flag: there are large cells

// Samples of one cell that a work-item tests. A cell whose box has more samples is large. Large
// cells are added to a list, and later kernels resample them in pieces (LargeCells.cl).
#define DEFORMVOLUME_PIECE 65536
// Capacity of the list of large cells, with four integers per cell: local x, y and z, and the
// number of pieces. The kernel that finds a large cell resamples it if the list is full.
#define DEFORMVOLUME_MOST_LARGE_CELLS 65536
// Number of pieces in one launch.
#define DEFORMVOLUME_PIECES 1024

// Voxels of a patch of the output on each axis. An update of a part of the output clears whole
// patches if coverage may change, and searches whole patches for unsettled voxels.
#define DEFORMVOLUME_PATCH 8
// Number of patches that contain `voxels` voxels on an axis.
#define DEFORMVOLUME_PATCHES(voxels) (((voxels) + DEFORMVOLUME_PATCH - 1) / DEFORMVOLUME_PATCH)
// State of a patch.
#define DEFORMVOLUME_PATCH_UNSETTLED 1 // it has voxels without a winner yet
// Cells may contain voxels of the patch that another cell writes, or no cell.
#define DEFORMVOLUME_PATCH_TOUCHED 2
#define DEFORMVOLUME_PATCH_KEPT 4 // its voxels keep their values

// Voxels per work-item when coverage bits are expanded to bytes: half a word of bits.
#define DEFORMVOLUME_EXPANDED 16

// Bytes that a work-item of the kernels Fill1 to Fill8 writes.
#define DEFORMVOLUME_FILLED_BYTES 65536

// State of a vertex of the sampling mesh.
#define DEFORMVOLUME_VERTEX_SOURCE 1 // it has a deformed position and may be interpolated
// All tetrahedra around it are present, except those in cells that the boundary of the deformation
// mesh crosses, and it does not lie on the border of the volume.
#define DEFORMVOLUME_VERTEX_INTERIOR 2
#define DEFORMVOLUME_CELL_WHOLE 4     // the cell that begins at the vertex has all its tetrahedra
#define DEFORMVOLUME_VERTEX_REGULAR 8 // as INTERIOR, but may lie on the border of the volume
#define DEFORMVOLUME_VERTEX_UNCLIPPED 16 // a source with a boundary distance that is not negative
#define DEFORMVOLUME_CELL_UNCROSSED 32   // no smooth cut crosses the cell that begins at the vertex
#define DEFORMVOLUME_VERTEX_UNSPLIT 64   // its copies on both sides of the cut coincide with it

// Further bits in the mask of active tetrahedra, for the boundary of the deformation mesh.
#define DEFORMVOLUME_CELL_AT_BOUNDARY 32 // the boundary crosses the cell or a neighbor of it
#define DEFORMVOLUME_CELL_CROSSED 64     // the boundary crosses the cell

#ifdef __OPENCL_VERSION__

// The axes on which the split of a cell is mirrored. x, y, z: local indices.
static int Mirror(int x, int y, int z, const KernelParameters* p)
{
  return DEFORMVOLUME_MIRROR(p->First[0] + x, p->First[1] + y, p->First[2] + z);
}

// Whether the corner tetrahedra of a cell have the opposite orientation to those of the cell at
// index 0, in the output.
static int IsTurned(int x, int y, int z, const KernelParameters* p)
{
  return (p->First[0] + x + p->First[1] + y + p->First[2] + z + p->IsMirrored) & 1;
}

// Index of a vertex, and of a cell, in the arrays of a chunk.
static size_t VertexInChunk(int x, int y, int z, const KernelParameters* p)
{
  return ((size_t)(z - p->ChunkFirst) * p->Size[1] + y) * p->Size[0] + x;
}

static size_t CellInChunk(int x, int y, int z, const KernelParameters* p)
{
  return ((size_t)(z - p->ChunkFirst) * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x;
}

#if HAS_CUT // whether the program supports smooth cuts (CutVertex)
// Returns the index of a vertex in the list of cut vertices, or -1 if it is not in the list. The
// list is sorted by z, then y, then x. rows: index of the first vertex of each row along x, and the
// end of the list.
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

// Number of the first patch in the row of patches along x that contains the voxels at y and z.
static size_t PatchRow(size_t y, size_t z, const KernelParameters* p)
{
  const size_t width = DEFORMVOLUME_PATCHES(p->OutputSize[0]);
  const size_t height = DEFORMVOLUME_PATCHES(p->OutputSize[1]);
  return (z / DEFORMVOLUME_PATCH * height + y / DEFORMVOLUME_PATCH) * width;
}

// Number of voxel planes of all patches.
static size_t PatchedPlanes(const KernelParameters* p)
{
  return (size_t)DEFORMVOLUME_PATCHES(p->OutputSize[2]) * DEFORMVOLUME_PATCH;
}

// Local index of the first cell of a brick, which may be negative. item: an entry in the list of
// bricks (DEFORMVOLUME_BRICK_BITS).
static int3 FirstOfBrick(uint item, const KernelParameters* p)
{
  const int brick = item & ((1u << DEFORMVOLUME_BRICK_BITS) - 1);
  return (int3)(brick % p->BrickCount[0] * DEFORMVOLUME_BRICK_X + p->BrickOrigin[0],
    brick / p->BrickCount[0] % p->BrickCount[1] * DEFORMVOLUME_BRICK_Y + p->BrickOrigin[1],
    brick / p->BrickCount[0] / p->BrickCount[1] * DEFORMVOLUME_BRICK_Z + p->BrickOrigin[2]);
}

// Whether an entry in the list of bricks selects a section. section: number as for the counters.
static int IsSectionResampled(uint item, size_t section)
{
  const uint inBrick = section % DEFORMVOLUME_SECTIONS;
  const uint halves = inBrick / DEFORMVOLUME_SPANS;
  const uint spans = item >> DEFORMVOLUME_BRICK_BITS;
  const uint halvesY = spans >> DEFORMVOLUME_SPANS;
  const uint halvesZ = halvesY >> 2;
  return spans >> inBrick % DEFORMVOLUME_SPANS & halvesY >> (halves & 1) &
    halvesZ >> (halves >> 1) & 1;
}

// Number of the section that contains a cell, as for the counters.
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
