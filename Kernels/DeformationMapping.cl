// SPDX-License-Identifier: BSD-3-Clause
// Deformation mapping: the deformed position of each vertex of the sampling mesh (one vertex per
// voxel), and the static state of the vertices.
//
// Positions are three ints a vertex, in 1/256 of an output voxel: rounding them makes every later
// decision of the fill rule exact. They lie in rows: the x of a row of vertices, then their y, then
// their z, so that several vertices load at once. A vertex without position has INT_MIN in x. What is
// interpolated is the displacement and not the position: an undeformed vertex then stays exactly
// where it was, however the deformation mesh looks and however large the volume is.
//
// Data, one element a vertex: links 16 bytes (tetrahedron, three barycentric weights), state one
// byte, positions 12 bytes; nodes of the mesh and points of the field: float4, displacement in
// output voxels. rest: for each index on x, then y, then z the undeformed position as a whole
// number of 1/256 voxels and what misses to it.
//
// A work-item takes every global-size(0)-th vertex of one row; global size (any, rows, planes).

#pragma OPENCL FP_CONTRACT OFF

typedef struct
{
  int Tetrahedron;
  float Weights[3];
} VertexLink;

#define LARGEST 4194303.0f // 1/256 voxels: about 2^14 voxels
#define FIELD_TOLERANCE 1e-3f // of a field cell: rounding must not lose the field's border

static float3 FieldIndex(const FieldParameters* field, int3 index)
{
  const float3 i = convert_float3(index);
  const float* m = field->IndexToField;
  return (float3)(m[0] * i.x + m[1] * i.y + m[2] * i.z + m[3],
    m[4] * i.x + m[5] * i.y + m[6] * i.z + m[7], m[8] * i.x + m[9] * i.y + m[10] * i.z + m[11]);
}

// The local index of the first vertex of a work-item.
static int3 FirstVertex(const KernelParameters* p)
{
  return (int3)(get_global_id(0), get_global_id(1), p->PlanesBegin + (int)get_global_id(2));
}

static size_t VertexIndex(int3 v, int firstPlane, const KernelParameters* p)
{
  return ((size_t)(v.z - firstPlane) * p->Size[1] + v.y) * p->Size[0] + v.x;
}

// What the vertices of a row have in common.
typedef struct
{
  __global const RestPosition* restrict RestX;
  int3 Whole;     // undeformed position but for x
  float4 Fraction;
  __global int* restrict X; // places of the positions
  __global int* restrict Y;
  __global int* restrict Z;
} Row;

static Row MakeRow(__global const RestPosition* rest, __global int* positions, int3 v,
  const KernelParameters* p)
{
  const RestPosition y = rest[p->Size[0] + v.y];
  const RestPosition z = rest[p->Size[0] + p->Size[1] + v.z];
  Row row;
  row.RestX = rest;
  row.Whole = (int3)(0, y.Whole, z.Whole);
  row.Fraction = (float4)(0.0f, y.Fraction, z.Fraction, 0.0f);
  row.X = positions + PositionIndex(0, v.y, v.z, p);
  row.Y = row.X + p->Size[0];
  row.Z = row.Y + p->Size[0];
  return row;
}

static void StorePosition(const Row* row, int x, float4 displacement)
{
  const RestPosition rest = row->RestX[x];
  // Clamped, because extrapolation can lead anywhere. Adding 1.5 * 2^23 leaves the rounded value in
  // the low bits: an addition where conversions that round are many instructions.
  float4 moved = displacement * 256.0f + (row->Fraction + (float4)(rest.Fraction, 0.0f, 0.0f, 0.0f));
  moved = moved < -LARGEST ? (float4)(-LARGEST) : moved;
  moved = moved > LARGEST ? (float4)(LARGEST) : moved;
  const int4 steps = as_int4(moved + 12582912.0f) - 0x4b400000;
  row->X[x] = rest.Whole + steps.x;
  row->Y[x] = row->Whole.y + steps.y;
  row->Z[x] = row->Whole.z + steps.z;
}

static void StoreNoPosition(const Row* row, int x)
{
  row->X[x] = INT_MIN;
  row->Y[x] = 0;
  row->Z[x] = 0;
}

// The deformation is a tetrahedral mesh.
__kernel void MapByMesh(__global const VertexLink* restrict links,
  __global const uchar* restrict state, __global const int4* restrict tetrahedra,
  __global const float4* restrict nodes, __global const RestPosition* restrict rest,
  __global int* restrict positions, const KernelParameters p)
{
  int3 v = FirstVertex(&p);
  const Row row = MakeRow(rest, positions, v, &p);
  const size_t first = VertexIndex((int3)(0, v.y, v.z), p.ChunkFirst, &p);
  for (; v.x < p.Size[0]; v.x += get_global_size(0))
  {
    const size_t i = first + v.x;
    if (!(state[i] & DEFORMVOLUME_VERTEX_SOURCE))
    {
      StoreNoPosition(&row, v.x);
      continue;
    }
    const VertexLink link = links[i];
    const int4 t = tetrahedra[link.Tetrahedron];
    const float a = link.Weights[0];
    const float b = link.Weights[1];
    const float c = link.Weights[2];
    const float d = 1.0f - a - b - c;
    const float4 sum = nodes[t.x] * a + nodes[t.y] * b + nodes[t.z] * c + nodes[t.w] * d;
    StorePosition(&row, v.x, sum);
  }
}

