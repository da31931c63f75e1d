// SPDX-License-Identifier: BSD-3-Clause
// Interpolates values at samples of packets of cells (PacketVertices.cl).
//
// The host defines before this text:
//   STORE_OTHER_ARRAYS   statements that store the arrays that are not LANE_ARRAYS at a sample
//   HAS_OTHER_ARRAYS     1 if there are such arrays, else 0

#define LANE_RANGE_LOW_char -128.0f
#define LANE_RANGE_HIGH_char 127.0f
#define LANE_RANGE_LOW_uchar 0.0f
#define LANE_RANGE_HIGH_uchar 255.0f
#define LANE_RANGE_LOW_short -32768.0f
#define LANE_RANGE_HIGH_short 32767.0f
#define LANE_RANGE_LOW_ushort 0.0f
#define LANE_RANGE_HIGH_ushort 65535.0f
#define LANE_RANGE_LOW_float 0.0f
#define LANE_RANGE_HIGH_float 0.0f
#define LANE_CONVERT_32(TYPE, bits) as_float(bits)
#define LANE_CONVERT_16(TYPE, bits) ((TYPE)(bits))
#define LANE_CONVERT_8(TYPE, bits) ((TYPE)(bits))

#if HAS_OTHER_ARRAYS
// Finds the weights of the origin in a tetrahedron of a cell with these vertices, and their sum, like edge functions.
// Coordinates are whole numbers of 1/256 voxel under 2^14, so all numbers are under 2^47, and exact.
// (MakeEdgeFunctions and Evaluate do the same for larger cells, whose numbers do not fit into a double.)
static __attribute__((always_inline)) void WeighOrigin(
  const EXACT* x, const EXACT* y, const EXACT* z, int t, long* weights, long* volume)
{
  const int a = Tetrahedra[t][0], b = Tetrahedra[t][1], c = Tetrahedra[t][2], d = Tetrahedra[t][3];
  const EXACT ux = x[b] - x[a], uy = y[b] - y[a], uz = z[b] - z[a];
  const EXACT vx = x[c] - x[a], vy = y[c] - y[a], vz = z[c] - z[a];
  const EXACT wx = x[d] - x[a], wy = y[d] - y[a], wz = z[d] - z[a];
  // The normals of the faces opposite b, c and d.
  const EXACT bx = vy * wz - vz * wy, by = vz * wx - vx * wz, bz = vx * wy - vy * wx;
  const EXACT cx = wy * uz - wz * uy, cy = wz * ux - wx * uz, cz = wx * uy - wy * ux;
  const EXACT dx = uy * vz - uz * vy, dy = uz * vx - ux * vz, dz = ux * vy - uy * vx;
  const EXACT sum = ux * bx + uy * by + uz * bz;
  const EXACT sign = sum < 0 ? -1 : 1;
  weights[1] = (long)(-sign * (x[a] * bx + y[a] * by + z[a] * bz));
  weights[2] = (long)(-sign * (x[a] * cx + y[a] * cy + z[a] * cz));
  weights[3] = (long)(-sign * (x[a] * dx + y[a] * dy + z[a] * dz));
  *volume = (long)(sign * sum);
  weights[0] = *volume - weights[1] - weights[2] - weights[3];
}

// Stores a sample of a cell for arrays that need exact weights. The tetrahedron that holds the sample is found again,
// in whole numbers.
static COLD void StoreOtherArrays(
  const Packet* packet, int lane, uint voxel, const KernelParameters* p ARRAY_PARAMETERS)
{
  const uint width = p->OutputSize[0];
  const uint plane = width * p->OutputSize[1];
  const uint sampleZ = voxel / plane;
  const uint inPlane = voxel - sampleZ * plane;
  const uint sampleY = inPlane / width;
  const float sample[3] = { inPlane - sampleY * width, sampleY, sampleZ };
  EXACT x[8], y[8], z[8]; // relative to the sample
#pragma unroll
  for (int v = 0; v < 8; ++v)
  {
    LocalRow vertex = SLOTS_OF(packet, v) + lane;
    x[v] = (EXACT)((vertex[0] - sample[0]) * 256.0f);
    y[v] = (EXACT)((vertex[HALF_ROW] - sample[1]) * 256.0f);
    z[v] = (EXACT)((vertex[2 * HALF_ROW] - sample[2]) * 256.0f);
  }
  long weights[4];
  long volume;
  WeighOrigin(x, y, z, 4, weights, &volume);
  int t = 4;
  for (int k = 0; k < 4; ++k)
  {
    t = weights[k] < 0 ? CornerBehindFace[k] : t;
  }
  if (t != 4)
  {
    WeighOrigin(x, y, z, t, weights, &volume);
  }
  Sample made;
  BeginSamples(&made, packet->X + 2 * lane, packet->Y, packet->Z, t, volume, p);
  SetSample(&made, weights, voxel);
  const Sample* s = &made;
  STORE_OTHER_ARRAYS
}
#endif

// The weights of the vertices of cells at samples (PacketWeights.cl).
typedef struct
{
  FLOATS T0, T3, T5, T6; // of the central tetrahedron, not yet multiplied by Scale
  FLOATS U1, U2, U4, U7; // of the corners
  FLOATS Scale;
} SampleWeights;

// Interpolates the values v of an array. Integers are rounded; LANE_CONVERT takes their bits.
#define INTERPOLATE_LANES(v, TYPE, BITS, SLOT)                                                     \
  FLOATS v;                                                                                        \
  {                                                                                                \
    FLOATS inner = weights->T0 * VERTEX(0, 3 + SLOT);                                              \
    inner = fma(weights->T3, VERTEX(3, 3 + SLOT), inner);                                          \
    inner = fma(weights->T5, VERTEX(5, 3 + SLOT), inner);                                          \
    inner = fma(weights->T6, VERTEX(6, 3 + SLOT), inner);                                          \
    FLOATS outer = weights->U1 * VERTEX(1, 3 + SLOT);                                              \
    outer = fma(weights->U2, VERTEX(2, 3 + SLOT), outer);                                          \
    outer = fma(weights->U4, VERTEX(4, 3 + SLOT), outer);                                          \
    outer = fma(weights->U7, VERTEX(7, 3 + SLOT), outer);                                          \
    v = fma(inner, weights->Scale, outer);                                                         \
    if (BITS != 32)                                                                                \
    {                                                                                              \
      v = Min(Max(v, LANE_RANGE_LOW_##TYPE), LANE_RANGE_HIGH_##TYPE) + ROUND_TO_INTEGER;        \
    }                                                                                              \
  }
