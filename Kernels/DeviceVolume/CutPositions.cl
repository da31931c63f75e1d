// SPDX-License-Identifier: BSD-3-Clause
// Positions of the copies of the vertices of divided tetrahedra, as if the vertices moved with the other side of a
// smooth cut (CutCells.cl uses them). This text comes after VertexState.cl.
//
// The copy of a vertex has the mean of displacements that are extrapolated from its neighbors on the other side:
// vertices with which it shares an edge of a divided tetrahedron. There are three ways, in this order:
// - EXTRAPOLATES_LINEARLY: linear extrapolation from the neighbor and the next vertex in the same direction, on the
//   side of the neighbor. So an affine deformation is reproduced.
// - EXTRAPOLATES_IN_PARALLEL: the displacement of the neighbor plus the change along this direction on the side of the
//   vertex. Used if no neighbor has such a next vertex, as in a single layer of cells at the border of the volume.
// - EXTRAPOLATES_CONSTANT: the displacement of the neighbor.
// A vertex has one copy, which all of its tetrahedra use. All numbers are integers, so the order of neighbors does not
// matter.
//
// Data:
//   vertices   list of cut vertices (KernelParameters.h)
//   stencils   for each cut vertex: neighbors to use, as bits (NEIGHBOR), and the way of extrapolation
//   positions  for each cut vertex: position of its copy, and in the last component 0 if the copy coincides with the
//              vertex. Tetrahedra with only such vertices need no copies. The bit DEFORMVOLUME_VERTEX_UNSPLIT of the
//              state is set for such vertices.
//   numbers    cut vertices to process

#define NEIGHBOR(dx, dy, dz) (1u << ((dz + 1) * 9 + (dy + 1) * 3 + dx + 1))
#define EXTRAPOLATES_LINEARLY 0
#define EXTRAPOLATES_IN_PARALLEL 1
#define EXTRAPOLATES_CONSTANT 2
#define IS_CONNECTED 3 // no extrapolation: undivided tetrahedra connect the vertex to its neighbors on the other side


// The list of cut vertices, and the masks of the chunk.
typedef struct
{
  __global const uint* Rows;
  __global const CutVertex* Vertices;
  __global const uchar* State;
  __global const uchar* Active;
} CutMesh;

// Active tetrahedra of a cell, as bits. 0 outside the volume.
static int ActiveOf(const CutMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  if (x < 0 || y < 0 || z < 0 || x >= p->Size[0] - 1 || y >= p->Size[1] - 1 || z >= p->Size[2] - 1)
  {
    return 0;
  }
  return DEFORMVOLUME_ALL_TETRAHEDRA & (p->HasActive ? mesh->Active[CellInChunk(x, y, z, p)] : ~0);
}

static int IsInVolume(int x, int y, int z, const KernelParameters* p)
{
  return x >= 0 && y >= 0 && z >= 0 && x < p->Size[0] && y < p->Size[1] && z < p->Size[2];
}

static int HasPosition(const CutMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  return IsInVolume(x, y, z, p) && (StateOf(mesh->State, x, y, z, p) & DEFORMVOLUME_VERTEX_SOURCE);
}

// Returns the side of a vertex of crossed tetrahedra: 1 if its distance is negative, else 0. -1 for other vertices.
static int SideOf(const CutMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  const int index = FindCutVertex(mesh->Rows, mesh->Vertices, x, y, z, p);
  return index < 0 || !(mesh->Vertices[index].Tetrahedra & DEFORMVOLUME_CUT_CORNER)
    ? -1
    : mesh->Vertices[index].Distance < 0.0f;
}

// Adds the neighbors of a vertex in one of its cells, as bits. apart: neighbors on the other side in divided
// tetrahedra. joined: all neighbors in undivided tetrahedra.
static void AddNeighbors(const CutMesh* mesh, int3 vertex, int side, int3 cell, uint* apart, uint* joined,
  const KernelParameters* p)
{
  const int active = ActiveOf(mesh, cell.x, cell.y, cell.z, p);
  if (!active)
  {
    return;
  }
  const int first = FindCutVertex(mesh->Rows, mesh->Vertices, cell.x, cell.y, cell.z, p);
  const int crossed = first < 0 ? 0 : mesh->Vertices[first].Tetrahedra;
  const int mirror = Mirror(cell.x, cell.y, cell.z, p);
  const int own = ((vertex.x - cell.x) | (vertex.z - cell.z) << 1 | (vertex.y - cell.y) << 2) ^ mirror;
  for (int t = 0; t < 5; ++t)
  {
    int hasOwn = 0;
    for (int k = 0; k < 4; ++k)
    {
      hasOwn |= Tetrahedra[t][k] == own;
    }
    if (!hasOwn || !(active >> t & 1))
    {
      continue;
    }
    uint all = 0;
    uint other = 0;
    for (int k = 0; k < 4; ++k)
    {
      const int o = Tetrahedra[t][k] ^ mirror;
      const int3 at = cell + (int3)(OFFSET_X(o), OFFSET_Y(o), OFFSET_Z(o));
      const uint bit = NEIGHBOR(at.x - vertex.x, at.y - vertex.y, at.z - vertex.z);
      all |= bit;
      if (crossed >> t & 1)
      {
        other |= SideOf(mesh, at.x, at.y, at.z, p) != side ? bit : 0;
      }
    }
    *apart |= other;
    *joined |= other ? 0 : all;
  }
}

