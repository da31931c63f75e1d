// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFiniteElementModel_h
#define DeformVolumeFiniteElementModel_h

#include "DeformVolumeExport.h"
#include "ElasticBody.h"
#include "EquilibriumTypes.h"
#include "Error.h"

#include <glm/vec3.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

/// Computes the equilibrium of an elastic body with ten-node tetrahedra and four Gauss points. The
/// body needs mid-side nodes (AddMidSideNodes). To avoid volumetric locking of nearly
/// incompressible material, the part of lambda above 4 mu acts on the mean dilatation of each
/// tetrahedron only (selective mean dilatation).
///
/// Call SetBody first, then Solve any number of times. Solve starts from GetStart().
/// Every failure throws an Error; the body, its materials and its displacements are then unchanged.
/// Results are bit for bit the same for any number of threads.
class DEFORMVOLUME_EXPORT FiniteElementModel
{
public:
  FiniteElementModel();
  ~FiniteElementModel();
  FiniteElementModel(const FiniteElementModel&) = delete;
  FiniteElementModel& operator=(const FiniteElementModel&) = delete;

  /// Sets the body at rest. Throws an Error if CheckBody does, or if the body has no mid-side
  /// nodes. progress: called every few milliseconds in the calling thread; return false to abort.
  /// After an error or an abort the previous body is kept.
  void SetBody(const ElasticBody& body, const std::function<bool()>& progress = nullptr);

  /// Sets one material for the body, or one for each tetrahedron. Displacements do not change.
  void SetMaterials(const std::vector<ElasticMaterial>& materials);

  /// Sets the strain energy model, for this body and those set later. Displacements do not change.
  /// Default: stable neo-Hookean.
  void SetMaterialModel(MaterialModel model);

  /// Moves the held nodes to their prescribed displacements, and the other nodes towards
  /// equilibrium. Throws an Error if CheckLoads or CheckHeldNodes does, if no piece of the body is
  /// held, or if forces become infinite or not a number.
  EquilibriumReport Solve(const EquilibriumRequest& request);

  /// Sets all displacements to 0, and discards the tangent and the solutions of earlier calls of
  /// Solve.
  void Reset();

  /// Returns the displacement of each node, in meters.
  const std::vector<glm::dvec3>& GetDisplacements() const;

  /// Returns the displacements from which the next call of Solve starts: those of the last one, or
  /// 0 if it gave up (EquilibriumMode::Converged).
  std::vector<glm::dvec3> GetStart() const;

  /// Sets the displacements from which the next call of Solve starts, such as a saved state.
  /// Displacements of sliding nodes are projected to their plane or line.
  void SetDisplacements(const std::vector<glm::dvec3>& displacements);

  /// Returns the elastic force of each node, in N. In equilibrium, the force of a free node equals
  /// its load. The force of a held node equals its load plus the reaction of the support.
  std::vector<glm::dvec3> GetForces() const;

  /// Returns the reaction of each node in the last call of Solve, in N: the force of the support on
  /// the body. It is 0 at nodes that are neither fixed, held nor sliding, and on pieces that are
  /// not held. In equilibrium, the sum of reactions and loads is 0.
  const std::vector<glm::dvec3>& GetReactions() const;

  /// Returns the stress and deformation of each tetrahedron.
  std::vector<ElementResults> GetElementResults() const;

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
