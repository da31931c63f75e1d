// SPDX-License-Identifier: BSD-3-Clause
// The resampling kernel as published: one work-item per cell, five tetrahedra, each tested
// against every voxel of its bounding box in single precision with a tolerance. Several work-items
// may write one voxel, and the last one wins. It is the yardstick of the benchmarks and is kept
// simple on purpose: do not make it faster.
//
// Source: Rodriguez, Leon, Martin, Otaduy, "A parallel resampling method for interactive
// deformation of volumetric models", section on resampling.
//
// Data and what the host puts in front of this text: as in Resampling.cl. The positions are those
// of DeformationMapping.cl.

#define TOLERANCE 1e-5f


typedef struct
{
  size_t Target;
  size_t Sources[4];
  float Weights[4];
} Sample;

#define STORE_LINEAR(SOURCE, TARGET, COMPONENTS, CONVERT)                                          \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    TARGET[s->Target * COMPONENTS + c] =                                                           \
      CONVERT(s->Weights[0] * (float)SOURCE[s->Sources[0] * COMPONENTS + c] +                      \
        s->Weights[1] * (float)SOURCE[s->Sources[1] * COMPONENTS + c] +                            \
        s->Weights[2] * (float)SOURCE[s->Sources[2] * COMPONENTS + c] +                            \
        s->Weights[3] * (float)SOURCE[s->Sources[3] * COMPONENTS + c]);                            \
  }

#define STORE_LINEAR_64(SOURCE, TARGET, COMPONENTS, TYPE, CONVERT)                                 \
  STORE_LINEAR(SOURCE, TARGET, COMPONENTS, CONVERT)

#define STORE_NEAREST(SOURCE, TARGET, COMPONENTS)                                                  \
  {                                                                                                \
    int nearest = 0;                                                                               \
    for (int k = 1; k < 4; ++k)                                                                    \
    {                                                                                              \
      nearest = s->Weights[k] > s->Weights[nearest] ? k : nearest;                                 \
    }                                                                                              \
    for (int c = 0; c < COMPONENTS; ++c)                                                           \
    {                                                                                              \
      TARGET[s->Target * COMPONENTS + c] = SOURCE[s->Sources[nearest] * COMPONENTS + c];           \
    }                                                                                              \
  }

static void StoreArrays(const Sample* s ARRAY_PARAMETERS)
{
  STORE_ARRAYS
}

__kernel void ResamplePublished(__global const int* positions, __global const uchar* active,
  __global char* coverage, const KernelParameters p ARRAY_PARAMETERS)
{
  const int x = get_global_id(0);
  const int y = get_global_id(1);
  const int z = p.LayersBegin + (int)get_global_id(2);
  if (x >= p.Size[0] - 1 || y >= p.Size[1] - 1 || z >= p.LayersEnd)
  {
    return;
  }
  const int mirror = Mirror(x, y, z, &p);
  const size_t row = p.Size[0];
  const size_t plane = row * p.Size[1];
  float3 vertices[8];
  size_t indices[8];
  int present = 0;
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const size_t i = (y + (o >> 2)) * row + x + (o & 1);
    const int dz = o >> 1 & 1;
    __global const int* q = positions + PositionIndex(x + (o & 1), y + (o >> 2), z + dz, &p);
    vertices[v] = (float3)(q[0], q[row], q[2 * row]) * (1.0f / 256.0f) -
      (float3)(p.OutputFirst[0], p.OutputFirst[1], p.OutputFirst[2]);
    present |= (q[0] != INT_MIN) << v;
    indices[v] = (size_t)(z + dz - p.ChunkFirst) * plane + i;
  }
  const int tetrahedra = p.HasActive
    ? active[CellInChunk(x, y, z, &p)]
    : DEFORMVOLUME_ALL_TETRAHEDRA;
  const int3 last = (int3)(p.OutputSize[0], p.OutputSize[1], p.OutputSize[2]) - 1;
  for (int t = 0; t < 5; ++t)
  {
    int needed = 0;
    for (int k = 0; k < 4; ++k)
    {
      needed |= 1 << Tetrahedra[t][k];
    }
    if (!(tetrahedra >> t & 1) || (present & needed) != needed)
    {
      continue;
    }
    const float3 a = vertices[Tetrahedra[t][0]];
    const float3 b = vertices[Tetrahedra[t][1]];
    const float3 c = vertices[Tetrahedra[t][2]];
    const float3 d = vertices[Tetrahedra[t][3]];
    const int3 low = max(convert_int3(ceil(fmin(fmin(a, b), fmin(c, d)))), (int3)(0));
    const int3 high = min(convert_int3(floor(fmax(fmax(a, b), fmax(c, d)))), last);
    const float3 u = b - a;
    const float3 v = c - a;
    const float3 w = d - a;
    float3 nb = cross(v, w);
    const float inverse = 1.0f / dot(u, nb);
    nb *= inverse;
    const float3 nc = cross(w, u) * inverse;
    const float3 nd = cross(u, v) * inverse;
    Sample s;
    for (int k = 0; k < 4; ++k)
    {
      s.Sources[k] = indices[Tetrahedra[t][k]];
    }
    for (int k = low.z; k <= high.z; ++k)
    {
      for (int j = low.y; j <= high.y; ++j)
      {
        for (int i = low.x; i <= high.x; ++i)
        {
          const float3 r = (float3)(i, j, k) - a;
          s.Weights[1] = dot(r, nb);
          s.Weights[2] = dot(r, nc);
          s.Weights[3] = dot(r, nd);
          s.Weights[0] = 1.0f - s.Weights[1] - s.Weights[2] - s.Weights[3];
          if (s.Weights[0] >= -TOLERANCE && s.Weights[1] >= -TOLERANCE &&
            s.Weights[2] >= -TOLERANCE && s.Weights[3] >= -TOLERANCE)
          {
            s.Target = ((size_t)k * p.OutputSize[1] + j) * p.OutputSize[0] + i;
            coverage[s.Target] = 1;
            StoreArrays(&s ARRAY_ARGUMENTS);
          }
        }
      }
    }
  }
}
