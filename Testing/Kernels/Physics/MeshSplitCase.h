// SPDX-License-Identifier: BSD-3-Clause
#ifndef MeshSplitCase_h
#define MeshSplitCase_h

#include "ElasticBody.h"
#include "MeshSplit.h"
#include "MeshSplitReference.h"

namespace physicsTesting
{

/// A sheet to cut with.
struct SheetSurface
{
  std::vector<glm::dvec3> Points;
  SheetTriangles Triangles;

  void Add(const SheetSurface& other);
};

/// A parallelogram.
SheetSurface MakeSheet(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v);

///@{
/// Planes across the whole lattice.
SheetSurface MakePlaneX(double x);
SheetSurface MakePlaneY(double y);
///@}

/// A lattice of 8 x 8 x 8 cells with edges of length 1.
deformvolume::ElasticBody MakeLattice();

/// Two tetrahedra that share a face in the plane z = 0.
deformvolume::ElasticBody MakePair();

deformvolume::MeshSplit Split(const deformvolume::ElasticBody& body, const SheetSurface& sheet,
  const std::vector<deformvolume::TetrahedronPair>& unparted = {});

/// Returns the body after a cut. Copies of nodes have the positions of their origins.
deformvolume::ElasticBody Apply(
  deformvolume::ElasticBody body, const deformvolume::MeshSplit& split);

void ExpectSame(const deformvolume::MeshSplit& a, const deformvolume::MeshSplit& b);
void ExpectNothing(const deformvolume::ElasticBody& body, const deformvolume::MeshSplit& split);

/// Expects what is true after every cut, with any sheet.
void ExpectSound(const deformvolume::ElasticBody& body, const deformvolume::MeshSplit& split);

/// Returns the component of each tetrahedron. The tetrahedra of a component are connected by faces.
/// Components may share edges and nodes. They are numbered from 0, in the order of their lowest
/// tetrahedra.
std::vector<std::int32_t> FindFaceComponents(
  const std::vector<deformvolume::Tetrahedron>& tetrahedra);
std::size_t CountComponents(const std::vector<std::int32_t>& components);

/// Expects a number of components that share no nodes. Returns their volumes.
std::vector<double> ExpectPieces(const deformvolume::ElasticBody& body, std::size_t count);

} // namespace physicsTesting

#endif
