// SPDX-License-Identifier: BSD-3-Clause
// Evaluates the records of tetrahedra that RunMapping.cl reads.
//
// Data:
//   rest        DEFORMVOLUME_REST_NUMBERS reals per record: origin, weights of the first three nodes at the origin, and
//               gradients of these weights per voxel
//   owners      tetrahedron of each record
//   tetrahedra  nodes of the tetrahedra, times DEFORMVOLUME_NODE_STRIDE
//
// REAL is double if the device supports it, since the gradients of a thin tetrahedron are large and cancel when they
// are multiplied by displacements and added.

#pragma OPENCL FP_CONTRACT OFF

// A work-item processes one record.
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
  __global const REAL* origin = rest + DEFORMVOLUME_REST_NUMBERS * id;
  __global const REAL* weights = origin + 3;
  __global const REAL* gradients = origin + 6;
  const int4 t = tetrahedra[owners[id]];
  __global const float* a = (__global const float*)&NODE(nodes, t.x);
  __global const float* b = (__global const float*)&NODE(nodes, t.y);
  __global const float* c = (__global const float*)&NODE(nodes, t.z);
  __global const float* d = (__global const float*)&NODE(nodes, t.w);
  __global TetrahedronRecord* record = records + id;
  for (int axis = 0; axis < 3; ++axis)
  {
    // With differences to the last node, the displacement of each voxel is exact if all nodes have the same
    // displacement.
    const REAL last = d[axis];
    const REAL u = a[axis] - last;
    const REAL v = b[axis] - last;
    const REAL w = c[axis] - last;
#define SUM(factors, first, step)                                                                  \
  MULTIPLY_ADD_REAL(factors[first + 2 * (step)], w,                                                \
    MULTIPLY_ADD_REAL(factors[first + (step)], v, factors[first] * u))
    record->Displacement[axis] = (float)(last + SUM(weights, 0, 1));
    record->AlongX[axis] = (float)SUM(gradients, 0, 3);
    record->AlongY[axis] = (float)SUM(gradients, 1, 3);
    record->AlongZ[axis] = (float)SUM(gradients, 2, 3);
    record->Origin[axis] = (float)origin[axis];
  }
  record->Padding = 0.0f;
}
