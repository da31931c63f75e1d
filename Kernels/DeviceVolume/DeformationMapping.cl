// SPDX-License-Identifier: BSD-3-Clause
// Deformation mapping: the deformed positions of the vertices of the sampling mesh (one vertex per voxel).
//
// A position is the undeformed position plus a displacement, rounded to 1/256 output voxel. With rounded positions, all
// later decisions of the fill rule are exact. The mapping interpolates displacements, not positions. So a vertex with
// displacement 0 keeps its exact position, whatever the deformation mesh and the size of the volume. All kernels
// compute a position with the same operations in the same order, so the result is always bitwise equal.
//
// Macros that the host defines before this text:
//   HAS_TURNED_AXES  whether the axes of the volume are not those of the output
//   MAPPING          one of:
//     MAPPING_LINKS           links: 16 bytes per voxel (tetrahedron, three barycentric weights); tetrahedra: int4,
//                             nodes times DEFORMVOLUME_NODE_STRIDE; nodes: float4, displacements in output voxels
//     MAPPING_RUNS            runs of voxels in one tetrahedron (RunMapping.cl)
//     MAPPING_FIELD           vectors: float4 per point of the field, displacements in output voxels, interpolated
//                             trilinearly
//     MAPPING_FIELD_IN_PLACE  vectors: three floats per point of the field, which a matrix maps to displacements in
//                             output voxels; each voxel is a point of the field
//
// rest: for each index on x, then y, then z the undeformed position (RestPosition, or RestVector if HAS_TURNED_AXES).

#pragma OPENCL FP_CONTRACT OFF

#define MAPPING_LINKS 0
#define MAPPING_RUNS 1
#define MAPPING_FIELD 2
#define MAPPING_FIELD_IN_PLACE 3

#if HAS_TURNED_AXES
typedef RestVector RestEntry;
#else
typedef RestPosition RestEntry;
#endif

typedef struct
{
  int Tetrahedron;
  float Weights[3];
} VertexLink;

// A node in an array of nodes. offset: number of the node, times DEFORMVOLUME_NODE_STRIDE.
#define NODE(nodes, offset) (*(__global const float4*)((__global const float2*)(nodes) + (offset)))

// The largest displacement, in steps of 1/256 voxel: 2^22 - 1, so that adding ROUND_TO_INTEGER is exact.
#define LARGEST 4194303.0f
#define ROUND_TO_INTEGER 12582912.0f // 1.5 * 2^23: (v + this) - this is v rounded to an integer
#define FIELD_TOLERANCE 1e-3f // in cells of the field: rounding must not lose the field's border

// Rounds displacements to multiples of 1/256 voxel. unit: 1 if they are in 1/256 voxel, 1/256 if they are in voxels.
// The result is clamped: extrapolated displacements can be very large, and a field may contain any value, also NaN.
#define DEFINE_ROUND_STEPS(TYPE)                                                                   \
  static TYPE RoundSteps_##TYPE(TYPE moved, float unit)                                            \
  {                                                                                                \
    moved = (moved + ROUND_TO_INTEGER * unit) - ROUND_TO_INTEGER * unit;                           \
    moved = moved > -LARGEST * unit ? moved : (TYPE)(-LARGEST * unit);                             \
    return moved > LARGEST * unit ? (TYPE)(LARGEST * unit) : moved;                                \
  }
DEFINE_ROUND_STEPS(float4)
DEFINE_ROUND_STEPS(float16)

// Returns the state of a vertex. Without stored states, all vertices are sources.
static int StateOf(__global const uchar* state, int x, int y, int z, const KernelParameters* p)
{
  if (p->HasState)
  {
    return state[VertexInChunk(x, y, z, p)];
  }
  const int isFirst = (x == 0) | (y == 0) | (z == 0);
  const int isLast = (x == p->Size[0] - 1) | (y == p->Size[1] - 1) | (z == p->Size[2] - 1);
  return DEFORMVOLUME_VERTEX_SOURCE | DEFORMVOLUME_VERTEX_REGULAR | DEFORMVOLUME_CELL_UNCROSSED |
    DEFORMVOLUME_VERTEX_UNSPLIT | (isFirst | isLast ? 0 : DEFORMVOLUME_VERTEX_INTERIOR) |
    (isLast ? 0 : DEFORMVOLUME_CELL_WHOLE);
}

