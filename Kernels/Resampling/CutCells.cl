// SPDX-License-Identifier: BSD-3-Clause
// Cells that a smooth cut divides. A tetrahedron that is crossed, and has vertices on both sides of the sheet, is there
// twice: the copy of a side has the vertices of that side where they are, and the others where they would be if they
// moved with that side (CutPositions.cl). A sample belongs to the copy on whose side its interpolated distance lies.
// Where both copies lie in one place they need not be told apart, and the tetrahedron is as any other.
//
// As seen from one side the sampling mesh is a mesh as any other: of each divided tetrahedron it has the copy of that
// side, and all others as they are. The copies agree on the faces that they share, and with tetrahedra that are not
// divided, since vertices whose two sides such a tetrahedron joins have one place for both. So the fill rule holds as it
// stands, for each side.
//
// Source: Molino, Bao, Fedkiw, "A virtual node algorithm for changing mesh topology during simulation", 2004.

// The sum of the weights of a sample, as edge functions give them, times the distances of a cell's vertices.
static REAL WeighDistances(const float* distances, int t, const long* weights)
{
  REAL sum = 0;
  for (int k = 0; k < 4; ++k)
  {
    const REAL distance = distances[Tetrahedra[t][k]];
    sum = weights[k] ? MULTIPLY_ADD_REAL((REAL)weights[k], distance, sum) : sum;
  }
  return sum;
}

#if HAS_CUT
// The sides: 0 where the distance is not negative, 1 where it is.
typedef struct
{
  int Divided;  // tetrahedra of a cell that are there twice, in different places, as bits
  int Negative; // vertices of the cell on side 1, as bits; as the rest, only where tetrahedra are divided
  float Distances[8];
  int Places[8]; // of the vertices, in the list of cut vertices
} CellCut;

// What the cut does to some tetrahedra of a cell, given as bits.
static void LoadCut(
  const SamplingMesh* mesh, int x, int y, int z, int tetrahedra, const KernelParameters* p, CellCut* cut)
{
  cut->Divided = 0;
  const int first = FindCutVertex(mesh->Cut.Rows, mesh->Cut.Vertices, x, y, z, p);
  const int crossed = first < 0 ? 0 : tetrahedra & mesh->Cut.Vertices[first].Tetrahedra;
  if (!(crossed & DEFORMVOLUME_ALL_TETRAHEDRA))
  {
    return;
  }
  const int mirror = Mirror(x, y, z, p);
  cut->Negative = 0;
  int open = 0; // vertices that lie elsewhere as seen from the other side
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    // All vertices of a cell with crossed tetrahedra are in the list.
    cut->Places[v] = FindCutVertex(
      mesh->Cut.Rows, mesh->Cut.Vertices, x + (o & 1), y + (o >> 2), z + (o >> 1 & 1), p);
    cut->Distances[v] = mesh->Cut.Vertices[cut->Places[v]].Distance;
    cut->Negative |= (cut->Distances[v] < 0.0f) << v;
    open |= (mesh->Cut.Positions[cut->Places[v]].w != 0) << v;
  }
  for (int t = 0; t < 5; ++t)
  {
    const int needed = VerticesOf(t);
    const int negative = needed & cut->Negative;
    cut->Divided |= ((crossed >> t & 1) && negative && negative != needed && (needed & open)) << t;
  }
}

// Where a vertex of a divided tetrahedron is as seen from a side. own: where it is.
static Vector ViewVertex(const SamplingMesh* mesh, const CellCut* cut, int v, int side, Vector own)
{
  if ((cut->Negative >> v & 1) == side)
  {
    return own;
  }
  const int4 q = mesh->Cut.Positions[cut->Places[v]];
  const Vector other = { q.x, q.y, q.z };
  return other;
}

// The side that a sample of a tetrahedron, divided or not, is on. Any where no divided tetrahedron shares the simplex that
// it lies in.
static int SideOfSample(const SamplingMesh* mesh, int x, int y, int z, int t, const long* weights,
  const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  float distances[8];
  for (int k = 0; k < 4; ++k)
  {
    const int v = Tetrahedra[t][k];
    const int o = v ^ mirror;
    const int place = weights[k]
      ? FindCutVertex(mesh->Cut.Rows, mesh->Cut.Vertices, x + (o & 1), y + (o >> 2), z + (o >> 1 & 1), p)
      : -1;
    if (weights[k] && place < 0)
    {
      return 0;
    }
    distances[v] = weights[k] ? mesh->Cut.Vertices[place].Distance : 0.0f;
  }
  return WeighDistances(distances, t, weights) < 0;
}

// Moves the vertices of a tetrahedron to where they are as seen from a side. Returns whether all have a place.
static int ViewTetrahedron(const SamplingMesh* mesh, const CellCut* cut, int t, int side, Vector* vertices)
{
  int placed = 1;
  for (int k = 0; k < 4 && (cut->Divided >> t & 1); ++k)
  {
    vertices[k] = ViewVertex(mesh, cut, Tetrahedra[t][k], side, vertices[k]);
    placed &= vertices[k].x != INT_MIN;
  }
  return placed;
}
#endif
