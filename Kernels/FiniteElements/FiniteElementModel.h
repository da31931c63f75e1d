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

/// Equilibrium of an elastic body by tetrahedra of ten nodes with four Gauss points. They bend as
/// they should with one of them across, also where the material is nearly incompressible: the part
/// of lambda that is more than 4 mu acts on the mean dilatation of each tetrahedron only (selective
/// mean dilatation). The body needs mid-side nodes (AddMidSideNodes).
///
/// Order of calls: SetBody, then Solve, as often as wanted. Solve begins with the last
/// displacements. Every failure is an Error; the body, its materials and its displacements are then
/// as before the call.
/// Results do not depend on the number of threads, to the last bit.
class DEFORMVOLUME_EXPORT FiniteElementModel
{
public:
  FiniteElementModel();
  ~FiniteElementModel();
  FiniteElementModel(const FiniteElementModel&) = delete;
  FiniteElementModel& operator=(const FiniteElementModel&) = delete;

  /// The body, at rest. An Error where CheckBody finds one, or it has no mid-side nodes; the last
  /// body stays then. progress: called every few milliseconds, in the thread that called; returning
  /// false aborts, and the last body stays, too.
  void SetBody(const ElasticBody& body, const std::function<bool()>& progress = nullptr);

  /// One material for the body that is set, or one a tetrahedron. Displacements stay.
  void SetMaterials(const std::vector<ElasticMaterial>& materials);

  /// The strain energy of a material, now and of bodies that follow. Displacements stay. Default:
  /// stable neo-Hookean.
  void SetMaterialModel(MaterialModel model);

  /// Moves the held nodes to where they are to be, and the others towards equilibrium. An Error
  /// where CheckLoads or CheckHeldNodes find one, where no piece of the body is held, and where the
  /// forces are no numbers any more.
  EquilibriumReport Solve(const EquilibriumRequest& request);

  /// Puts all displacements to 0, and forgets what the last calls of Solve have left for the next.
  void Reset();

  /// Of each node, in metres.
  const std::vector<glm::dvec3>& GetDisplacements() const;

  /// Where the next call of Solve begins, such as a state that was saved. Nodes that slide begin at
  /// the nearest place in their plane, or on their line.
  void SetDisplacements(const std::vector<glm::dvec3>& displacements);

  /// The force with which each node resists its displacement, in N: for a free node that of the
  /// loads when in equilibrium, for a held one its reaction to them as well.
  std::vector<glm::dvec3> GetForces() const;

  /// Of each tetrahedron.
  std::vector<ElementResults> GetElementResults() const;

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
