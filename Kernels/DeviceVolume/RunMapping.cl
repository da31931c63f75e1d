// SPDX-License-Identifier: BSD-3-Clause
// The displacements of vertices by runs: voxels along x in one tetrahedron of the deformation mesh. This text comes
// before DeformationMapping.cl.
//
// Within a tetrahedron, the displacement is an affine function of the index of the voxel. So a run needs no weights.
// Each Deform() stores the affine function of each tetrahedron in a record of 64 bytes (TetrahedronRecord,
// RunEvaluation.cl). A voxel needs three multiplications and three additions per axis.
//
// Data:
//   runs       8 bytes each. The first run of a row begins at 0; each run ends where the next begins.
//   rowRanges  8 bytes per row of vertices: index of its first run, and one past its last. row = plane * Size[1] + y,
//              counted from the first plane of the chunk.

#pragma OPENCL FP_CONTRACT OFF

typedef struct
{
  int Tetrahedron; // a record, or -1 outside the deformation mesh
  int Begin;       // local x
} VertexRun;

// The displacement of the voxels at one y and z in the tetrahedron of a record, as a function of x.
typedef struct
{
  float4 Displacement; // at the origin
  float4 AlongX;
  float4 Across; // contribution of y and z
  float OriginX;
} RunDisplacement;

static RunDisplacement MakeRunDisplacement(__global const TetrahedronRecord* record, int y, int z)
{
  // The fourth component is undefined: it is read from the next member of the record.
  RunDisplacement run;
  run.Displacement = vload4(0, record->Displacement);
  run.AlongX = vload4(0, record->AlongX);
  run.Across =
    MULTIPLY_ADD(vload4(0, record->AlongY), (float4)((float)y - record->Origin[1]),
      vload4(0, record->AlongZ) * ((float)z - record->Origin[2]));
  run.OriginX = record->Origin[0];
  return run;
}

// Small terms are added first: the error bound in VertexRuns.h depends on this order.
static float4 GetDisplacement(const RunDisplacement* run, int x)
{
  return run->Displacement +
    MULTIPLY_ADD(run->AlongX, (float4)((float)x - run->OriginX), run->Across);
}

// Finds the run that contains x among the runs first to end - 1.
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
