// SPDX-License-Identifier: BSD-3-Clause
// The fill rule: which tetrahedron of the sampling mesh writes a voxel.
//
// Coverage is closed: a voxel is covered when its centre lies in an active tetrahedron or on its
// surface. Where the centre lies on a face, an edge or a vertex that several tetrahedra share,
// exactly one of them writes it:
// - inside the mesh the one that holds the centre after a shift by (e, e^2, e^3) for an
//   infinitesimal e > 0 (the top-left rule of triangle rasterisation in three dimensions);
// - on the border of the volume, where all cells are there, the cell that has the simplex on its low sides,
//   in the order of the voxel grid, or is the last one on an axis; of its tetrahedra the first;
// - on the border of the mesh elsewhere, where any may be missing, the one that holds the centre after
//   a shift by (+-e, +-e^2, +-e^3), whichever of the signs +++, -++, +-+, --+, ++-, ... comes first; if no
//   shift leads into the mesh, the last one in the order of cells and tetrahedra.
// Which of the three holds depends only on the simplex whose interior the centre lies in, so that
// all tetrahedra round it decide alike.
//
// Where the mesh folds over, several may write a voxel, and at the crease none. Further passes then
// take every tetrahedron that holds the centre of such a voxel, and the winner's key decides.
//
// What the host puts in front of this text:
//   OUTLINED  of large functions: nothing, or the attribute that keeps them from being inlined, where compilers that
//             inline all take many seconds
//
// All arithmetic is exact: positions are integers in 1/256 voxel, and for a tetrahedron of e
// voxels the edge functions are at most 2 (256 e)^3, which fits 64 bits up to 6,500 voxels.

#pragma OPENCL FP_CONTRACT OFF

#define MAXIMUM_STRETCH (4000 * 256)

// Six times the signed volume.
static long Determinant(Vector a, Vector b, Vector c, Vector d)
{
  return Dot(Subtract(b, a), Cross(Subtract(c, a), Subtract(d, a)));
}

static Vector Minimum(Vector a, Vector b)
{
  const Vector r = { min(a.x, b.x), min(a.y, b.y), min(a.z, b.z) };
  return r;
}

static Vector Maximum(Vector a, Vector b)
{
  const Vector r = { max(a.x, b.x), max(a.y, b.y), max(a.z, b.z) };
  return r;
}

// Tetrahedra that the edge functions do not hold are left out.
static int IsOverstretched(Vector a, Vector b, Vector c, Vector d)
{
  const Vector extent =
    Subtract(Maximum(Maximum(a, b), Maximum(c, d)), Minimum(Minimum(a, b), Minimum(c, d)));
  return max(extent.x, max(extent.y, extent.z)) > MAXIMUM_STRETCH;
}

// A tetrahedron ready to be evaluated: the edge function of the face opposite vertex k is
// Normals[k] . (sample - Origin), plus Volume for k = 0. It is positive inside, and the four add up
// to Volume, so that they are the barycentric weights times Volume.
typedef struct
{
  Vector Origin;
  Vector Normals[4];
  long Volume;
} EdgeFunctions;

static OUTLINED EdgeFunctions MakeEdgeFunctions(Vector a, Vector b, Vector c, Vector d)
{
  EdgeFunctions f;
  f.Origin = a;
  f.Volume =
    FindFaceNormals(Subtract(b, a), Subtract(c, a), Subtract(d, a), f.Normals + 1, f.Normals);
  return f;
}

static void Evaluate(const EdgeFunctions* f, Vector sample, long* weights)
{
  const Vector r = Subtract(sample, f->Origin);
  weights[1] = Dot(f->Normals[1], r);
  weights[2] = Dot(f->Normals[2], r);
  weights[3] = Dot(f->Normals[3], r);
  weights[0] = f->Volume - weights[1] - weights[2] - weights[3];
}

// The first shift that leads from a simplex into the tetrahedron with these edge functions and
// vertices (a mask over the cell's vertices for each), or 8 where none does.
static int FirstShiftInside(const EdgeFunctions* f, int tetrahedron, int simplex)
{
  for (int signs = 0; signs < 8; ++signs)
  {
    int inside = 1;
    for (int k = 0; k < 4; ++k)
    {
      inside &= (simplex >> Tetrahedra[tetrahedron][k] & 1) || ShiftsInside(f->Normals[k], signs);
    }
    if (inside)
    {
      return signs;
    }
  }
  return 8;
}

