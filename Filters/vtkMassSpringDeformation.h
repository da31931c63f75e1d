// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkMassSpringDeformation
 * @brief   deform an elastic body by mass-spring dynamics
 *
 * vtkMassSpringDeformation moves the nodes of a mesh by Newton's law: the edges of its tetrahedra
 * are springs, and their volumes resist change. It works on an OpenCL device. Ports, arrays, units
 * and times are those of vtkElasticDeformation.
 *
 * If no time is requested, an execution simulates FrameTime. Call Modified() to continue if nothing
 * else has changed.
 *
 * @par Materials:
 * The stiffness of springs is derived from the Young modulus and the Poisson ratio. Springs
 * represent a material only on lattices of equal cubes, with five tetrahedra each, such as those of
 * vtkLatticeTetrahedraSource with EqualSpacing. Tetrahedra may be missing or cut apart. Edges may
 * differ by a thousandth. For other meshes use vtkFiniteElementDeformation. Springs alone have a
 * Poisson ratio of 0.25. The resistance of the volumes makes greater ratios. Smaller ratios are
 * replaced by 0.25, with a warning.
 *
 * @par Inverted tetrahedra: Springs have no force that turns an inverted tetrahedron back. A
 * warning has the number of inverted tetrahedra (GetNumberOfInvertedTetrahedra()) at the end of an
 * execution, if there were none at the end of the last one.
 *
 * @par Errors:
 * Those of vtkElasticDeformation; a tetrahedron that is not a fifth of a cube of the same size as
 * the others; a time step that is longer than the stable one; a simulation that diverges, after
 * which the body keeps its last state; all nodes fixed; too little memory on the device.
 *
 * Sources: Rodriguez, Leon, Martin and Otaduy, "A parallel resampling method for interactive
 * deformation of volumetric models"; Teschner et al. 2004 for the energy of volumes;
 * Documents/physics.md.
 *
 * @sa vtkElasticDeformation vtkFiniteElementDeformation vtkDeformVolumeFilter
 */
#ifndef vtkMassSpringDeformation_h
#define vtkMassSpringDeformation_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkElasticDeformation.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class VTKDEFORMVOLUME_EXPORT vtkMassSpringDeformation : public vtkElasticDeformation
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkMassSpringDeformation* New();
  vtkTypeMacro(vtkMassSpringDeformation, vtkElasticDeformation);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Set/Get the longest time step, in s; 0: three quarters of the stable time step. A frame has as
   * many equal steps as it needs. Default 0, at least 0.
   */
  vtkSetClampMacro(TimeStep, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(TimeStep, double);
  ///@}

  ///@{
  /**
   * Set/Get the rate at which velocities decrease, in 1/s: in the time 1/Damping, they decrease to
   * 1/e. Default: 2, at least 0.
   */
  vtkSetClampMacro(Damping, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Damping, double);
  ///@}

  ///@{
  /**
   * Set/Get the OpenCL device, see vtkDeformVolumeFilter::SetDevice(). A change of device resets
   * the body to rest. Default: "", the best device.
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  ///@}

  ///@{
  /**
   * Set/Get how many bytes of device memory may be used; 0: the available memory. A mesh that needs
   * more is an error before anything is allocated. Default 0.
   */
  vtkSetClampMacro(MemoryLimit, vtkTypeInt64, 0, VTK_TYPE_INT64_MAX);
  vtkGetMacro(MemoryLimit, vtkTypeInt64);
  ///@}

  /**
   * Get the stable time step, in s, with which the body is stable near rest (Documents/physics.md).
   * Longer time steps are errors. 0 before the first execution.
   */
  double GetStableTimeStep();

  ///@{
  /**
   * Get results of the last frame: the number of steps, the length of a step in s, and the number
   * of inverted tetrahedra at its end. After an error they are 0.
   */
  vtkIdType GetNumberOfSteps();
  double GetTimeStepInUse();
  vtkIdType GetNumberOfInvertedTetrahedra();
  ///@}

  /**
   * Get the name of the device of the last execution; "" before the first.
   */
  std::string GetDeviceInUse();

  std::string GetSummary() override;

protected:
  vtkMassSpringDeformation();
  ~vtkMassSpringDeformation() override;

#ifndef __VTK_WRAP__
  deformvolume::ElasticSimulation& PrepareSimulation() override;
  void ClearReport() override;
  double GetFreeDuration() override
  {
    return this->GetFrameTime();
  }
#endif

private:
  vtkMassSpringDeformation(const vtkMassSpringDeformation&) = delete;
  void operator=(const vtkMassSpringDeformation&) = delete;

  double TimeStep = 0.0;
  double Damping = 2.0;
  std::string Device;
  vtkTypeInt64 MemoryLimit = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