// Whether two neighboring vertices belong to the same active tetrahedron.
static int AreConnected(const CutMesh* mesh, int3 a, int3 b, const KernelParameters* p)
{
  const int3 low = min(a, b);
  const int3 step = abs(a - b) == 0 ? (int3)(1) : (int3)(0); // 1 on axes on which there are cells on both sides
  for (int c = 0; c < 8; ++c)
  {
    const int3 back = (int3)(c & 1, c >> 1 & 1, c >> 2);
    if (back.x > step.x || back.y > step.y || back.z > step.z)
    {
      continue;
    }
    const int3 cell = low - back;
    const int active = ActiveOf(mesh, cell.x, cell.y, cell.z, p);
    const int mirror = Mirror(cell.x, cell.y, cell.z, p);
    const int numberA = ((a.x - cell.x) | (a.z - cell.z) << 1 | (a.y - cell.y) << 2) ^ mirror;
    const int numberB = ((b.x - cell.x) | (b.z - cell.z) << 1 | (b.y - cell.y) << 2) ^ mirror;
    for (int t = 0; t < 5; ++t)
    {
      int has = 0;
      for (int k = 0; k < 4; ++k)
      {
        has += Tetrahedra[t][k] == numberA || Tetrahedra[t][k] == numberB;
      }
      if (has == 2 && (active >> t & 1))
      {
        return 1;
      }
    }
  }
  return 0;
}

// Whether the change of the displacement between two vertices can be used on a side of the cut: the second vertex has a
// position, is not on the other side, and is connected to the first one.
static int CanExtrapolate(const CutMesh* mesh, int3 from, int3 to, int side, const KernelParameters* p)
{
  return HasPosition(mesh, to.x, to.y, to.z, p) && SideOf(mesh, to.x, to.y, to.z, p) != 1 - side &&
    AreConnected(mesh, from, to, p);
}

// Copies the stencils and positions of the vertices that are also in a previous list.
__kernel void KeepStencils(__global const uint* lastRows, __global const CutVertex* lastVertices,
  __global const uint2* lastStencils, __global const int4* lastPositions, __global const CutVertex* vertices,
  __global uint2* stencils, __global int4* positions, const uint count, const KernelParameters p)
{
  const uint i = get_global_id(0);
  const int last =
    i < count ? FindCutVertex(lastRows, lastVertices, vertices[i].X, vertices[i].Y, vertices[i].Z, &p) : -1;
  if (last >= 0)
  {
    stencils[i] = lastStencils[last];
    positions[i] = lastPositions[last];
  }
}

// Computes the stencils of cut vertices.
__kernel void FindCutStencils(__global const uchar* state, __global const uchar* active, __global const uint* rows,
  __global const CutVertex* vertices, __global uint2* stencils, __global const uint* numbers, const uint count,
  const KernelParameters p)
{
  if (get_global_id(0) >= count)
  {
    return;
  }
  const uint i = numbers[get_global_id(0)];
  const CutMesh mesh = { rows, vertices, state, active };
  const int3 at = (int3)(vertices[i].X, vertices[i].Y, vertices[i].Z);
  const int side = vertices[i].Distance < 0.0f;
  uint apart = 0;
  uint joined = 0;
  for (int c = 0; c < 8; ++c)
  {
    AddNeighbors(&mesh, at, side, at - (int3)(c & 1, c >> 1 & 1, c >> 2), &apart, &joined, &p);
  }
  if (apart & joined)
  {
    stencils[i] = (uint2)(apart, IS_CONNECTED);
    return;
  }
  uint found[3] = { 0, 0, 0 };
  for (int n = 0; n < 27; ++n)
  {
    const int3 step = (int3)(n % 3, n / 3 % 3, n / 9) - 1;
    const int3 near = at + step;
    if (!(apart >> n & 1) || !HasPosition(&mesh, near.x, near.y, near.z, &p))
    {
      continue;
    }
    const int way = CanExtrapolate(&mesh, near, near + step, 1 - side, &p) ? EXTRAPOLATES_LINEARLY
      : CanExtrapolate(&mesh, at, at - step, side, &p)                     ? EXTRAPOLATES_IN_PARALLEL
                                                                           : EXTRAPOLATES_CONSTANT;
    found[way] |= 1u << n;
  }
  const int way = found[EXTRAPOLATES_LINEARLY] ? EXTRAPOLATES_LINEARLY
    : found[EXTRAPOLATES_IN_PARALLEL]          ? EXTRAPOLATES_IN_PARALLEL
                                               : EXTRAPOLATES_CONSTANT;
  stencils[i] = (uint2)(found[way], way);
}

