// SPDX-License-Identifier: BSD-3-Clause
// The candidates of a group of cells: the samples in the box of each cell (BrickResampling.cl).
//
// Why apart from what becomes of them, for all groups of a row at once: how many rounds a group takes is no
// two times the same, and the processor guesses it wrong. It finds that out at once where the number lies in
// memory, and only after all that precedes if it had just been computed.

#define MAXIMUM_EXTENT 7.99f  // voxels: the normals of larger cells are not exact in float
#define ALMOST_ONE (255.0f / 256.0f) // ceil(v) = trunc(v + ALMOST_ONE) for multiples of 1/256

#define EIGHT(OP, C) OP(OP(OP(C##0, C##1), OP(C##2, C##3)), OP(OP(C##4, C##5), OP(C##6, C##7)))

typedef struct
{
  INTS There;     // cells that have a vertex with a position, and none beyond the volume
  FLOATS Extent;  // the longest edge of the box
  FLOATS Reach;   // the extent times the box's three faces
  INTS First[3];  // the first candidate, in voxels of the output
  INTS Count[3];  // how many on each axis
  INTS Number;    // how many in all, of cells that are small and whole
  INTS Box;       // cells that are boxes, if there are any
  GroupState State; // on the border
  int Iterations; // the largest number
  int HasBoxes;
  int Skip;       // no cell touches a voxel to be won
} GroupCandidates;

#define LOAD_VERTEX(v)                                                                             \
  const FLOATS X##v = VERTEX(v, 0), Y##v = VERTEX(v, 1), Z##v = VERTEX(v, 2);

