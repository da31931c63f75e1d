// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFiniteElementDeformation
 * @brief   deform an elastic body to equilibrium by finite elements
 *
 * vtkFiniteElementDeformation computes the static equilibrium of an elastic body under its
 * constraints and loads. Its elements are ten-node tetrahedra with four Gauss points. One layer of
 * elements is enough for a beam to bend correctly, and elements do not lock if the material is
 * nearly incompressible. There is no inertia: the result depends on the current handles and loads
 * and, if there are several equilibria, on the last state. It computes on the CPU, in double
 * precision. Ports, arrays, units and times are those of vtkElasticDeformation.
 *
 * Every execution solves once, and starts from the last state. The length of a time step has no
 * effect.
 *
 * @par Nodes:
 * Tetrahedra have ten nodes: their corners, and a mid-side node in the middle of each edge. The
 * filter adds mid-side nodes to vtkTetra cells. vtkQuadraticTetra cells have mid-side nodes, each
 * near the middle of its edge, which may be curved. A mesh may have cells of both types. "Force"
 * acts on nodes as given, except on boundary faces of vtkTetra cells with forces at all three
 * corners: these forces are passed on to the mid-side nodes of the faces. So a uniform traction is
 * exact if each corner has the traction times a third of the area of each loaded face. "Force" of
 * the output has the forces after this step. An added node is fixed if both ends of its edge are
 * fixed, with the mean of their prescribed displacements. It slides in the plane of an end if its
 * edge lies in this plane, within a thousandth, and the other end is fixed or slides in the same
 * plane. To fix or load other mid-side nodes, or to let them slide, as on curved surfaces, use
 * vtkQuadraticTetra cells with these arrays. A mesh has as many nodes as one of linear tetrahedra
 * with edges of half the length.
 *
 * @par Output:
 * Cells of the type vtkQuadraticTetra. The points of the input come first, then the added mid-side
 * nodes, then the copies of nodes at cuts. In all point arrays except those named above, an added
 * node has the mean of both ends. It is a ghost if both ends are. If nodes are added, global ids
 * and pedigree ids are left out. The points and cells are the same objects in all executions for
 * one mesh.
 *
 * @par Pieces:
 * A piece of the mesh is a connected component of tetrahedra that share faces. A piece is held by
 * three nodes that do not lie on one line and are fixed, held by handles, or shared with a piece
 * that is held. It is also held by such nodes together with sliding nodes if these exclude all
 * motions of a rigid body. Other pieces are frozen: they bear no load and exert no force. A frozen
 * piece with one or two nodes that are shared, fixed or held by handles follows these nodes like a
 * rigid body, with the smallest rotation. Other frozen pieces do not move, except that a deformed
 * one gets its shape at rest again, at the place that fits its nodes best. A warning has the number
 * of frozen pieces (GetNumberOfFrozenPieces()). It is an error if no piece is held.
 *
 * @par Warnings:
 * Pieces that are not held; a body that is not in equilibrium, with the residual (in the mode
 * INTERACTIVE only once); inverted tetrahedra, with their number.
 *
 * @par Errors:
 * Those of vtkElasticDeformation; tetrahedra that overlap themselves, or whose split into linear
 * tetrahedra does, because mid-side nodes are far from the middle of their edges or not in the
 * order of VTK; an edge with two different mid-side nodes, or a mid-side node of several edges; no
 * piece that is held; forces that become NaN. The state of the body does not change then.
 *
 * Sources: Smith, de Goes and Kim 2018 for the stable neo-Hookean law, here without its logarithm,
 * and 2019 for the positive semidefinite stiffness; Mueller and Gross 2004 for the corotational
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
   * Material laws.
   */
  enum MaterialModelType
  {
    STABLE_NEO_HOOKEAN,
    COROTATIONAL
  };

  ///@{
  /**
   * Set/Get the material law. STABLE_NEO_HOOKEAN (default): for soft tissue. It preserves the
   * volume at large strain, and recovers from inverted elements. COROTATIONAL: linear elasticity in
   * a frame that rotates with the material, as published if the Poisson ratio is at most 0.4. For
   * greater ratios, the part of lambda above 4 mu acts on the volume, as in STABLE_NEO_HOOKEAN. The
   * other part does not preserve the volume at large strain. At small strain both laws are linear
   * elasticity.
   */
  vtkSetClampMacro(MaterialModel, int, STABLE_NEO_HOOKEAN, COROTATIONAL);
  vtkGetMacro(MaterialModel, int);
  void SetMaterialModelToStableNeoHookean() { this->SetMaterialModel(STABLE_NEO_HOOKEAN); }
  void SetMaterialModelToCorotational() { this->SetMaterialModel(COROTATIONAL); }
  ///@}

  /**
   * When an execution ends.
   */
  enum ModeType
  {
    INTERACTIVE,
    CONVERGED
  };

  ///@{
  /**
   * Set/Get when an execution ends. CONVERGED (default): at equilibrium, with a
   * GetRelativeResidual() of at most 1e-6, or a residual of the size of rounding errors. If 200
   * steps do not suffice, or if the body is so tangled by loads that are far too large that further
   * steps are of no use, a warning says so; in the latter case the next execution starts at rest,
   * and a new sheet cuts the body at rest. If tetrahedra are inverted at equilibrium, their nodes
   * move to the mean of their neighbors and the body is solved once more; the result with less
   * energy is used.
   * INTERACTIVE: after one or two steps towards equilibrium, for a body that is moved
   * interactively. It ends as soon as GetRelativeResidual() is at most 0.01 if handles have moved,
   * else 0.001. The next execution continues from the last state.
   */
  vtkSetClampMacro(Mode, int, INTERACTIVE, CONVERGED);
  vtkGetMacro(Mode, int);
  void SetModeToInteractive() { this->SetMode(INTERACTIVE); }
  void SetModeToConverged() { this->SetMode(CONVERGED); }
  ///@}

  ///@{
  /**
   * Get results of the last execution: whether the body is in equilibrium; the number of steps of
   * Newton's method, and of iterations of conjugate gradients in all steps; the residual, which is
   * the largest component of the unbalanced force on a node, in N, and the residual as a part of
   * the largest force that is applied to a node or holds it; the strain energy, in J; the number of
   * frozen pieces; the number of inverted tetrahedra. After an error they are false and 0.
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
  void ClearReport() override;
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
