// SPDX-License-Identifier: BSD-3-Clause
// The static state of the vertices of the sampling mesh, one byte per voxel. This text comes after
// DeformationMapping.cl. Vertices are processed in cuboids of DEFORMVOLUME_CUBOID_X x Y x Z vertices, which are
// numbered in each chunk along x, then y, then z. Global size: (any, cuboids in the list). A work-item processes the
// vertices get_global_id(0), get_global_id(0) + get_global_size(0) and so on of each row of its cuboid.

// Local indices of the first vertex of a cuboid, and one past its last vertex.
static int3 FirstVertex(uint cuboid, const KernelParameters* p)
{
  const uint countX = (p->Size[0] + DEFORMVOLUME_CUBOID_X - 1) / DEFORMVOLUME_CUBOID_X;
  const uint countY = (p->Size[1] + DEFORMVOLUME_CUBOID_Y - 1) / DEFORMVOLUME_CUBOID_Y;
  return (int3)(cuboid % countX * DEFORMVOLUME_CUBOID_X, cuboid / countX % countY * DEFORMVOLUME_CUBOID_Y,
    p->PlanesBegin + cuboid / countX / countY * DEFORMVOLUME_CUBOID_Z);
}

static int3 EndOfVertices(int3 first, const KernelParameters* p)
{
  return min(first + (int3)(DEFORMVOLUME_CUBOID_X, DEFORMVOLUME_CUBOID_Y, DEFORMVOLUME_CUBOID_Z),
    (int3)(p->Size[0], p->Size[1], p->PlanesEnd));
}

// Index of a vertex in the array `marked` of MarkVertices.
static size_t IndexInList(int3 first, int x, int y, int z)
{
  return ((get_global_id(1) * DEFORMVOLUME_CUBOID_Z + (z - first.z)) * DEFORMVOLUME_CUBOID_Y + (y - first.y)) *
    DEFORMVOLUME_CUBOID_X + (x - first.x);
}

// State of the vertices, first pass. A vertex is a source if the deformation moves it and it is not blanked. A source
// is unclipped if its boundary distance is not negative. MarkVertices sets the other bits.
__kernel void MarkSources(MAPPING_PARAMETERS, __global const uchar* blanked, const int hasBlanked,
  __global const float* distances, __global uchar* state, __global const uint* cuboids, const KernelParameters p)
{
  const Mapping m = MAPPING_ARGUMENTS;
  const int3 first = FirstVertex(cuboids[get_global_id(1)], &p);
  const int3 end = EndOfVertices(first, &p);
  for (int z = first.z; z < end.z; ++z)
  {
    for (int y = first.y; y < end.y; ++y)
    {
      for (int x = first.x + get_global_id(0); x < end.x; x += get_global_size(0))
      {
        const size_t i = VertexInChunk(x, y, z, &p);
        const int source = IsMoved(&m, x, y, z, &p) && !(hasBlanked && blanked[i]);
        const int isClipped = p.HasDistances && distances[i] < 0.0f;
        state[i] = source
          ? DEFORMVOLUME_VERTEX_SOURCE | (isClipped ? 0 : DEFORMVOLUME_VERTEX_UNCLIPPED)
          : 0;
      }
    }
  }
}

static int IsUnclipped(__global const uchar* state, int x, int y, int z, const KernelParameters* p)
{
  return (state[VertexInChunk(x, y, z, p)] & DEFORMVOLUME_VERTEX_UNCLIPPED) != 0;
}

// The bits that MarkSources has set.
static int SourceBits(__global const uchar* state, int x, int y, int z, const KernelParameters* p)
{
  return state[VertexInChunk(x, y, z, p)] & (DEFORMVOLUME_VERTEX_SOURCE | DEFORMVOLUME_VERTEX_UNCLIPPED);
}

// Whether all tetrahedra of a cell are active.
static int IsWhole(int active)
{
  return (active & DEFORMVOLUME_ALL_TETRAHEDRA) == DEFORMVOLUME_ALL_TETRAHEDRA;
}

// Bits of MarkCrossSection() for the vertices and cells at x around the row at y and z. Vertices and cells outside the
// volume are ignored.
#define ALL_SOURCES 1       // the nine vertices (x, y - 1 to y + 1, z - 1 to z + 1) are unclipped sources
#define CELL_OF_SOURCES 2   // the four vertices (x, y to y + 1, z to z + 1) are unclipped sources
#define ALL_ACTIVE 4        // all tetrahedra of the four cells (x, y - 1 to y, z - 1 to z) are active
#define CELL_ACTIVE 8       // all tetrahedra of the cell (x, y, z) are active

