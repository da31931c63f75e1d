// SPDX-License-Identifier: BSD-3-Clause
// The displacement of vertices where the static mapping is by runs: voxels of a row, along x, that lie
// in one tetrahedron of the deformation mesh. Comes before DeformationMapping.cl.
//
// The displacement is affine in the index of the voxel within a tetrahedron. So a run needs no
// weights: for each Deform the affine function of each tetrahedron is put into a record of 64 bytes
// (TetrahedronRecord, RunEvaluation.cl), and a voxel costs three products and three sums an axis.
//
// Data: runs 8 bytes each; rowRanges 8 bytes a row of vertices (row = plane * Size[1] + y, counted
// from the chunk's first plane): the first of its runs, and one past its last; the first begins at 0,
// and each ends where the next begins.

#pragma OPENCL FP_CONTRACT OFF

typedef struct
{
  int Tetrahedron; // a record, or -1 outside the deformation mesh
  int Begin;       // local x
} VertexRun;

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
  // The fourth component is whatever follows in the record.
  RunDisplacement run;
  run.Displacement = vload4(0, record->Displacement);
  run.AlongX = vload4(0, record->AlongX);
  run.Across =
    MULTIPLY_ADD(vload4(0, record->AlongY), (float4)((float)y - record->Origin[1]),
      vload4(0, record->AlongZ) * ((float)z - record->Origin[2]));
  run.OriginX = record->Origin[0];
  return run;
}

// What is small is added first: the error bound in VertexRuns.h wants this order.
static float4 GetDisplacement(const RunDisplacement* run, int x)
{
  return run->Displacement +
    MULTIPLY_ADD(run->AlongX, (float4)((float)x - run->OriginX), run->Across);
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
