// SPDX-License-Identifier: BSD-3-Clause
// A tetrahedron of the deformation mesh in a tile of the output. Its edge functions are integers in (1/256 voxel)^3,
// 0 on a face and positive inside.
//
// The host defines before this text, which comes after TetrahedronBinning.cl:
//   SETUP_IS_SHARED  1 if the work-items of a work-group set up tetrahedra for each other, else 0

// The address space of tetrahedra that are set up: local memory if they are shared, otherwise private memory.
#if SETUP_IS_SHARED
#define OF_GROUP __local
#else
#define OF_GROUP __private
#endif

typedef struct
{
  VoxelBox Box;       // the voxels of the tile that may lie in it
  long Start[4];      // edge function of the face opposite node k, at the lowest voxel of the box
  Vector Steps[4];    // its change to the next voxel on x, y and z
  float Inverse[4];   // 1 / absolute value of the change along x
  int AcceptsTie[4];  // whether a voxel on the face stays inside after a shift by (e, e^2, e^3)
  REAL InverseVolume;
} TileTetrahedron;

static Vector Scaled(Vector v, long factor)
{
  const Vector r = { v.x * factor, v.y * factor, v.z * factor };
  return r;
}

// Sets up a tetrahedron. Returns 0 if it has no voxel in the tile.
static int SetUpTetrahedron(int4 nodes, __global const int4* positions, VoxelBox tile,
  OF_GROUP TileTetrahedron* t, const RasterParameters* p)
{
  const int4 a = positions[nodes.x];
  const int4 b = positions[nodes.y];
  const int4 c = positions[nodes.z];
  const int4 d = positions[nodes.w];
  t->Box = FindVoxels(min(min(a, b), min(c, d)), max(max(a, b), max(c, d)), p);
  t->Box.Low = max(t->Box.Low, tile.Low);
  t->Box.High = min(t->Box.High, tile.High);
  if (IsEmpty(t->Box))
  {
    return 0;
  }
  Vector normals[4];
  const long volume =
    FindFaceNormals(Difference(a, d), Difference(b, d), Difference(c, d), normals, normals + 3);
  const Vector r = Difference(t->Box.Low * 256, d);
  t->Start[3] = volume;
  for (int k = 0; k < 3; ++k)
  {
    t->Start[k] = Dot(normals[k], r);
    t->Start[3] -= t->Start[k];
  }
  const int4 size = t->Box.High - t->Box.Low;
  for (int k = 0; k < 4; ++k)
  {
    const Vector step = Scaled(normals[k], 256);
    t->Steps[k] = step;
    // Quick test: the whole box may lie behind one face.
    if (t->Start[k] + max(0L, step.x * size.x) + max(0L, step.y * size.y) +
        max(0L, step.z * size.z) <
      0)
    {
      return 0;
    }
    t->Inverse[k] = step.x != 0 ? 1.0f / fabs((float)step.x) : 0.0f;
    t->AcceptsTie[k] = ShiftsInside(normals[k], 0);
  }
  t->InverseVolume = (REAL)1 / (REAL)volume;
  return 1;
}
