// SPDX-License-Identifier: BSD-3-Clause
// A mesh of which tetrahedra are replaced by others, removed and added.
#ifndef RefinedMesh_h
#define RefinedMesh_h

#include "EditedVolume.h"
#include "MappingUpdate.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

/// The mesh of an EditedVolume with its nodes at rest, and how its tetrahedra follow from those of
/// the last time.
class RefinedMesh
{
public:
  /// The volume is edited along with the mesh. jitter: how far nodes lie beside those of a grid.
  RefinedMesh(EditedVolume& volume, double jitter, unsigned int seed);

  const std::vector<glm::dvec3>& GetPoints() const { return this->Points; }

  /// Does something with tetrahedra at random, and says what.
  std::string Edit();

  ///@{
  /// One tetrahedron becomes four, round a new node in it.
  void Refine();
  /// All tetrahedra with an edge become two.
  void SplitEdge();
  /// Some tetrahedra near each other.
  void Remove();
  /// A copy of a tetrahedron, with its nodes in another order or not, or one with other nodes.
  void Append();
  /// The mesh of an earlier time.
  void Undo();
  /// See EditedVolume::Split: the tetrahedra are the same ones, with other nodes in the same
  /// places.
  std::vector<deformvolume::TetrahedronChange> Split(int reach);
  ///@}

  /// What has become of the tetrahedra since this was asked last.
  deformvolume::TetrahedronReplacement TakeReplacement();

private:
  struct State
  {
    std::vector<deformvolume::Tetrahedron> Tetrahedra;
    std::vector<std::int64_t> Names; // of tetrahedra, which stay theirs
    std::vector<glm::dvec3> Points;
    std::vector<float> Displacements;
  };

  std::size_t Pick(std::size_t count) { return static_cast<std::size_t>(this->Random()) % count; }
  std::int32_t AddNode(const std::vector<std::int32_t>& between);
  void Insert(std::size_t place, const deformvolume::Tetrahedron& tetrahedron);
  State GetState() const;

  EditedVolume& Volume;
  std::mt19937 Random;
  std::vector<glm::dvec3> Points;
  std::vector<std::int64_t> Names;
  std::int64_t LastName = 0;
  std::vector<State> Snapshots;
  State Last;
};

#endif
