// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFiniteElements_h
#define DeformVolumeFiniteElements_h

#include "AbortCheck.h"
#include "BlockMatrix.h"
#include "BodyPieces.h"
#include "ElementBatches.h"
#include "EquilibriumTypes.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Sums of forces, energies and tangents over all tetrahedra. The sums are bit for bit the same for
/// any number of threads.
class FiniteElements
{
public:
  FiniteElements(AbortCheck& abortCheck, const ElasticBody& body)
    : Batches(MakeElementBatches(abortCheck, body))
  {
  }

  void SetMaterials(const ElasticBody& body) { deformvolume::SetMaterials(this->Batches, body); }
  void SetMaterialModel(MaterialModel model) { this->Model = model; }
  MaterialModel GetMaterialModel() const { return this->Model; }

  /// See SetActivePieces() in ElementBatches.h.
  void SetActivePieces(
    const ElasticBody& body, const BodyPieces& pieces, const std::vector<bool>& isActive)
  {
    deformvolume::SetActivePieces(this->Batches, body, pieces.PieceOfTetrahedron, isActive);
  }

  /// Prepares AssembleTangent() for matrices of this pattern.
  void SetPattern(AbortCheck& abortCheck, const BlockPattern& pattern)
  {
    this->Positions = FindPositions(abortCheck, this->Batches, pattern);
  }

  struct Sums
  {
    double Energy = 0.0;
    /// The size of the terms whose difference is the energy. Rounding errors of the energy are
    /// about 1e-16 of this value.
    double SizeOfTerms = 0.0;
    /// The number of tetrahedra that are inverted at a Gauss point.
    std::int64_t Inverted = 0;
  };

  /// Computes the strain energy, and the forces: its derivatives with respect to the displacements
  /// of the nodes.
  Sums FindForces(AbortCheck& abortCheck, const std::vector<glm::dvec3>& displacements,
    std::vector<glm::dvec3>& forces) const;

  /// Marks the nodes of tetrahedra that are inverted at a Gauss point.
  void FindInvertedNodes(AbortCheck& abortCheck, const std::vector<glm::dvec3>& displacements,
    std::vector<unsigned char>& isInverted) const;

  /// Computes the second derivatives. isClamped: whether the tangent must have no negative
  /// eigenvalues, see FindTangent.
  void AssembleTangent(AbortCheck& abortCheck, const std::vector<glm::dvec3>& displacements,
    bool isClamped, BlockMatrix& matrix) const;

  std::vector<ElementResults> GetResults(const std::vector<glm::dvec3>& displacements) const;

private:
  ElementBatches Batches;
  MaterialModel Model = MaterialModel::StableNeoHookean;
  std::vector<BatchPositions> Positions;
};

/// Returns for each tetrahedron whether one of its twelve linear parts is inverted (see
/// EquilibriumReport::NumberOfInvertedTetrahedra).
std::vector<unsigned char> FindInvertedSplits(
  AbortCheck& abortCheck, const ElasticBody& body, const std::vector<glm::dvec3>& displacements);

} // namespace deformvolume

#endif