static int3 WholeRestOf(const Mapping* m, int3 at, const KernelParameters* p)
{
  const Rest rest = RestOf(m, at.x, at.y, at.z, p);
#if HAS_TURNED_AXES
  // A fraction is the sum of three products, each below one step. It can reach several steps, so it is rounded and
  // not left out.
  return rest.Whole.xyz + convert_int3_rte(rest.Fraction.xyz);
#else
  return rest.Whole.xyz;
#endif
}

// The rounded displacement of a vertex, in 1/256 output voxel.
static int3 RoundedDisplacementOf(const Mapping* m, int3 at, const KernelParameters* p)
{
  return PositionOf(m, at.x, at.y, at.z, p).xyz - WholeRestOf(m, at, p);
}

// Divides, and rounds to the nearest integer, halves up.
static int DivideRounded(int sum, int count)
{
  const int twice = 2 * sum + count;
  return twice >= 0 ? twice / (2 * count) : -((2 * count - 1 - twice) / (2 * count));
}

// Returns the position of the copy of a vertex. own: position of the vertex.
static int4 CopyPosition(const Mapping* m, int3 at, uint2 stencil, int3 own, const KernelParameters* p)
{
  if (stencil.y == IS_CONNECTED)
  {
    return (int4)(own, 0);
  }
  int3 sum = 0;
  for (uint remaining = stencil.x; remaining; remaining &= remaining - 1)
  {
    const int n = 31 - clz(remaining & -remaining);
    const int3 step = (int3)(n % 3, n / 3 % 3, n / 9) - 1;
    const int3 moved = RoundedDisplacementOf(m, at + step, p);
    sum += moved;
    if (stencil.y == EXTRAPOLATES_LINEARLY)
    {
      sum += moved - RoundedDisplacementOf(m, at + 2 * step, p);
    }
    else if (stencil.y == EXTRAPOLATES_IN_PARALLEL)
    {
      sum += RoundedDisplacementOf(m, at - step, p) - RoundedDisplacementOf(m, at, p);
    }
  }
  const int count = popcount(stencil.x);
  const int3 mean =
    (int3)(DivideRounded(sum.x, count), DivideRounded(sum.y, count), DivideRounded(sum.z, count));
  const int3 other = WholeRestOf(m, at, p) + mean;
  const int isNear = all(abs_diff(other, own) <= (uint3)(DEFORMVOLUME_CLOSED_GAP));
  return isNear ? (int4)(own, 0) : (int4)(other, 1);
}

// Computes the positions of the copies of cut vertices.
__kernel void FindCutPositions(MAPPING_PARAMETERS, __global uchar* state, __global const CutVertex* vertices,
  __global const uint2* stencils, __global int4* positions, __global const uint* numbers, const uint count,
  const KernelParameters p)
{
  if (get_global_id(0) >= count)
  {
    return;
  }
  const uint i = numbers[get_global_id(0)];
  const int3 at = (int3)(vertices[i].X, vertices[i].Y, vertices[i].Z);
  const Mapping m = MAPPING_ARGUMENTS;
  const uint2 stencil = stencils[i];
  const size_t vertex = VertexInChunk(at.x, at.y, at.z, &p);
  if (!stencil.x || !(state[vertex] & DEFORMVOLUME_VERTEX_SOURCE))
  {
    positions[i] = (int4)(INT_MIN, 0, 0, 1);
    return;
  }
  const int3 own = PositionOf(&m, at.x, at.y, at.z, &p).xyz; // the last component is undefined
  const int4 other = CopyPosition(&m, at, stencil, own, &p);
  positions[i] = other;
  state[vertex] = other.w ? state[vertex] & ~DEFORMVOLUME_VERTEX_UNSPLIT
                          : state[vertex] | DEFORMVOLUME_VERTEX_UNSPLIT;
}
