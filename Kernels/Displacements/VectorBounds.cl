// SPDX-License-Identifier: BSD-3-Clause
// Bounds of displacements, and of deformed voxels, computed on the device. This text comes after GroupReduction.cl and
// VectorConversion.cl.

#define BOUNDS 6 // the least x, y and z, then the greatest

// Combines two values of a row: rows 0 to 2 are minima, rows 3 to 5 are maxima.
#define JOIN_BOUND(row, a, b) ((row) < 3 ? fmin(a, b) : fmax(a, b))
// Reduces the bounds of the work-items of a group to six numbers. shared: BOUNDS values per work-item. All work-items
// of the group must execute this macro.
#define JOIN_BOUNDS(shared, least, greatest, bounds)                                               \
  {                                                                                                \
    for (int axis = 0; axis < 3; ++axis)                                                           \
    {                                                                                              \
      shared[axis * get_local_size(0) + get_local_id(0)] = least[axis];                            \
      shared[(axis + 3) * get_local_size(0) + get_local_id(0)] = greatest[axis];                   \
    }                                                                                              \
    REDUCE_ROWS(shared, BOUNDS, JOIN_BOUND)                                                        \
    for (int i = get_local_id(0); i < BOUNDS; i += get_local_size(0))                              \
    {                                                                                              \
      bounds[BOUNDS * get_group_id(0) + i] = shared[i * get_local_size(0)];                        \
    }                                                                                              \
  }

// Computes the bounds of finite displacements in boxes of points. A work-group processes one box. boxes: six ints per
// box, as an Extent. width, height: points of the field on x and y.
__kernel void FindBoxBounds(__global const float4* displacements, const int width, const int height,
  __global const int* boxes, __local float* shared, __global float* bounds)
{
  __global const int* box = boxes + 6 * get_group_id(0);
  float least[3] = { INFINITY, INFINITY, INFINITY };
  float greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
  const int sizeX = box[1] - box[0] + 1;
  const int sizeY = box[3] - box[2] + 1;
  const int count = sizeX * sizeY * (box[5] - box[4] + 1);
  for (int i = get_local_id(0); i < count; i += get_local_size(0))
  {
    const size_t z = box[4] + i / (sizeX * sizeY);
    const size_t y = box[2] + i / sizeX % sizeY;
    const float4 moved = displacements[(z * height + y) * width + box[0] + i % sizeX];
    least[0] = fmin(least[0], moved.x);
    least[1] = fmin(least[1], moved.y);
    least[2] = fmin(least[2], moved.z);
    greatest[0] = fmax(greatest[0], moved.x);
    greatest[1] = fmax(greatest[1], moved.y);
    greatest[2] = fmax(greatest[2], moved.z);
  }
  JOIN_BOUNDS(shared, least, greatest, bounds)
}

#if REAL_IS_DOUBLE

// Computes the bounds of deformed voxels. rest: a vector for each index on x, then y, then z; the position of a voxel
// at rest is the sum of the vectors of its three indices. bounds: six numbers per work-group. bad: counts voxels whose
// displacement is not finite or exceeds `largest`. A work-group processes the rows get_group_id(0),
// get_group_id(0) + get_num_groups(0) and so on; its work-items process the voxels of a row in the same way.
__kernel void FindBounds(__global const float* vectors, const FieldParameters field,
  const KernelParameters p, __global const double* rest, const float largest, __local double* shared,
  __global double* bounds, __global uint* bad)
{
  double least[3] = { INFINITY, INFINITY, INFINITY };
  double greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
  const size_t width = field.Dimensions[0];
  const size_t plane = width * field.Dimensions[1];
  const size_t rows = (size_t)p.Size[1] * p.Size[2];
  for (size_t row = get_group_id(0); row < rows; row += get_num_groups(0))
  {
    const int y = (int)(row % p.Size[1]);
    const int z = (int)(row / p.Size[1]);
    const size_t first = (z + field.Offset[2]) * plane + (y + field.Offset[1]) * width + field.Offset[0];
    for (int x = get_local_id(0); x < p.Size[0]; x += get_local_size(0))
    {
      const float3 moved = ConvertVector(vload3(first + x, vectors), &field);
      if (!all(fabs(moved) <= largest))
      {
        atomic_inc(bad);
      }
      const double3 position = vload3(x, rest) + vload3(p.Size[0] + y, rest) +
        vload3(p.Size[0] + p.Size[1] + z, rest) + convert_double3(moved);
      const double positions[3] = { position.x, position.y, position.z };
      for (int axis = 0; axis < 3; ++axis)
      {
        least[axis] = fmin(least[axis], positions[axis]);
        greatest[axis] = fmax(greatest[axis], positions[axis]);
      }
    }
  }
  JOIN_BOUNDS(shared, least, greatest, bounds)
}

#endif