static float3 FieldIndex(const FieldParameters* field, int3 index)
{
  const float3 i = convert_float3(index + (int3)(field->First[0], field->First[1], field->First[2]));
  const float* m = field->IndexToField;
#define FIELD_ROW(k)                                                                               \
  (MULTIPLY_ADD(m[k + 2], i.z, MULTIPLY_ADD(m[k + 1], i.y, m[k] * i.x)) + m[k + 3])
  return (float3)(FIELD_ROW(0), FIELD_ROW(4), FIELD_ROW(8));
}

#if MAPPING == MAPPING_LINKS

#define MAPPING_PARAMETERS                                                                         \
  __global const VertexLink *restrict links, __global const int4 *restrict tetrahedra,             \
    __global const float4 *restrict nodes, __global const RestEntry *restrict rest
#define MAPPING_ARGUMENTS { links, tetrahedra, nodes, rest }

typedef struct
{
  __global const VertexLink* Links;
  __global const int4* Tetrahedra;
  __global const float4* Nodes;
  __global const RestEntry* Rest;
} Mapping;

// Returns the displacement of a linked vertex.
static float4 FollowLink(const Mapping* m, __global const VertexLink* link)
{
  const int4 t = m->Tetrahedra[link->Tetrahedron];
  const float a = link->Weights[0];
  const float b = link->Weights[1];
  const float c = link->Weights[2];
  const float d = 1.0f - a - b - c;
  return MULTIPLY_ADD(NODE(m->Nodes, t.w), (float4)d,
    MULTIPLY_ADD(NODE(m->Nodes, t.z), (float4)c,
      MULTIPLY_ADD(NODE(m->Nodes, t.y), (float4)b, NODE(m->Nodes, t.x) * a)));
}

static float4 Displacement(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  return FollowLink(m, m->Links + VertexInChunk(x, y, z, p));
}

// Whether the deformation moves a vertex.
static int IsMoved(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  return m->Links[VertexInChunk(x, y, z, p)].Tetrahedron >= 0;
}

#elif MAPPING == MAPPING_RUNS

#define MAPPING_PARAMETERS                                                                         \
  __global const VertexRun *restrict runs, __global const uint *restrict rowRanges,                \
    __global const TetrahedronRecord *restrict records, __global const RestEntry *restrict rest
#define MAPPING_ARGUMENTS { runs, rowRanges, records, rest }

typedef struct
{
  __global const VertexRun* Runs;
  __global const uint* RowRanges;
  __global const TetrahedronRecord* Records;
  __global const RestEntry* Rest;
} Mapping;

// Returns the indices of the first run of a row, and one past the last.
static uint2 RangeOf(const Mapping* m, int y, int z, const KernelParameters* p)
{
  return vload2((size_t)(z - p->ChunkFirst) * p->Size[1] + y, m->RowRanges);
}

// Returns the run that contains a vertex.
static VertexRun RunOf(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const uint2 range = RangeOf(m, y, z, p);
  return m->Runs[FindRun(m->Runs, range.x, range.y, x)];
}

static float4 Displacement(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const VertexRun run = RunOf(m, x, y, z, p);
  const RunDisplacement displacement = MakeRunDisplacement(m->Records + run.Tetrahedron, y, z);
  return GetDisplacement(&displacement, x);
}

// Whether the deformation moves a vertex.
static int IsMoved(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  return RunOf(m, x, y, z, p).Tetrahedron >= 0;
}

#elif MAPPING == MAPPING_FIELD_IN_PLACE

#define MAPPING_PARAMETERS                                                                         \
  __global const float *restrict vectors, const FieldParameters field,                             \
    __global const RestEntry *restrict rest
#define MAPPING_ARGUMENTS { vectors, field, rest }

typedef struct
{
  __global const float* Vectors;
  FieldParameters Field;
  __global const RestEntry* Rest;
} Mapping;

static size_t PointOf(const FieldParameters* field, int x, int y, int z)
{
  const size_t width = field->Dimensions[0];
  const size_t plane = width * field->Dimensions[1];
  return (z + field->Offset[2]) * plane + (y + field->Offset[1]) * width + x + field->Offset[0];
}

static double MatrixElement(const FieldParameters* field, int i)
{
  return as_double(
    (ulong)field->ToDisplacement[2 * i] | (ulong)field->ToDisplacement[2 * i + 1] << 32);
}

