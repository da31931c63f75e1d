// SPDX-License-Identifier: BSD-3-Clause
// Cells that a smooth cut divides. A crossed tetrahedron with vertices on both sides of the sheet exists twice, as a
// copy for each side. The copy of a side has the vertices of that side at their positions, and the other vertices
// where they would be if they moved with that side (CutPositions.cl). A sample belongs to the copy on whose side its
// interpolated distance lies. If both copies have the same positions, the tetrahedron is handled like any other.
//
// For each side, the copies of that side and all tetrahedra that are not divided form an ordinary mesh. Copies agree
// on shared faces with each other, and with tetrahedra that are not divided: a vertex whose two sides are joined by
// such a tetrahedron has the same position for both sides. So the fill rule holds unchanged on each side.
//
// Source: Molino, Bao, Fedkiw, "A virtual node algorithm for changing mesh topology during simulation", 2004.

// Returns the sum of the weights of a sample, from edge functions, times the distances of a cell's vertices.
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
// Sides: 0 if the distance is not negative, 1 if it is.
typedef struct
{
  int Divided;  // bits of the tetrahedra whose two copies have different positions
  int Negative; // bits of the vertices on side 1; like all below, only set if Divided is not 0
  float Distances[8];
  int Indices[8]; // indices of the vertices in the list of cut vertices
} CellCut;

// Loads the cut data of some tetrahedra of a cell, given as bits.
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
  int open = 0; // bits of vertices with different positions for the two sides
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    // The list has all vertices of a cell with crossed tetrahedra.
    cut->Indices[v] = FindCutVertex(
      mesh->Cut.Rows, mesh->Cut.Vertices, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p);
    cut->Distances[v] = mesh->Cut.Vertices[cut->Indices[v]].Distance;
    cut->Negative |= (cut->Distances[v] < 0.0f) << v;
    open |= (mesh->Cut.Positions[cut->Indices[v]].w != 0) << v;
  }
  for (int t = 0; t < 5; ++t)
  {
    const int needed = VerticesOf(t);
    const int negative = needed & cut->Negative;
    cut->Divided |= ((crossed >> t & 1) && negative && negative != needed && (needed & open)) << t;
  }
}

// Returns the position of a vertex of a divided tetrahedron in the copy of a side. own: its own position.
static Vector ViewVertex(const SamplingMesh* mesh, const CellCut* cut, int v, int side, Vector own)
{
  if ((cut->Negative >> v & 1) == side)
  {
    return own;
  }
  const int4 q = mesh->Cut.Positions[cut->Indices[v]];
  const Vector other = { q.x, q.y, q.z };
  return other;
}

// Returns the side of a sample of a tetrahedron. The result is arbitrary if no divided tetrahedron shares the simplex
// in which the sample lies.
static int SideOfSample(const SamplingMesh* mesh, int x, int y, int z, int t, const long* weights,
  const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  float distances[8];
  for (int k = 0; k < 4; ++k)
  {
    const int v = Tetrahedra[t][k];
    const int o = v ^ mirror;
    const int index = weights[k]
      ? FindCutVertex(mesh->Cut.Rows, mesh->Cut.Vertices, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p)
      : -1;
    if (weights[k] && index < 0)
    {
      return 0;
    }
    distances[v] = weights[k] ? mesh->Cut.Vertices[index].Distance : 0.0f;
  }
  return WeighDistances(distances, t, weights) < 0;
}

// Replaces the vertices of a tetrahedron by those of the copy of a side. Returns whether all have a position.
static int ViewTetrahedron(const SamplingMesh* mesh, const CellCut* cut, int t, int side, Vector* vertices)
{
  int hasPositions = 1;
  for (int k = 0; k < 4 && (cut->Divided >> t & 1); ++k)
  {
    vertices[k] = ViewVertex(mesh, cut, Tetrahedra[t][k], side, vertices[k]);
    hasPositions &= vertices[k].x != INT_MIN;
  }
  return hasPositions;
}
#endif