// Cells from x on every second one. border: whether a vertex may not be interior.
static __attribute__((noinline)) void FindGroupCandidates(const Group* group, int x, int y, int z, int border,
  const SamplingMesh* mesh, Output* output, GroupCandidates* c, const KernelParameters* p)
{
  LOAD_VERTEX(0)
  LOAD_VERTEX(1)
  LOAD_VERTEX(2)
  LOAD_VERTEX(3)
  LOAD_VERTEX(4)
  LOAD_VERTEX(5)
  LOAD_VERTEX(6)
  LOAD_VERTEX(7)
  const FLOATS lowX = EIGHT(Least, X), lowY = EIGHT(Least, Y), lowZ = EIGHT(Least, Z);
  const FLOATS highX = EIGHT(Most, X), highY = EIGHT(Most, Y), highZ = EIGHT(Most, Z);
  const FLOATS sizeX = highX - lowX, sizeY = highY - lowY, sizeZ = highZ - lowZ;
  const FLOATS extent = Most(sizeX, Most(sizeY, sizeZ));
  const INTS there = (lowX > 0.5f * NOT_THERE) & (lowX < 0.5f * NO_SOURCE);

  // Cells that are boxes, as in an undeformed, shifted, axis-wise scaled or right-angled turned volume:
  // each coordinate varies along one axis of the lattice only. If one edge of no cell is parallel to an
  // axis, no need to look. Lanes that hold no cell hold anything, and must not decide.
  INTS box = 0;
  c->HasBoxes = 0;
  if (LaneBits(there & ((X0 == X1) + (Y0 == Y1) + (Z0 == Z1) == -2)))
  {
#define SAME(C, a, b) (C##a == C##b)
#define ALONG_X(C) (SAME(C, 0, 1) & SAME(C, 2, 3) & SAME(C, 4, 5) & SAME(C, 6, 7))
#define ALONG_Z(C) (SAME(C, 0, 2) & SAME(C, 1, 3) & SAME(C, 4, 6) & SAME(C, 5, 7))
#define ALONG_Y(C) (SAME(C, 0, 4) & SAME(C, 1, 5) & SAME(C, 2, 6) & SAME(C, 3, 7))
#define ALIGNED(C)                                                                                 \
  ((ALONG_X(C) & ALONG_Y(C)) | (ALONG_X(C) & ALONG_Z(C)) | (ALONG_Y(C) & ALONG_Z(C)))
    box = ALIGNED(X) & ALIGNED(Y) & ALIGNED(Z);
    c->HasBoxes = 1;
  }

  // Candidates are half-open inside the mesh: by the fill rule no sample on the upper side is taken.
  INTS whole = -1;
  FLOATS toEndX = ALMOST_ONE, toEndY = ALMOST_ONE, toEndZ = ALMOST_ONE;
  if (border || DEFORMVOLUME_IS_CLOSED(p->Pass))
  {
    toEndX = toEndY = toEndZ = 1.0f;
  }
  if (border)
  {
    StatesOfGroup(mesh, x, y, z, &c->State, p);
    whole = c->State.Whole;
    // Boxes on the border leave what is on their high sides to the next cells, if there are any. That the
    // high sides are the upper ones is wanted for that.
    if (!DEFORMVOLUME_IS_CLOSED(p->Pass) && c->HasBoxes)
    {
      const INTS cellX = x + 2 * LANE_INDEX;
      const int mirror = Mirror(x, y, z, p);
#define RISES(C, to) ((mirror & to) ? C##to < C##0 : C##to > C##0)
      const INTS inner = c->State.Interior == 255;
      box &= there & (inner | ((c->State.Regular == 255) & RISES(X, 1) & RISES(Z, 2) & RISES(Y, 4)));
      output->Assumed |= LaneBits(box & ~inner) != 0;
      toEndX = (box & (cellX != p->Size[0] - 2)) ? ALMOST_ONE : toEndX;
      toEndY = (box & (INTS)(y != p->Size[1] - 2 ? -1 : 0)) ? ALMOST_ONE : toEndY;
      toEndZ = (box & (INTS)(z != p->Size[2] - 2 ? -1 : 0)) ? ALMOST_ONE : toEndZ;
    }
  }
  if (c->HasBoxes)
  {
    c->Box = box;
  }
#define FIRST_OF(low, size) TO_INTS(Least(Most(low, 0.0f), (float)(size)) + ALMOST_ONE)
#define END_OF(high, toEnd, size) TO_INTS(Most(Least((high) + toEnd, (float)(size)), 0.0f))
  INTS firstX = FIRST_OF(lowX, p->OutputSize[0]);
  INTS firstY = FIRST_OF(lowY, p->OutputSize[1]);
  INTS firstZ = FIRST_OF(lowZ, p->OutputSize[2]);
  INTS countX = END_OF(highX, toEndX, p->OutputSize[0]) - firstX;
  INTS countY = END_OF(highY, toEndY, p->OutputSize[1]) - firstY;
  INTS countZ = END_OF(highZ, toEndZ, p->OutputSize[2]) - firstZ;
  const INTS some = there & (countX > 0) & (countY > 0) & (countZ > 0);
  c->Skip = 0;
  if (DEFORMVOLUME_IS_CLOSED(p->Pass))
  {
    const int first[3] = { LeastAmong(some, firstX), LeastAmong(some, firstY),
      LeastAmong(some, firstZ) };
    const int last[3] = { MostAmong(some, firstX + countX - 1), MostAmong(some, firstY + countY - 1),
      MostAmong(some, firstZ + countZ - 1) };
    c->Skip = !LaneBits(some) || !AnyUnsettled(output->Unsettled, first, last, p);
  }
  if (p->IsPart)
  {
    // A cell that reaches beyond the part is looked at as in the whole: what becomes of it must not
    // depend on where the part ends. It begins less than MAXIMUM_EXTENT before the part.
#define WHOLE_FIRST(low, axis)                                                                     \
  TO_INTS(Most(low, (float)max(p->WholeFirst[axis], -8)) + (8.0f + ALMOST_ONE)) - 8
#define WHOLE_END(high, toEnd, axis)                                                               \
  TO_INTS(Least((high) + toEnd, (float)min(p->WholeEnd[axis], p->OutputSize[axis] + 8)) + 8.0f) - 8
    firstX = WHOLE_FIRST(lowX, 0);
    firstY = WHOLE_FIRST(lowY, 1);
    firstZ = WHOLE_FIRST(lowZ, 2);
    countX = WHOLE_END(highX, toEndX, 0) - firstX;
    countY = WHOLE_END(highY, toEndY, 1) - firstY;
    countZ = WHOLE_END(highZ, toEndZ, 2) - firstZ;
  }
  const INTS number = some & whole & (extent <= MAXIMUM_EXTENT) & (countX * countY * countZ);
  c->There = there;
  c->Extent = extent;
  c->Reach = extent * fma(sizeX, sizeY, sizeZ * (sizeX + sizeY));
  c->First[0] = firstX;
  c->First[1] = firstY;
  c->First[2] = firstZ;
  c->Count[0] = countX;
  c->Count[1] = countY;
  c->Count[2] = countZ;
  c->Number = number;
  c->Iterations = MostOf(number);
}
