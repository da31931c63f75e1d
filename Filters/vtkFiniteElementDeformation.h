// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFiniteElementDeformation
 * @brief   deform an elastic body to equilibrium by corotational finite elements
 *
 * vtkFiniteElementDeformation finds where the nodes of a mesh come to rest under what holds and
 * loads them: linear elasticity in a frame that turns with each tetrahedron, so that large
 * rotations are right. There is no inertia: what comes out depends on the handles and loads of now,
 * and on where the body was where there are several equilibria. It works on the processor, in
 * double precision. Ports, arrays, units and times are those of vtkElasticDeformation.
 *
 * Every execution solves once, and begins where the last one has ended; times only say when.
 *
 * Linear tetrahedra are too stiff in bending. Use four or more of them across what is to bend:
 * Documents/physics.md has numbers.
 *
 * @par Pieces:
 * A piece of the mesh is what holds together by faces of tetrahedra. It is held by three nodes that
 * lie on no common line and are fixed, held by handles, or shared with a piece that is held. Other
 * pieces bear no load and exert no force: those with a node or two that are shared, fixed or held
 * by handles go with these like rigid bodies, turned on the shortest way; the rest stays where it
 * was. A warning tells their number (GetNumberOfFrozenPieces()). Where no piece is held there is an
 * error.
 *
 * @par Warnings:
 * Pieces that are not held; a body that is not in equilibrium, with what is left (in the mode
 * INTERACTIVE once); tetrahedra that are inside out, with their number.
 *
 * @par Errors:
 * Those of vtkElasticDeformation; no piece that is held; forces that are no numbers any more. The
 * body is then as it was.
 *
 * Sources: Mueller and Gross 2004 for corotational elements; Smith, de Goes and Kim 2019 for the
 * stiffness that is never negative; Documents/physics.md.
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
  static vtkFiniteElementDeformation* New();
  vtkTypeMacro(vtkFiniteElementDeformation, vtkElasticDeformation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

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
   * CONVERGED (default): equilibrium, to a GetRelativeResidual() of 1e-6. INTERACTIVE: one or two
   * steps towards equilibrium, for a body that is moved live, until GetRelativeResidual() is at
   * most 0.01 where handles have moved, else 0.001; the next execution goes on from what is left.
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

  int Mode = CONVERGED;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
