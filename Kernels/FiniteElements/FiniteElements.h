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
  void SetMaterialModel(MaterialModel model) { this->Model = model; }
  MaterialModel GetMaterialModel() const { return this->Model; }

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
    /// What the energy is the difference of: it is rounded to 1e-16 of this.
    double Rounded = 0.0;
    /// Tetrahedra that are inside out at a Gauss point.
    std::int64_t Inverted = 0;
  };

  /// The strain energy and its derivatives by the displacements of the nodes.
  Sums FindForces(Watch& watch, const std::vector<glm::dvec3>& displacements,
    std::vector<glm::dvec3>& forces) const;

  /// Which nodes belong to tetrahedra that are inside out at a Gauss point.
  void FindInvertedNodes(Watch& watch, const std::vector<glm::dvec3>& displacements,
    std::vector<unsigned char>& isInverted) const;

  /// The second derivatives; isClamped: without negative eigenvalues, see FindTangent.
  void AssembleTangent(Watch& watch, const std::vector<glm::dvec3>& displacements, bool isClamped,
    BlockMatrix& matrix) const;

  std::vector<ElementResults> GetResults(const std::vector<glm::dvec3>& displacements) const;

private:
  ElementBatches Batches;
  MaterialModel Model = MaterialModel::StableNeoHookean;
  std::vector<BatchPositions> Positions;
};

/// Of how many tetrahedra a part is inside out, where each is split into twelve linear ones: its
/// corners, and eight around its middle (see EquilibriumReport).
std::int64_t CountInvertedSplits(
  Watch& watch, const ElasticBody& body, const std::vector<glm::dvec3>& displacements);

} // namespace deformvolume

#endif