static int MarkCrossSectionAtBorder(__global const uchar* state, __global const uchar* active, int x, int y, int z,
  const KernelParameters* p)
{
  int round = 1;
  int cell = y < p->Size[1] - 1 && z < p->Size[2] - 1;
  int activeRound = 1;
  int activeHere = 1;
  for (int k = max(z - 1, 0); k <= min(z + 1, p->Size[2] - 1); ++k)
  {
    for (int j = max(y - 1, 0); j <= min(y + 1, p->Size[1] - 1); ++j)
    {
      const int source = IsUnclipped(state, x, j, k, p);
      round &= source;
      cell &= source | (j < y) | (k < z);
      if (p->HasActive && x < p->Size[0] - 1 && j <= y && k <= z && j < p->Size[1] - 1 && k < p->Size[2] - 1)
      {
        const int whole = IsWhole(active[CellInChunk(x, j, k, p)]);
        activeRound &= whole;
        activeHere &= whole | (j < y) | (k < z);
      }
    }
  }
  return round * ALL_SOURCES | cell * CELL_OF_SOURCES | activeRound * ALL_ACTIVE | activeHere * CELL_ACTIVE;
}

static int MarkCrossSection(__global const uchar* state, __global const uchar* active, int x, int y, int z,
  const KernelParameters* p)
{
  if (x < 0 || x >= p->Size[0])
  {
    return ALL_SOURCES | ALL_ACTIVE;
  }
  if (y == 0 || z == 0 || y == p->Size[1] - 1 || z == p->Size[2] - 1)
  {
    return MarkCrossSectionAtBorder(state, active, x, y, z, p);
  }
  __global const uchar* s = state + VertexInChunk(x, y, z, p);
  const long row = p->Size[0];
  const long plane = row * p->Size[1];
  const int cell = s[0] & s[row] & s[plane] & s[plane + row];
  const int round = cell & s[-row] & s[plane - row] & s[-plane - row] & s[-plane] & s[-plane + row];
  int bits = ALL_ACTIVE | CELL_ACTIVE;
  if (p->HasActive && x < p->Size[0] - 1)
  {
    __global const uchar* c = active + CellInChunk(x, y, z, p);
    const long cellRow = row - 1;
    const long cellPlane = cellRow * (p->Size[1] - 1);
    const int here = c[0];
    const int all = here & c[-cellRow] & c[-cellPlane] & c[-cellPlane - cellRow];
    bits = IsWhole(all) * ALL_ACTIVE | IsWhole(here) * CELL_ACTIVE;
  }
  return bits | ((round & DEFORMVOLUME_VERTEX_UNCLIPPED) != 0) * ALL_SOURCES |
    ((cell & DEFORMVOLUME_VERTEX_UNCLIPPED) != 0) * CELL_OF_SOURCES;
}

// Whether a smooth cut crosses tetrahedra of a cell.
static int IsCrossed(
  __global const uint* cutRows, __global const CutVertex* cutVertices, int x, int y, int z, const KernelParameters* p)
{
#if HAS_CUT
  const int index = FindCutVertex(cutRows, cutVertices, x, y, z, p);
  return index >= 0 && (cutVertices[index].Tetrahedra & DEFORMVOLUME_ALL_TETRAHEDRA);
#else
  return 0;
#endif
}

// Whether all tetrahedra of a cell are active and all its vertices are unclipped sources.
static int IsComplete(__global const uchar* state, int cell, int x, int y, int z, const KernelParameters* p)
{
  int all = IsWhole(cell);
  for (int v = 0; v < 8 && all; ++v)
  {
    all = IsUnclipped(state, x + (v & 1), y + (v >> 1 & 1), z + (v >> 2), p);
  }
  return all;
}

// Whether the boundary of the deformation mesh crosses one of the cells around a vertex.
static int IsBesideCrossed(__global const uchar* active, int x, int y, int z, const KernelParameters* p)
{
  int crossed = 0;
  for (int k = max(z - 1, 0); k <= min(z, p->Size[2] - 2); ++k)
  {
    for (int j = max(y - 1, 0); j <= min(y, p->Size[1] - 2); ++j)
    {
      for (int i = max(x - 1, 0); i <= min(x, p->Size[0] - 2); ++i)
      {
        crossed |= active[CellInChunk(i, j, k, p)] & DEFORMVOLUME_CELL_CROSSED;
      }
    }
  }
  return crossed != 0;
}

// Whether a vertex is an unclipped source and all cells around it are complete. Cells that the boundary of the
// deformation mesh crosses do not count: BoundaryCells.cl finds the samples on their faces.
static int IsSurrounded(__global const uchar* state, __global const uchar* active, int x, int y, int z,
  const KernelParameters* p)
{
  int all = IsUnclipped(state, x, y, z, p);
  for (int v = 0; v < 8 && all; ++v)
  {
    const int i = x - (v & 1);
    const int j = y - (v >> 1 & 1);
    const int k = z - (v >> 2);
    if (i >= 0 && j >= 0 && k >= 0 && i < p->Size[0] - 1 && j < p->Size[1] - 1 && k < p->Size[2] - 1)
    {
      const int cell = active[CellInChunk(i, j, k, p)];
      all = (cell & DEFORMVOLUME_CELL_CROSSED) || IsComplete(state, cell, i, j, k, p);
    }
  }
  return all;
}

