// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFiniteElementDeformation
 * @brief   deform an elastic body to equilibrium by finite elements
 *
 * vtkFiniteElementDeformation finds where the nodes of a mesh come to rest under what holds and
 * loads them. Its elements are tetrahedra of ten nodes with four Gauss points. One layer of them is
 * enough for a beam to bend as it should, and they do not lock where the material is nearly
 * incompressible. There is no inertia: what comes out depends on the handles and loads of now, and
 * on where the body was where there are several equilibria. It works on the processor, in double
 * precision. Ports, arrays, units and times are those of vtkElasticDeformation.
 *
 * Every execution solves once, and begins where the last one has ended; times only say when.
 *
 * @par Nodes:
 * Tetrahedra have ten nodes: their corners, and one in the middle of each edge. vtkTetra cells get
 * nodes in the middle of their edges; vtkQuadraticTetra cells have them, each near the middle of
 * its edge, which may be curved. A mesh may have cells of both types. "Force" acts on nodes as it
 * is given. A node that is made has no force of its own. It is fixed where both ends of its edge
 * are, and displaced by the mean of their displacements. It slides where its edge lies, within a
 * thousandth, in a plane in which one end slides, and the other end is fixed or slides in the same
 * plane. Where other nodes are to be fixed or to slide, as on curved surfaces, give
 * vtkQuadraticTetra cells with these arrays. A mesh has as many nodes as one of linear tetrahedra
 * whose edges are half as long.
 *
 * @par Output:
 * Cells of vtkQuadraticTetra. The points of the input come first, then the nodes that were made in
 * the middle of edges, then the copies of nodes that cuts have made. Points that are made have the
 * mean of both ends in all point arrays but those that are named above, and are ghosts where both
 * ends are. Where points are made, global ids and pedigree ids are left out. The points and cells
 * are the same objects in all executions for one mesh.
 *
 * @par Pieces:
 * A piece of the mesh is what holds together by faces of tetrahedra. It is held by three nodes that
 * lie on no common line and are fixed, held by handles, or shared with a piece that is held; or by
 * such nodes and nodes that slide, where no motion of a rigid body is left to it. Other pieces bear
 * no load and exert no force: those with a node or two that are shared, fixed or held by handles go
 * with these like rigid bodies, turned on the shortest way; the rest stays where it was. A warning
 * has their number (GetNumberOfFrozenPieces()). Where no piece is held there is an error.
 *
 * @par Warnings:
 * Pieces that are not held; a body that is not in equilibrium, with what is left (in the mode
 * INTERACTIVE once); tetrahedra that are inside out, with their number.
 *
 * @par Errors:
 * Those of vtkElasticDeformation; tetrahedra that overlap themselves, or do so split into linear
 * ones, as nodes are far from the middle of their edges or in another order than VTK's; an edge
 * with two different nodes in its middle, or a node in the middle of several edges; no piece that
 * is held; forces that are no numbers any more. The body is then as it was.
 *
 * Sources: Smith, de Goes and Kim 2018 for the stable neo-Hookean law, here without its logarithm,
 * and 2019 for the stiffness that is never negative; Mueller and Gross 2004 for the corotational
 * law; Documents/physics.md.
 *
 * @sa vtkElasticDeformation vtkMassSpringDeformation vtkDeformVolumeFilter
 */
#ifndef vtkFiniteElementDeformation_h
#define vtkFiniteElementDeformation_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkElasticDeformation.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class VTKDEFORMVOLUME_EXPORT vtkFiniteElementDeformation : public vtkElasticDeformation
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkFiniteElementDeformation* New();
  vtkTypeMacro(vtkFiniteElementDeformation, vtkElasticDeformation);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  /**
   * How stress follows from strain.
   */
  enum MaterialModelType
  {
    STABLE_NEO_HOOKEAN,
    COROTATIONAL
  };

  ///@{
  /**
   * Set/Get the strain energy. STABLE_NEO_HOOKEAN (default): for soft tissue. It keeps volumes at
   * large strain, and comes back from where elements are inside out. COROTATIONAL: linear
   * elasticity in a frame that turns with the material, as published where the Poisson ratio is at
   * most 0.4. Above, the part of lambda that is more than 4 mu acts on the volume, as in
   * STABLE_NEO_HOOKEAN. The rest does not keep volumes at large strain. Small strains of both are
   * those of linear elasticity.
   */
  vtkSetClampMacro(MaterialModel, int, STABLE_NEO_HOOKEAN, COROTATIONAL);
  vtkGetMacro(MaterialModel, int);
  void SetMaterialModelToStableNeoHookean() { this->SetMaterialModel(STABLE_NEO_HOOKEAN); }
  void SetMaterialModelToCorotational() { this->SetMaterialModel(COROTATIONAL); }
  ///@}

  /**
   * How far an execution goes.
   */
  enum ModeType
  {
    INTERACTIVE,
    CONVERGED
  };

  ///@{
  /**
   * Set/Get how far an execution goes. CONVERGED (default): equilibrium, to a GetRelativeResidual()
   * of 1e-6. INTERACTIVE: one or two steps towards equilibrium, for a body that is moved live,
   * until GetRelativeResidual() is at most 0.01 where handles have moved, else 0.001; the next
   * execution goes on from what is left.
   */
  vtkSetClampMacro(Mode, int, INTERACTIVE, CONVERGED);
  vtkGetMacro(Mode, int);
  void SetModeToInteractive() { this->SetMode(INTERACTIVE); }
  void SetModeToConverged() { this->SetMode(CONVERGED); }
  ///@}

  ///@{
  /**
   * Of the last execution. Whether the body is in equilibrium; steps of Newton's method, and
   * iterations of conjugate gradients in all of them; the largest component of a force on a node
   * that is left, in N, and as a part of the largest force that is applied or that holds a node;
   * the strain energy, in J; pieces of the mesh that nothing holds; tetrahedra that are inside out.
   */
  bool GetIsConverged();
  int GetNumberOfNewtonSteps();
  int GetNumberOfLinearIterations();
  double GetResidual();
  double GetRelativeResidual();
  double GetStrainEnergy();
  vtkIdType GetNumberOfFrozenPieces();
  vtkIdType GetNumberOfInvertedTetrahedra();
  ///@}

  std::string GetSummary() override;

protected:
  vtkFiniteElementDeformation();
  ~vtkFiniteElementDeformation() override;

#ifndef __VTK_WRAP__
  deformvolume::ElasticSimulation& PrepareSimulation() override;
  double GetFreeDuration() override
  {
    return 0.0;
  }
#endif

private:
  vtkFiniteElementDeformation(const vtkFiniteElementDeformation&) = delete;
  void operator=(const vtkFiniteElementDeformation&) = delete;

  int MaterialModel = STABLE_NEO_HOOKEAN;
  int Mode = CONVERGED;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