// The deformation is a displacement field, trilinear between its points.
__kernel void MapByField(__global const uchar* state, __global const float4* vectors,
  __global const RestPosition* rest, __global int* positions, const FieldParameters field,
  const KernelParameters p)
{
  int3 v = FirstVertex(&p);
  const Row row = MakeRow(rest, positions, v, &p);
  for (; v.x < p.Size[0]; v.x += get_global_size(0))
  {
    if (!(state[VertexIndex(v, p.ChunkFirst, &p)] & DEFORMVOLUME_VERTEX_SOURCE))
    {
      StoreNoPosition(&row, v.x);
      continue;
    }
    const int3 last = (int3)(field.Dimensions[0], field.Dimensions[1], field.Dimensions[2]) - 1;
    const float3 f = clamp(FieldIndex(&field, v), 0.0f,
      convert_float3(last));
    const int3 low = convert_int3(floor(f));
    const int3 high = min(low + 1, last);
    const float3 t = f - convert_float3(low);
    const size_t width = field.Dimensions[0];
    const size_t plane = width * field.Dimensions[1];
    __global const float4* lowLow = vectors + low.z * plane + low.y * width;
    __global const float4* lowHigh = vectors + low.z * plane + high.y * width;
    __global const float4* highLow = vectors + high.z * plane + low.y * width;
    __global const float4* highHigh = vectors + high.z * plane + high.y * width;
    // a + t (b - a) is exact for t = 0: no rounding where a voxel is a point of the field.
    const float4 a = lowLow[low.x] + t.x * (lowLow[high.x] - lowLow[low.x]);
    const float4 b = lowHigh[low.x] + t.x * (lowHigh[high.x] - lowHigh[low.x]);
    const float4 c = highLow[low.x] + t.x * (highLow[high.x] - highLow[low.x]);
    const float4 d = highHigh[low.x] + t.x * (highHigh[high.x] - highHigh[low.x]);
    const float4 e = a + t.y * (b - a);
    const float4 g = c + t.y * (d - c);
    StorePosition(&row, v.x, e + t.z * (g - e));
  }
}

// State of the vertices, first pass: those are a source that the deformation moves and that are
// not blanked. Sources lie in slabs of planes, as positions do.
__kernel void MarkSourcesByMesh(__global const VertexLink* links, __global const uchar* blanked,
  const int hasBlanked, __global uchar* sources, const KernelParameters p)
{
  for (int3 v = FirstVertex(&p); v.x < p.Size[0]; v.x += get_global_size(0))
  {
    const size_t i = VertexIndex(v, p.ChunkFirst, &p);
    const int source = links[i].Tetrahedron >= 0 && !(hasBlanked && blanked[i]);
    sources[VertexIndex(v, p.SlabFirst, &p)] = source ? DEFORMVOLUME_VERTEX_SOURCE : 0;
  }
}

__kernel void MarkSourcesByField(const FieldParameters field, __global const uchar* blanked,
  const int hasBlanked, __global uchar* sources, const KernelParameters p)
{
  for (int3 v = FirstVertex(&p); v.x < p.Size[0]; v.x += get_global_size(0))
  {
    const size_t i = VertexIndex(v, p.ChunkFirst, &p);
    const float3 f = FieldIndex(&field, v);
    const int inside = f.x >= -FIELD_TOLERANCE && f.y >= -FIELD_TOLERANCE &&
      f.z >= -FIELD_TOLERANCE && f.x <= field.Dimensions[0] - 1 + FIELD_TOLERANCE &&
      f.y <= field.Dimensions[1] - 1 + FIELD_TOLERANCE &&
      f.z <= field.Dimensions[2] - 1 + FIELD_TOLERANCE;
    const int source = (inside || field.Extrapolate) && !(hasBlanked && blanked[i]);
    sources[VertexIndex(v, p.SlabFirst, &p)] = source ? DEFORMVOLUME_VERTEX_SOURCE : 0;
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
        if (!sources[VertexIndex((int3)(x, y, z), p->SlabFirst, p)])
        {
          return 0;
        }
      }
    }
  }
  return 1;
}

static int IsInterior(
  __global const uchar* sources, __global const uchar* active, int3 v, const KernelParameters* p)
{
  // Vertices of the planes beyond the layers of this chunk serve only as neighbours.
  if (v.x == 0 || v.y == 0 || v.z == 0 || v.x == p->Size[0] - 1 || v.y == p->Size[1] - 1 ||
    v.z == p->Size[2] - 1 || v.z < p->LayersBegin || v.z > p->LayersEnd ||
    !AreSources(sources, v - 1, v + 1, p))
  {
    return 0;
  }
  for (int k = 0; k < 8; ++k)
  {
    if (!IsActive(active, v.x - (k & 1), v.y - (k >> 1 & 1), v.z - (k >> 2), p))
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
    int bits = sources[VertexIndex(v, p.SlabFirst, &p)];
    if (bits)
    {
      bits |= IsInterior(sources, active, v, &p) ? DEFORMVOLUME_VERTEX_INTERIOR : 0;
      bits |= IsWholeCell(sources, active, v, &p) ? DEFORMVOLUME_CELL_WHOLE : 0;
    }
    state[VertexIndex(v, p.ChunkFirst, &p)] = bits;
  }
}
