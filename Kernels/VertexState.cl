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

// Whether the vertices from begin to end, both included, are all sources.
static int AreSources(
  __global const uchar* sources, int3 begin, int3 end, const KernelParameters* p)
{
  for (int z = begin.z; z <= end.z; ++z)
  {
    for (int y = begin.y; y <= end.y; ++y)
    {
      for (int x = begin.x; x <= end.x; ++x)
      {
        if (!sources[VertexInSlab(x, y, z, p)])
        {
          return 0;
        }
      }
    }
  }
  return 1;
}

// Whether all vertices round a vertex are sources and all tetrahedra of the cells round it active, as
// far as they lie in the volume.
static int IsRegular(
  __global const uchar* sources, __global const uchar* active, int3 v, const KernelParameters* p)
{
  // Vertices of the planes beyond the layers of this chunk serve only as neighbours.
  const int3 last = (int3)(p->Size[0], p->Size[1], p->Size[2]) - 1;
  if (v.z < p->LayersBegin || v.z > p->LayersEnd ||
    !AreSources(sources, max(v - 1, 0), min(v + 1, last), p))
  {
    return 0;
  }
  for (int k = 0; k < 8; ++k)
  {
    const int3 c = v - (int3)(k & 1, k >> 1 & 1, k >> 2);
    if (all(c >= 0) && all(c < last) && !IsActive(active, c.x, c.y, c.z, p))
    {
      return 0;
    }
  }
  return 1;
}

static int IsWholeCell(
  __global const uchar* sources, __global const uchar* active, int3 v, const KernelParameters* p)
{
  return v.x < p->Size[0] - 1 && v.y < p->Size[1] - 1 && v.z >= p->LayersBegin &&
    v.z < p->LayersEnd && IsActive(active, v.x, v.y, v.z, p) && AreSources(sources, v, v + 1, p);
}

// Second pass: a vertex is interior when all vertices round it are sources and all tetrahedra of
// the eight cells round it are active. Being wrong on the careful side costs time, not truth. A
// cell is whole when its vertices are sources and its tetrahedra active.
__kernel void MarkVertices(__global const uchar* sources, __global const uchar* active,
  __global uchar* state, const KernelParameters p)
{
  for (int3 v = FirstVertex(&p); v.x < p.Size[0]; v.x += get_global_size(0))
  {
    int bits = sources[VertexInSlab(v.x, v.y, v.z, &p)];
    if (bits)
    {
      const int3 last = (int3)(p.Size[0], p.Size[1], p.Size[2]) - 1;
      if (IsRegular(sources, active, v, &p))
      {
        bits |= DEFORMVOLUME_VERTEX_REGULAR;
        bits |= all(v > 0) && all(v < last) ? DEFORMVOLUME_VERTEX_INTERIOR : 0;
      }
      bits |= IsWholeCell(sources, active, v, &p) ? DEFORMVOLUME_CELL_WHOLE : 0;
    }
    state[VertexInChunk(v.x, v.y, v.z, &p)] = bits;
  }
}