// Whether of the tetrahedra that share the simplex with these vertices (a mask over the cell's vertices)
// none comes before this one of the cell by the rule for the border of the mesh. own: the first shift into it. side: of
// a smooth cut, from which they are seen.
static OUTLINED int IsOwnerOnBorder(const SamplingMesh* mesh, int x, int y, int z, int tetrahedron,
  int simplex, int own, int side, const KernelParameters* p)
{
  if (own == 0)
  {
    return 1; // another one with that shift overlaps this one
  }
  // The simplex in the voxel grid: does it reach the low and the high side of the cell on each axis?
  const int mirror = Mirror(x, y, z, p);
  int low = 0;
  int high = 0;
  for (int v = 0; v < 8; ++v)
  {
    if (simplex >> v & 1)
    {
      high |= v ^ mirror;
      low |= ~(v ^ mirror) & 7;
    }
  }
  // Inside the mesh the shift +++ leads to the high sides more often than not: what they have is found first.
  for (int dz = 1; dz >= -1; --dz)
  {
    for (int dy = 1; dy >= -1; --dy)
    {
      for (int dx = 1; dx >= -1; --dx)
      {
        // A neighbour on the low side shares the simplex only if that does not reach the high side.
        const int needsLow = (dx < 0) | (dz < 0) << 1 | (dy < 0) << 2;
        const int needsHigh = (dx > 0) | (dz > 0) << 1 | (dy > 0) << 2;
        const int nx = x + dx;
        const int ny = y + dy;
        const int nz = z + dz;
        if ((high & needsLow) || (low & needsHigh) || nx < 0 || ny < 0 || nz < 0 ||
          nx >= p->Size[0] - 1 || ny >= p->Size[1] - 1 || nz >= p->Size[2] - 1)
        {
          continue;
        }
        const int active = ActiveTetrahedra(mesh, nx, ny, nz, p);
        const int order = (dz * 3 + dy) * 3 + dx; // of the cell, 0 for the tetrahedron's own
        // The simplex in the numbers of the neighbour's vertices: on an axis that leads to the
        // neighbour sides are exchanged, and so is the mirroring, hence numbers do not change.
        Vector q[8];
#if HAS_CUT
        CellCut cut;
#endif
        int present = -1;
        for (int t = 0; t < 5; ++t)
        {
          if (order == 0 && t == tetrahedron)
          {
            continue;
          }
          const int later = order > 0 || (order == 0 && t > tetrahedron);
          const int needed = VerticesOf(t);
          if (!(active >> t & 1) || (simplex & needed) != simplex)
          {
            continue;
          }
          if (present < 0)
          {
            present = LoadCell(mesh, nx, ny, nz, p, q);
#if HAS_CUT
            LoadCut(mesh, nx, ny, nz, active, p, &cut);
#endif
          }
          Vector v[4] = { q[Tetrahedra[t][0]],
            q[Tetrahedra[t][1]], q[Tetrahedra[t][2]], q[Tetrahedra[t][3]] };
          int placed = (present & needed) == needed;
#if HAS_CUT
          placed = placed && ViewTetrahedron(mesh, &cut, t, side, v);
#endif
          if (!placed || IsOverstretched(v[0], v[1], v[2], v[3]))
          {
            continue;
          }
          const EdgeFunctions other = MakeEdgeFunctions(v[0], v[1], v[2], v[3]);
          const int shift = FirstShiftInside(&other, t, simplex);
          if (other.Volume != 0 && (shift < own || (shift == own && later)))
          {
            return 0;
          }
        }
      }
    }
  }
  return 1;
}

// The state of a cell's vertices, as masks.
typedef struct
{
  int Interior;
  int Regular; // all that surrounds these is there, but for what would lie beyond the volume
} CellState;

static OUTLINED CellState CellStateOf(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  CellState cell = { 0, 0 };
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const int state = StateOf(mesh->State, x + (o & 1), y + (o >> 2), z + (o >> 1 & 1), p);
    cell.Interior |= (state & DEFORMVOLUME_VERTEX_INTERIOR) ? 1 << v : 0;
    cell.Regular |= (state & DEFORMVOLUME_VERTEX_REGULAR) ? 1 << v : 0;
  }
  return cell;
}

// The vertices on the low side of a cell on the axis of a bit of vertex numbers.
#define LOW_SIDE(axis, mirror) (LOW_VERTICES(axis) ^ ((mirror) >> (axis)&1 ? 255 : 0))
#define LOW_VERTICES(axis) ((axis) == 0 ? 0x55 : (axis) == 1 ? 0x33 : 0x0f)

// Whether a tetrahedron of a cell owns a simplex on the border of the volume, where all cells are there.
static int IsOwnerByIndex(
  int x, int y, int z, int tetrahedron, int simplex, const KernelParameters* p)
{
  for (int before = 0; before < tetrahedron; ++before)
  {
    if ((simplex & VerticesOf(before)) == simplex)
    {
      return 0;
    }
  }
  const int mirror = Mirror(x, y, z, p);
  return ((simplex & LOW_SIDE(0, mirror)) || x == p->Size[0] - 2) &&
    ((simplex & LOW_SIDE(1, mirror)) || z == p->Size[2] - 2) &&
    ((simplex & LOW_SIDE(2, mirror)) || y == p->Size[1] - 2);
}

// What a tetrahedron is to a sample.
#define STRANGER 0 // does not hold it
#define HOLDER 1   // holds it on its surface, and leaves it to another one
#define OWNER 2    // writes it

// What a tetrahedron of a cell is to the sample with these weights.
static OUTLINED int RoleOf(const SamplingMesh* mesh, int x, int y, int z, int tetrahedron, const long* weights,
  const EdgeFunctions* f, CellState state, const KernelParameters* p)
{
  int simplex = 0;
  int inside = 1;
  for (int k = 0; k < 4; ++k)
  {
    if (weights[k] < 0)
    {
      return STRANGER;
    }
    if (weights[k] > 0)
    {
      simplex |= 1 << Tetrahedra[tetrahedron][k];
    }
    else
    {
      inside &= ShiftsInside(f->Normals[k], 0);
    }
  }
  if (DEFORMVOLUME_IS_CLOSED(p->Pass))
  {
    return OWNER; // the winner is chosen by its key
  }
  if ((weights[0] && weights[1] && weights[2] && weights[3]) || (simplex & state.Interior))
  {
    return inside ? OWNER : HOLDER;
  }
#if HAS_CUT
  const int side = SideOfSample(mesh, x, y, z, tetrahedron, weights, p);
#else
  const int side = 0;
#endif
  const int owner = (simplex & state.Regular) == simplex
    ? IsOwnerByIndex(x, y, z, tetrahedron, simplex, p)
    : IsOwnerOnBorder(mesh, x, y, z, tetrahedron, simplex,
        FirstShiftInside(f, tetrahedron, simplex), side, p);
  return owner ? OWNER : HOLDER;
}
