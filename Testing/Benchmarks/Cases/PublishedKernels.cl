// SPDX-License-Identifier: BSD-3-Clause
// The published method: one work-item for each vertex maps it, and then one work-item for each cell
// tests each of its five tetrahedra against every voxel of its bounding box, in single precision with
// a tolerance. Several work-items may write one voxel, and the last one wins. These kernels are a
// reference for times: do not make them faster.
//
// Source: Rodriguez, Leon, Martin, Otaduy, "A parallel resampling method for interactive
// deformation of volumetric models", sections on deformation mapping and resampling.
//
// The host puts FIVE_TETRAHEDRA (FiveTetrahedra.h) in front of this text. Sizes and indices are in
// the order x, y, z.

#define TOLERANCE 1e-5f

__constant uchar Tetrahedra[5][4] = FIVE_TETRAHEDRA;

// links: as VertexLink. All voxels are inside the mesh.
__kernel void MapVertices(__global const float4* links, __global const int4* tetrahedra,
  __global const float* displacements, __global float* positions, int4 size)
{
  const int x = get_global_id(0);
  const int y = get_global_id(1);
  const int z = get_global_id(2);
  if (x >= size.x)
  {
    return;
  }
  const size_t vertex = ((size_t)z * size.y + y) * size.x + x;
  const float4 link = links[vertex];
  const int4 nodes = tetrahedra[as_int(link.x)];
  const float3 displacement = link.y * vload3(nodes.x, displacements) +
    link.z * vload3(nodes.y, displacements) + link.w * vload3(nodes.z, displacements) +
    (1.0f - link.y - link.z - link.w) * vload3(nodes.w, displacements);
  vstore3((float3)(x, y, z) + displacement, vertex, positions);
}

// first: the structured index of the first output voxel.
__kernel void Resample(__global const float* positions, __global const ushort* volume,
  __global ushort* output, __global uchar* coverage, int4 size, int4 first, int4 outputSize)
{
  const int x = get_global_id(0);
  const int y = get_global_id(1);
  const int z = get_global_id(2);
  if (x >= size.x - 1)
  {
    return;
  }
  const int mirror = (x & 1) | (z & 1) << 1 | (y & 1) << 2;
  float3 vertices[8];
  size_t indices[8];
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    indices[v] = ((size_t)(z + (o >> 1 & 1)) * size.y + y + (o >> 2)) * size.x + x + (o & 1);
    vertices[v] = vload3(indices[v], positions) - convert_float3(first.xyz);
  }
  for (int t = 0; t < 5; ++t)
  {
    const float3 a = vertices[Tetrahedra[t][0]];
    const float3 b = vertices[Tetrahedra[t][1]];
    const float3 c = vertices[Tetrahedra[t][2]];
    const float3 d = vertices[Tetrahedra[t][3]];
    const int3 low = max(convert_int3(ceil(fmin(fmin(a, b), fmin(c, d)))), (int3)(0));
    const int3 high =
      min(convert_int3(floor(fmax(fmax(a, b), fmax(c, d)))), outputSize.xyz - (int3)(1));
    const float3 u = b - a;
    const float3 v = c - a;
    const float3 w = d - a;
    float3 nb = cross(v, w);
    const float inverse = 1.0f / dot(u, nb);
    nb *= inverse;
    const float3 nc = cross(w, u) * inverse;
    const float3 nd = cross(u, v) * inverse;
    for (int k = low.z; k <= high.z; ++k)
    {
      for (int j = low.y; j <= high.y; ++j)
      {
        for (int i = low.x; i <= high.x; ++i)
        {
          const float3 r = (float3)(i, j, k) - a;
          const float wb = dot(r, nb);
          const float wc = dot(r, nc);
          const float wd = dot(r, nd);
          const float wa = 1.0f - wb - wc - wd;
          if (wa >= -TOLERANCE && wb >= -TOLERANCE && wc >= -TOLERANCE && wd >= -TOLERANCE)
          {
            const size_t target = ((size_t)k * outputSize.y + j) * outputSize.x + i;
            coverage[target] = 1;
            output[target] = convert_ushort_sat_rte(wa * volume[indices[Tetrahedra[t][0]]] +
              wb * volume[indices[Tetrahedra[t][1]]] + wc * volume[indices[Tetrahedra[t][2]]] +
              wd * volume[indices[Tetrahedra[t][3]]]);
          }
        }
      }
    }
  }
}
