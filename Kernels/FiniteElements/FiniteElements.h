// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFiniteElements_h
#define DeformVolumeFiniteElements_h

#include "BlockMatrix.h"
#include "BodyPieces.h"
#include "ElementBatches.h"
#include "EquilibriumTypes.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The sums over all tetrahedra, which do not depend on the number of threads, to the last bit.
class FiniteElements
{
public:
  FiniteElements(Watch& watch, const ElasticBody& body)
    : Batches(MakeElementBatches(watch, body))
  {
  }

  void SetMaterials(const ElasticBody& body) { deformvolume::SetMaterials(this->Batches, body); }

  /// See SetActivePieces of ElementBatches.
  void SetActivePieces(
    const ElasticBody& body, const BodyPieces& pieces, const std::vector<bool>& isActive)
  {
    deformvolume::SetActivePieces(this->Batches, body, pieces.PieceOfTetrahedron, isActive);
  }

  /// What is needed to assemble matrices of this pattern.
  void SetPattern(Watch& watch, const BlockPattern& pattern)
  {
    this->Positions = FindPositions(watch, this->Batches, pattern);
  }

  struct Sums
  {
    double Energy = 0.0;
    std::int64_t Inverted = 0;
  };

  /// The strain energy and its derivatives by the displacements of the nodes.
  Sums FindForces(Watch& watch, const std::vector<glm::dvec3>& displacements,
    std::vector<glm::dvec3>& forces) const;

  /// Which nodes belong to tetrahedra that are inside out.
  void FindInvertedNodes(Watch& watch, const std::vector<glm::dvec3>& displacements,
    std::vector<unsigned char>& isInverted) const;

  /// The second derivatives; see FindTangent.
  void AssembleTangent(
    Watch& watch, const std::vector<glm::dvec3>& displacements, BlockMatrix& matrix) const;

  std::vector<ElementResults> GetResults(const std::vector<glm::dvec3>& displacements) const;

private:
  ElementBatches Batches;
  std::vector<BatchPositions> Positions;
};

} // namespace deformvolume

#endif