// Whether the boundary of the deformation mesh crosses the cell that begins at a vertex, and all vertices of this cell
// are unclipped sources. Such a vertex must not be interior, since a cell with eight interior vertices counts as whole.
static int BeginsCrossed(__global const uchar* state, __global const uchar* active, int x, int y, int z,
  const KernelParameters* p)
{
  if (!p->HasActive || x == p->Size[0] - 1 || y == p->Size[1] - 1 || z == p->Size[2] - 1 ||
    !(active[CellInChunk(x, y, z, p)] & DEFORMVOLUME_CELL_CROSSED))
  {
    return 0;
  }
  return IsComplete(state, DEFORMVOLUME_ALL_TETRAHEDRA, x, y, z, p);
}

// Computes the state of the vertices of one row of a cuboid, and stores it in `marked`. first: first vertex of the
// cuboid.
static void MarkRow(__global const uchar* state, __global const uchar* active, __global const uint* cutRows,
  __global const CutVertex* cutVertices, int3 first, int endX, int y, int z, __global uchar* marked,
  const KernelParameters* p)
{
  const int step = get_global_size(0);
  const int begin = first.x + get_global_id(0);
  // Vertices beyond the cell layers of this chunk are needed only as neighbors of other vertices.
  if (z < p->LayersBegin || z > p->LayersEnd)
  {
    for (int x = begin; x < endX; x += step)
    {
      marked[IndexInList(first, x, y, z)] = SourceBits(state, x, y, z, p);
    }
    return;
  }
  int before = MarkCrossSection(state, active, begin - 1, y, z, p);
  int here = MarkCrossSection(state, active, begin, y, z, p);
  for (int x = begin; x < endX; x += step)
  {
    const int after = MarkCrossSection(state, active, x + 1, y, z, p);
    int bits = SourceBits(state, x, y, z, p);
    if (bits)
    {
      bits |= DEFORMVOLUME_VERTEX_UNSPLIT; // CutPositions.cl clears the bit if a copy lies elsewhere
      if (((before & here & after & ALL_SOURCES) && (before & here & ALL_ACTIVE)) ||
        (p->HasActive && IsBesideCrossed(active, x, y, z, p) && IsSurrounded(state, active, x, y, z, p)))
      {
        bits |= DEFORMVOLUME_VERTEX_REGULAR;
        bits |= x > 0 && y > 0 && z > 0 && x < p->Size[0] - 1 && y < p->Size[1] - 1 && z < p->Size[2] - 1 &&
            !BeginsCrossed(state, active, x, y, z, p)
          ? DEFORMVOLUME_VERTEX_INTERIOR
          : 0;
      }
      bits |= (here & after & CELL_OF_SOURCES) && x < p->Size[0] - 1 && z < p->LayersEnd && (here & CELL_ACTIVE)
        ? DEFORMVOLUME_CELL_WHOLE
        : 0;
      bits |= IsCrossed(cutRows, cutVertices, x, y, z, p) ? 0 : DEFORMVOLUME_CELL_UNCROSSED;
    }
    marked[IndexInList(first, x, y, z)] = bits;
    before = step == 1 ? here : MarkCrossSection(state, active, x + step - 1, y, z, p);
    here = step == 1 ? after : MarkCrossSection(state, active, x + step, y, z, p);
  }
}

// State of the vertices, second pass. A vertex is interior if all vertices around it are unclipped sources, and all
// tetrahedra of the eight cells around it are active or in cells that the boundary of the deformation mesh crosses.
// Tetrahedra that a smooth cut divides count as active, since each side has a copy (CutCells.cl). A vertex that is
// wrongly not marked as interior costs time, but does not change the result. A cell is whole if its vertices are
// unclipped sources and its tetrahedra are active. The result goes to `marked`, since other work-items read the sources
// from `state` at the same time.
__kernel void MarkVertices(__global const uchar* state, __global const uchar* active,
  __global const uint* cutRows, __global const CutVertex* cutVertices, __global uchar* marked,
  __global const uint* cuboids, const KernelParameters p)
{
  const int3 first = FirstVertex(cuboids[get_global_id(1)], &p);
  const int3 end = EndOfVertices(first, &p);
  for (int z = first.z; z < end.z; ++z)
  {
    for (int y = first.y; y < end.y; ++y)
    {
      MarkRow(state, active, cutRows, cutVertices, first, end.x, y, z, marked, &p);
    }
  }
}

__kernel void StoreStates(__global const uchar* marked, __global uchar* state,
  __global const uint* cuboids, const KernelParameters p)
{
  const int3 first = FirstVertex(cuboids[get_global_id(1)], &p);
  const int3 end = EndOfVertices(first, &p);
  for (int z = first.z; z < end.z; ++z)
  {
    for (int y = first.y; y < end.y; ++y)
    {
      for (int x = first.x + get_global_id(0); x < end.x; x += get_global_size(0))
      {
        state[VertexInChunk(x, y, z, &p)] = marked[IndexInList(first, x, y, z)];
      }
    }
  }
}