// The product of a row of the matrix with vectors, with additions in this order. The products are exact (GetFactor() in
// DisplacementField.h).
#define ROW_PRODUCT(field, row, FLOATS, DOUBLES, x, y, z)                                          \
  convert_##FLOATS(MatrixElement(field, 3 * (row)) * convert_##DOUBLES(x) +                        \
    MatrixElement(field, 3 * (row) + 1) * convert_##DOUBLES(y) +                                   \
    MatrixElement(field, 3 * (row) + 2) * convert_##DOUBLES(z))

static float4 Displacement(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const FieldParameters* field = &m->Field;
  const float3 v = vload3(PointOf(field, x, y, z), m->Vectors);
  if (!field->IsMapped)
  {
    return (float4)(v, 0.0f);
  }
  return (float4)(ROW_PRODUCT(field, 0, float, double, v.x, v.y, v.z),
    ROW_PRODUCT(field, 1, float, double, v.x, v.y, v.z),
    ROW_PRODUCT(field, 2, float, double, v.x, v.y, v.z), 0.0f);
}

static int IsMoved(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  return 1;
}

#else

#define MAPPING_PARAMETERS                                                                         \
  __global const float4 *restrict vectors, const FieldParameters field,                            \
    __global const RestEntry *restrict rest
#define MAPPING_ARGUMENTS { vectors, field, rest }

typedef struct
{
  __global const float4* Vectors;
  FieldParameters Field;
  __global const RestEntry* Rest;
} Mapping;

static float4 Displacement(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const FieldParameters* field = &m->Field;
  const size_t width = field->Dimensions[0];
  const size_t plane = width * field->Dimensions[1];
  if (field->SameGrid)
  {
    return m->Vectors[(z + field->Offset[2]) * plane + (y + field->Offset[1]) * width + x +
      field->Offset[0]];
  }
  const int3 last =
    (int3)(field->Dimensions[0], field->Dimensions[1], field->Dimensions[2]) - 1;
  const float3 position = FieldIndex(field, (int3)(x, y, z));
  const float3 f = clamp(position, 0.0f, convert_float3(last));
  const float4 displacement = InterpolatePoints(m->Vectors, width, plane, f, last);
  if (field->Fading[0] > 0.0f)
  {
    const float3 fading = (float3)(field->Fading[0], field->Fading[1], field->Fading[2]);
    return displacement * WeightBeyond(fmax(fabs(position - f) - FIELD_TOLERANCE, 0.0f) * fading);
  }
  return displacement;
}

static int IsMoved(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const FieldParameters* field = &m->Field;
  const float3 f = FieldIndex(field, (int3)(x, y, z));
  return field->Extrapolate ||
    (f.x >= -FIELD_TOLERANCE && f.y >= -FIELD_TOLERANCE && f.z >= -FIELD_TOLERANCE &&
      f.x <= field->Dimensions[0] - 1 + FIELD_TOLERANCE &&
      f.y <= field->Dimensions[1] - 1 + FIELD_TOLERANCE &&
      f.z <= field->Dimensions[2] - 1 + FIELD_TOLERANCE);
}

#endif

// The undeformed position of a vertex in 1/256 output voxel: whole numbers plus fractions.
typedef struct
{
  int4 Whole;
  float4 Fraction;
} Rest;

static Rest RestOf(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const RestEntry rx = m->Rest[x];
  const RestEntry ry = m->Rest[p->Size[0] + y];
  const RestEntry rz = m->Rest[p->Size[0] + p->Size[1] + z];
#if HAS_TURNED_AXES
#define SUM_OF_REST(part, axis) (rx.part[axis] + (ry.part[axis] + rz.part[axis]))
  const Rest rest = { (int4)(SUM_OF_REST(Whole, 0), SUM_OF_REST(Whole, 1), SUM_OF_REST(Whole, 2), 0),
    (float4)(SUM_OF_REST(Fraction, 0), SUM_OF_REST(Fraction, 1), SUM_OF_REST(Fraction, 2), 0.0f) };
#else
  const Rest rest = { (int4)(rx.Whole, ry.Whole, rz.Whole, 0),
    (float4)(rx.Fraction, ry.Fraction, rz.Fraction, 0.0f) };
#endif
  return rest;
}

// Returns the position of a vertex, in 1/256 output voxel. The vertex must be a source.
static int4 PositionOf(const Mapping* m, int x, int y, int z, const KernelParameters* p)
{
  const Rest rest = RestOf(m, x, y, z, p);
  // The product with 256 is exact.
  const float4 steps =
    RoundSteps_float4(Displacement(m, x, y, z, p) * 256.0f + rest.Fraction, 1.0f);
  return rest.Whole + convert_int4(steps);
}
