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
/// Across the lattice.
SheetSurface MakePlaneX(double x);
SheetSurface MakePlaneY(double y);
///@}

/// 8^3 cells of length 1.
deformvolume::ElasticBody MakeLattice();

/// Two tetrahedra with a face in common, at z = 0.
deformvolume::ElasticBody MakePair();

deformvolume::MeshSplit Split(const deformvolume::ElasticBody& body, const SheetSurface& sheet,
  const std::vector<deformvolume::TetrahedronPair>& unparted = {});

/// The body after a cut: copies lie where their nodes do.
deformvolume::ElasticBody Apply(
  deformvolume::ElasticBody body, const deformvolume::MeshSplit& split);

void ExpectSame(const deformvolume::MeshSplit& a, const deformvolume::MeshSplit& b);
void ExpectNothing(const deformvolume::ElasticBody& body, const deformvolume::MeshSplit& split);

/// What holds for every cut, whatever the sheet.
void ExpectSound(const deformvolume::ElasticBody& body, const deformvolume::MeshSplit& split);

/// Of each tetrahedron the number of the piece that it belongs to: pieces hold together by faces,
/// and may touch at edges and nodes. Numbered from 0 in the order of their lowest tetrahedra.
std::vector<std::int32_t> FindFaceComponents(
  const std::vector<deformvolume::Tetrahedron>& tetrahedra);
std::size_t CountComponents(const std::vector<std::int32_t>& components);

/// Expects pieces that have no node in common. Returns their volumes.
std::vector<double> ExpectPieces(const deformvolume::ElasticBody& body, std::size_t count);

} // namespace physicsTesting

#endif
