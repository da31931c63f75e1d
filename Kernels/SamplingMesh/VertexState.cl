// SPDX-License-Identifier: BSD-3-Clause
// The static state of the vertices of the sampling mesh, one byte a voxel. It comes after
// DeformationMapping.cl. A work-item takes every global-size(0)-th vertex of one row; global size
// (any, rows, planes).

// The local index of the first vertex of a work-item.
static int3 FirstVertex(const KernelParameters* p)
{
  return (int3)(get_global_id(0), get_global_id(1), p->PlanesBegin + (int)get_global_id(2));
}

// Sources lie in slabs of planes, as positions do.
static size_t VertexInSlab(int x, int y, int z, const KernelParameters* p)
{
  return ((size_t)(z - p->SlabFirst) * p->Size[1] + y) * p->Size[0] + x;
}

// State of the vertices, first pass: those are a source that the deformation moves and that are
// not blanked.
__kernel void MarkSources(MAPPING_PARAMETERS, __global const uchar* blanked, const int hasBlanked,
  __global uchar* sources, const KernelParameters p)
{
  const Mapping m = MAPPING_ARGUMENTS;
  for (int3 v = FirstVertex(&p); v.x < p.Size[0]; v.x += get_global_size(0))
  {
    const size_t i = VertexInChunk(v.x, v.y, v.z, &p);
    const int source = IsMoved(&m, v.x, v.y, v.z, &p) && !(hasBlanked && blanked[i]);
    sources[VertexInSlab(v.x, v.y, v.z, &p)] = source ? DEFORMVOLUME_VERTEX_SOURCE : 0;
  }
}

static int IsActive(__global const uchar* active, int x, int y, int z, const KernelParameters* p)
{
  return !p->HasActive ||
    (active[((size_t)(z - p->ChunkFirst) * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x] & 31) ==
    31;
}

// What vertices with one x have in common, those round (x, y, z) on y and z: bit 0 whether they are all
// sources, as far as they lie in the volume, and bit 1 whether those of the cells from y and z on are.
static int MarkColumn(
  __global const uchar* sources, int x, int y, int z, const KernelParameters* p)
{
  if (x < 0 || x >= p->Size[0])
  {
    return 1;
  }
  int round = 1;
  int cell = y < p->Size[1] - 1 && z < p->Size[2] - 1;
  for (int k = max(z - 1, 0); k <= min(z + 1, p->Size[2] - 1); ++k)
  {
    for (int j = max(y - 1, 0); j <= min(y + 1, p->Size[1] - 1); ++j)
    {
      const int source = sources[VertexInSlab(x, j, k, p)];
      round &= source;
      cell &= source | (j < y) | (k < z);
    }
  }
  return round | cell << 1;
}

// Whether all tetrahedra of the cells round a vertex are active, as far as they lie in the volume.
static int IsActiveRound(__global const uchar* active, int x, int y, int z, const KernelParameters* p)
{
  for (int k = 0; p->HasActive && k < 8; ++k)
  {
    const int3 c = (int3)(x, y, z) - (int3)(k & 1, k >> 1 & 1, k >> 2);
    if (all(c >= 0) && all(c < (int3)(p->Size[0], p->Size[1], p->Size[2]) - 1) &&
      !IsActive(active, c.x, c.y, c.z, p))
    {
      return 0;
    }
  }
  return 1;
}

// Second pass: a vertex is interior when all vertices round it are sources and all tetrahedra of
// the eight cells round it are active. Being wrong on the careful side costs time, not truth. A
// cell is whole when its vertices are sources and its tetrahedra active.
__kernel void MarkVertices(__global const uchar* sources, __global const uchar* active,
  __global uchar* state, const KernelParameters p)
{
  const int3 first = FirstVertex(&p);
  const int y = first.y;
  const int z = first.z;
  const int step = get_global_size(0);
  // Vertices of the planes beyond the layers of this chunk serve only as neighbours.
  if (z < p.LayersBegin || z > p.LayersEnd)
  {
    for (int x = first.x; x < p.Size[0]; x += step)
    {
      state[VertexInChunk(x, y, z, &p)] = sources[VertexInSlab(x, y, z, &p)];
    }
    return;
  }
  int before = MarkColumn(sources, first.x - 1, y, z, &p);
  int here = MarkColumn(sources, first.x, y, z, &p);
  for (int x = first.x; x < p.Size[0]; x += step)
  {
    const int after = MarkColumn(sources, x + 1, y, z, &p);
    int bits = sources[VertexInSlab(x, y, z, &p)];
    if (bits)
    {
      if ((before & here & after & 1) && IsActiveRound(active, x, y, z, &p))
      {
        bits |= DEFORMVOLUME_VERTEX_REGULAR;
        bits |= x > 0 && y > 0 && z > 0 && x < p.Size[0] - 1 && y < p.Size[1] - 1 && z < p.Size[2] - 1
          ? DEFORMVOLUME_VERTEX_INTERIOR
          : 0;
      }
      bits |= (here & after & 2) && x < p.Size[0] - 1 && z < p.LayersEnd &&
          IsActive(active, x, y, z, &p)
        ? DEFORMVOLUME_CELL_WHOLE
        : 0;
    }
    state[VertexInChunk(x, y, z, &p)] = bits;
    before = step == 1 ? here : MarkColumn(sources, x + step - 1, y, z, &p);
    here = step == 1 ? after : MarkColumn(sources, x + step, y, z, &p);
  }
}
