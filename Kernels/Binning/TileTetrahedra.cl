// SPDX-License-Identifier: BSD-3-Clause
// A tetrahedron of the deformation mesh in a tile of the output: its edge functions, which are integers in
// (1/256 voxel)^3, zero on a face and positive inside.
//
// What the host puts in front of this text, which comes after TetrahedronBinning.cl:
//   SETUP_IS_SHARED  1 where the items of a group set tetrahedra up for each other, else 0

// Where tetrahedra lie that are set up: in memory of the group, or of a work-item that has a thread for itself.
#if SETUP_IS_SHARED
#define OF_GROUP __local
#else
#define OF_GROUP __private
#endif

// A tetrahedron in a tile.
typedef struct
{
  VoxelBox Box;       // the voxels of the tile that may lie in it
  long Start[4];      // edge function opposite node k at the lowest voxel of the box
  Vector Steps[4];    // and its steps from voxel to voxel
  float Inverse[4];   // of the step along a row, made positive
  int AcceptsTie[4];  // whether a voxel on the face stays inside after a shift by (e, e^2, e^3)
  REAL InverseVolume;
} TileTetrahedron;

static Vector Scaled(Vector v, long factor)
{
  const Vector r = { v.x * factor, v.y * factor, v.z * factor };
  return r;
}

// Returns 0 where the tetrahedron has no voxel in the tile.
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
    // The whole box may lie behind the face.
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
