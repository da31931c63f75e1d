// SPDX-License-Identifier: BSD-3-Clause
// Deformation mapping where the static mapping is by runs: voxels of a row, along x, that lie in one
// tetrahedron of the deformation mesh. Comes after DeformationMapping.cl.
//
// The displacement is affine in the index of the voxel within a tetrahedron. So a run needs no
// weights: for each Deform the affine function of each tetrahedron is put into a record of 64 bytes
// (TetrahedronRecord), and a voxel costs three products and three sums an axis.
//
// Data: runs 8 bytes each; rowBegins 4 bytes a row of vertices (row = plane * Size[1] + y, counted
// from the chunk's first plane), one more than rows: the runs of row r are rowBegins[r] to
// rowBegins[r + 1]; the first begins at 0, and each ends where the next begins. rest: for each
// record 15 reals, the origin, the weights of the first three nodes there, and the gradient of each
// of these weights, an index a unit. owners: the tetrahedron of each record.
//
// REAL is double where the device has it: the gradients of a thin tetrahedron are large, and only
// their sum with the displacements is small again.

#pragma OPENCL FP_CONTRACT OFF

typedef struct
{
  int Tetrahedron; // a record, or -1 outside the deformation mesh
  int Begin;       // local x
} VertexRun;

// A work-item takes a record.
__kernel void EvaluateTetrahedra(__global const REAL* restrict rest,
  __global const int* restrict owners, __global const int4* restrict tetrahedra,
  __global const float4* restrict nodes, __global TetrahedronRecord* restrict records,
  const uint count)
{
  const size_t id = get_global_id(0);
  if (id >= count)
  {
    return;
  }
  __global const REAL* origin = rest + 15 * id;
  __global const REAL* weights = origin + 3;
  __global const REAL* gradients = origin + 6;
  const int4 t = tetrahedra[owners[id]];
  __global const float* a = (__global const float*)(nodes + t.x);
  __global const float* b = (__global const float*)(nodes + t.y);
  __global const float* c = (__global const float*)(nodes + t.z);
  __global const float* d = (__global const float*)(nodes + t.w);
  __global TetrahedronRecord* record = records + id;
  for (int axis = 0; axis < 3; ++axis)
  {
    // Differences to the last node: where all nodes move alike, so does each voxel, exactly.
    const REAL last = d[axis];
    const REAL u = a[axis] - last;
    const REAL v = b[axis] - last;
    const REAL w = c[axis] - last;
    record->Displacement[axis] = (float)(last + (weights[0] * u + weights[1] * v + weights[2] * w));
    record->AlongX[axis] = (float)(gradients[0] * u + gradients[3] * v + gradients[6] * w);
    record->AlongY[axis] = (float)(gradients[1] * u + gradients[4] * v + gradients[7] * w);
    record->AlongZ[axis] = (float)(gradients[2] * u + gradients[5] * v + gradients[8] * w);
    record->Origin[axis] = (float)origin[axis];
  }
  record->Padding = 0.0f;
}

// The displacement of the voxels with one y and z in the tetrahedron of a record, but for x.
typedef struct
{
  float4 Displacement; // at the origin
  float4 AlongX;
  float4 Across; // what y and z add
  float OriginX;
} RunDisplacement;

static RunDisplacement MakeRunDisplacement(__global const TetrahedronRecord* record, int y, int z)
{
  RunDisplacement run;
  run.Displacement = (float4)(vload3(0, record->Displacement), 0.0f);
  run.AlongX = (float4)(vload3(0, record->AlongX), 0.0f);
  run.Across = (float4)(vload3(0, record->AlongY), 0.0f) * ((float)y - record->Origin[1]) +
    (float4)(vload3(0, record->AlongZ), 0.0f) * ((float)z - record->Origin[2]);
  run.OriginX = record->Origin[0];
  return run;
}

// What is small is added first: the error bound in VertexRuns.h wants this order.
static float4 GetDisplacement(const RunDisplacement* run, int x)
{
  return run->Displacement + (run->Across + run->AlongX * ((float)x - run->OriginX));
}

// The run that holds x, of those from first to before end.
static uint FindRun(__global const VertexRun* runs, uint first, uint end, int x)
{
  while (end - first > 1)
  {
    const uint middle = first + (end - first) / 2;
    if (runs[middle].Begin <= x)
    {
      first = middle;
    }
    else
    {
      end = middle;
    }
  }
  return first;
}

// As MapByMesh, with the same positions but for rounding.
__kernel void MapByRuns(__global const VertexRun* restrict runs,
  __global const uint* restrict rowBegins, __global const uchar* restrict state,
  __global const TetrahedronRecord* restrict records, __global const RestPosition* restrict rest,
  __global int* restrict positions, const KernelParameters p)
{
  int3 v = FirstVertex(&p);
  const Row row = MakeRow(rest, positions, v, &p);
  const size_t first = VertexIndex((int3)(0, v.y, v.z), p.ChunkFirst, &p);
  const size_t rowIndex = (size_t)(v.z - p.ChunkFirst) * p.Size[1] + v.y;
  const uint end = rowBegins[rowIndex + 1];
  uint run = rowBegins[rowIndex];
  if (v.x < p.Size[0])
  {
    run = FindRun(runs, run, end, v.x);
  }
  int evaluated = -1;
  RunDisplacement displacement;
  for (; v.x < p.Size[0]; v.x += get_global_size(0))
  {
    while (run + 1 < end && runs[run + 1].Begin <= v.x)
    {
      ++run;
    }
    // Sources are marked only where a run has a tetrahedron.
    if (!(state[first + v.x] & DEFORMVOLUME_VERTEX_SOURCE))
    {
      StoreNoPosition(&row, v.x);
      continue;
    }
    if (runs[run].Tetrahedron != evaluated)
    {
      evaluated = runs[run].Tetrahedron;
      displacement = MakeRunDisplacement(records + evaluated, v.y, v.z);
    }
    StorePosition(&row, v.x, GetDisplacement(&displacement, v.x));
  }
}

// As MarkSourcesByMesh.
__kernel void MarkSourcesByRuns(__global const VertexRun* runs, __global const uchar* blanked,
  const int hasBlanked, __global uchar* sources, const KernelParameters p,
  __global const uint* rowBegins)
{
  int3 v = FirstVertex(&p);
  const size_t rowIndex = (size_t)(v.z - p.ChunkFirst) * p.Size[1] + v.y;
  const uint end = rowBegins[rowIndex + 1];
  uint run = rowBegins[rowIndex];
  if (v.x < p.Size[0])
  {
    run = FindRun(runs, run, end, v.x);
  }
  for (; v.x < p.Size[0]; v.x += get_global_size(0))
  {
    while (run + 1 < end && runs[run + 1].Begin <= v.x)
    {
      ++run;
    }
    const int source = runs[run].Tetrahedron >= 0 &&
      !(hasBlanked && blanked[VertexIndex(v, p.ChunkFirst, &p)]);
    sources[VertexIndex(v, p.SlabFirst, &p)] = source ? DEFORMVOLUME_VERTEX_SOURCE : 0;
  }
}
