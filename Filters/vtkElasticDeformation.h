// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkElasticDeformation
 * @brief   common part of the filters that deform an elastic body by a simulation
 *
 * vtkElasticDeformation reads an elastic body with its constraints and loads. The output is the
 * mesh at rest with the displacements that a simulation computes. It can be connected to
 * vtkDeformVolumeFilter as the deformation (SetDeformationConnection()). Subclasses implement the
 * simulations. The simulated state is kept from one execution to the next.
 *
 * @par Port 0, the mesh at rest:
 * vtkUnstructuredGrid of vtkTetra cells, and with vtkFiniteElementDeformation of vtkQuadraticTetra
 * cells as well, all of the same orientation: with the fourth point on the same side of the first
 * three. Cells of fewer than three dimensions are ignored, and so are cells that vtkGhostType marks
 * as hidden or duplicate, and those with a point that it hides or whose vtkValidPointMask is 0.
 * These arrays are used, all of them optional:
 * - the point array "Fixed", one component: nodes with a value other than 0 are fixed, with finite
 *   elements at their rest position, with springs where they are when they become fixed;
 * - the point array "PrescribedDisplacement", three components, in the units of the mesh:
 *   displacements of the fixed nodes. Values at other nodes are not used;
 * - the point array "SlidingNormal", three components: nodes with a vector other than 0 slide
 *   without friction in the plane through their rest position with this normal. Its length and sign
 *   do not matter. "SecondSlidingNormal", of the same kind: nodes with both normals slide along the
 *   common line of both planes, for example where two planes of symmetry meet;
 * - the point array "Force", three components: a force on each node, in N;
 * - the cell arrays "YoungModulus" (Pa), "PoissonRatio" and "Density" (kg/m^3), one component: the
 *   material of each tetrahedron, used instead of the properties of these names and of
 *   MaterialPreset.
 *
 * vtkMassSpringDeformation supports neither prescribed displacements nor sliding nodes, and reports
 * an error if an array has some.
 *
 * @par Port 1, optional, the handles:
 * vtkPointSet. Each point is the current position of a handle. The point array "RestPosition" of
 * three components is the position in the mesh at rest that a handle holds: the nodes within
 * HandleRadius of this position or, if none of these can move, the nodes of the tetrahedron that
 * contains it, so that the tissue there follows the handle. If HandleRadius is 0, it is the nearest
 * node. Points that no tetrahedron uses are ignored. If several handles hold a node, the first one
 * is used. Handles do not move fixed nodes, and move sliding nodes only within their plane or along
 * their line. The point array "HeldNode", optional, one component, names a node of the output that
 * a handle holds instead of those at its rest position; -1: none. It moves by the point minus
 * "RestPosition".
 *
 * @par Port 2, optional, the sheet:
 * vtkPolyData in world coordinates: triangles, polygons and triangle strips; also polylines if
 * SweepVector is set. The sheet cuts the deformed mesh along the nearest faces of its tetrahedra.
 * Nodes on the cut are split: copies of them are appended, so that the two sides can move apart.
 * The force of a split node is divided equally among its copies. A cut is made when the sheet
 * changes, and cuts accumulate. vtkDeformVolumeFilter opens the volume at cuts if OpenSplits is on.
 *
 * @par Output:
 * The mesh at rest, with the point array "Displacement" (float, three components, in the units of
 * the points), which is also the active vectors. On CPU devices it is a vtkFloatArray, on a device
 * with memory of its own a vtkDeviceVectorArray. The array is the same object, in the same memory,
 * in all executions for one mesh: make a deep copy to keep its values. ElementResults adds
 * arrays. The first piece is the whole mesh, all others are empty. Appended points, which are
 * mid-side nodes of vtkFiniteElementDeformation and copies of nodes at cuts, follow the points of
 * the input.
 *
 * @par Time:
 * If a time is requested (UpdateTimeStep(), or ParaView's play button), the simulation advances to
 * it in frames of FrameTime. Set EndTime before, unless the inputs have times: VTK updates an
 * output for another time only if it has a time range. If the time is earlier than the last one,
 * the simulation restarts from rest and advances to the time with the current handles and loads.
 * Handles move to their final positions in the first frame. The subclasses describe updates without
 * a time. A request for another piece does not advance the simulation again. The output has the
 * time range from 0 to EndTime, unless the inputs have times.
 *
 * @par Changes:
 * If the points or cells of the mesh at rest or LengthUnit change, the simulation restarts from
 * rest, with a warning. If materials, fixed or sliding nodes, forces or prescribed displacements
 * change, it continues.
 *
 * @par Abort:
 * An aborted execution ends within about 50 ms, with an empty output. The simulated state is kept.
 * Reading the mesh, copying a body of springs to the device and cutting are not interrupted.
 *
 * @par Errors:
 * Each error is reported by one vtkErrorMacro: composite data; no tetrahedra, or other
 * three-dimensional cells; flat tetrahedra, tetrahedra of different orientations, and those that
 * the mesh has twice; coordinates and numbers that are not finite; a Young modulus or a density of
 * 0 or less, a Poisson ratio of less than 0 or of 0.495 and more; arrays of another shape; nodes
 * that are fixed and slide; prescribed displacements without the array "Fixed", and second normals
 * without first ones; a handle that holds no node; a sheet that is an error in vtkCutVolume. The
 * output is then empty, the simulated state is kept, and a new sheet cuts in the next execution
 * that succeeds. If memory or a device fails, the body restarts from rest.
 *
 * @sa vtkMassSpringDeformation vtkFiniteElementDeformation vtkDeformVolumeFilter
 */
#ifndef vtkElasticDeformation_h
#define vtkElasticDeformation_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <cstddef> // for std::size_t
#include <memory>  // for std::unique_ptr
#include <string>  // for std::string

namespace deformvolume
{
class ElasticSimulation;
class ProgressReport;
}
class vtkPointSet;
class vtkPolyData;

class VTKDEFORMVOLUME_EXPORT vtkElasticDeformation : public vtkUnstructuredGridAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for type information and printing.
   */
  vtkTypeMacro(vtkElasticDeformation, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the handles (port 1, optional).
   */
  void SetHandlesConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  /// Set the data object of port 1 itself, without a pipeline.
  void SetHandlesData(vtkDataObject* data) { this->SetInputDataObject(1, data); }
  ///@}

  ///@{
  /**
   * Connect the sheet that cuts (port 2, optional).
   */
  void SetSheetConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  /// Set the data object of port 2 itself, without a pipeline.
  void SetSheetData(vtkDataObject* data) { this->SetInputDataObject(2, data); }
  ///@}

  ///@{
  /**
   * Set/Get the vector along which polylines of the sheet cut: each segment becomes the
   * parallelogram that it sweeps. World units; 0, 0, 0: polylines do not cut. Default 0, 0, 0.
   */
  vtkSetVector3Macro(SweepVector, double);
  vtkGetVector3Macro(SweepVector, double);
  ///@}

  ///@{
  /**
   * Undo the last cut, or remove all cuts, before the next execution. The copies of nodes are
   * removed, and the body returns to its state before the cut. The sheet cuts again after it has
   * changed.
   */
  void UndoCut();
  /// Remove all cuts before the next execution.
  void ClearCuts();
  ///@}

  ///@{
  /**
   * Get the number of cuts that have split the mesh, and the number of faces of tetrahedra that
   * they have split.
   */
  vtkIdType GetNumberOfCuts();
  vtkIdType GetNumberOfSplitFaces();
  ///@}

  ///@{
  /**
   * Set/Get the distance from its rest position within which a handle holds nodes, in the units of
   * the mesh, at least 0. If there are none, it holds the nodes of the tetrahedron at its rest
   * position. Default: 0, only the nearest node.
   */
  vtkSetClampMacro(HandleRadius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(HandleRadius, double);
  ///@}

  ///@{
  /**
   * Set/Get the acceleration of gravity, in m/s^2, along the axes of the world. Default 0, 0, 0.
   */
  vtkSetVector3Macro(Gravity, double);
  vtkGetVector3Macro(Gravity, double);
  ///@}

  ///@{
  /**
   * Set/Get the Young modulus of tetrahedra without the cell array "YoungModulus", in Pa, greater
   * than 0. Default: 10000, a soft tissue.
   */
  vtkSetMacro(YoungModulus, double);
  vtkGetMacro(YoungModulus, double);
  ///@}

  ///@{
  /**
   * Set/Get the Poisson ratio of tetrahedra without the cell array "PoissonRatio", 0 or more and
   * less than 0.495. Default: 0.3.
   */
  vtkSetMacro(PoissonRatio, double);
  vtkGetMacro(PoissonRatio, double);
  ///@}

  ///@{
  /**
   * Set/Get the density of tetrahedra without the cell array "Density", in kg/m^3, greater than 0.
   * Default: 1000.
   */
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}

  /**
   * Tissues with predefined materials. CUSTOM: no tissue.
   */
  enum MaterialPresetType
  {
    CUSTOM,
    BRAIN,
    LIVER,
    FAT,
    MUSCLE,
    SKIN,
    CARTILAGE,
    BONE
  };

  ///@{
  /**
   * Set/Get the tissue whose Young modulus (Pa), Poisson ratio and density (kg/m^3) are used
   * instead of the properties of these names, which keep their values. Cell arrays have priority
   * over the preset. CUSTOM: the properties are used. Default: CUSTOM.
   *
   * The Young moduli are means of measurements at small strains. They differ between people, and
   * between methods of measurement, by a factor of several: Documents/physics.md has the sources
   * and ranges. BONE is cortical bone. With it, the time steps of springs become very short.
   */
  vtkSetClampMacro(MaterialPreset, int, CUSTOM, BONE);
  vtkGetMacro(MaterialPreset, int);
  void SetMaterialPresetToCustom() { this->SetMaterialPreset(CUSTOM); }
  void SetMaterialPresetToBrain() { this->SetMaterialPreset(BRAIN); }
  void SetMaterialPresetToLiver() { this->SetMaterialPreset(LIVER); }
  void SetMaterialPresetToFat() { this->SetMaterialPreset(FAT); }
  void SetMaterialPresetToMuscle() { this->SetMaterialPreset(MUSCLE); }
  void SetMaterialPresetToSkin() { this->SetMaterialPreset(SKIN); }
  void SetMaterialPresetToCartilage() { this->SetMaterialPreset(CARTILAGE); }
  void SetMaterialPresetToBone() { this->SetMaterialPreset(BONE); }
  ///@}

  ///@{
  /**
   * Get the name of a preset, such as "Liver"; the source of its Young modulus, authors and year;
   * and its Young modulus (Pa), Poisson ratio and density (kg/m^3), in this order. CUSTOM has only
   * the name "Custom". If there is no such preset, these return null, or return false and do not
   * change `values`.
   */
  static const char* GetMaterialPresetName(int preset);
  static const char* GetMaterialPresetSource(int preset);
  static bool GetMaterialPresetValues(int preset, double values[3]);
  ///@}

  /**
   * Units of length.
   */
  enum LengthUnitType
  {
    METRE,
    MILLIMETRE
  };

  ///@{
  /**
   * Set/Get the unit of the mesh, the handles and the displacements: MILLIMETRE (default), as in
   * most medical images, or METRE. A body with a diagonal of less than 1 mm or more than 10 m
   * causes a warning.
   */
  vtkSetClampMacro(LengthUnit, int, METRE, MILLIMETRE);
  vtkGetMacro(LengthUnit, int);
  void SetLengthUnitToMetre() { this->SetLengthUnit(METRE); }
  void SetLengthUnitToMillimetre() { this->SetLengthUnit(MILLIMETRE); }
  ///@}

  ///@{
  /**
   * Set/Get the duration of a frame, in s, at least 1e-6. Default: 1/60.
   */
  vtkSetClampMacro(FrameTime, double, 1e-6, VTK_DOUBLE_MAX);
  vtkGetMacro(FrameTime, double);
  ///@}

  ///@{
  /**
   * Set/Get the end of the time range of the output, in s, used if the inputs have no times.
   * Consumers then request a time in each update. Default: 0, no time range, with which VTK ignores
   * UpdateTimeStep() after the first update. If the first update requests a time, a warning says
   * so. In ParaView the default is 1.
   */
  vtkSetClampMacro(EndTime, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(EndTime, double);
  ///@}

  ///@{
  /**
   * Set/Get whether the output has cell arrays of doubles with the results of each tetrahedron:
   * "Stress" (Cauchy, in Pa, the components xx yy zz xy yz xz), "StrainEnergyDensity" (J/m^3 of the
   * volume at rest) and "DeformationGradientDeterminant" (its deformed volume divided by its volume
   * at rest; less than 0 if it is inverted). A flat tetrahedron, with a determinant within 1e-12 of
   * 0, has no volume for a stress: its "Stress" is 0. vtkFiniteElementDeformation also adds the
   * point array of doubles "ReactionForce": the force, in N, of the support or handle on each node
   * that is fixed, held or slides; 0 at other nodes, and on pieces that are not held. In
   * equilibrium, the sum of reactions, weight and "Force" is 0. Default: off.
   */
  vtkSetMacro(ElementResults, bool);
  vtkGetMacro(ElementResults, bool);
  vtkBooleanMacro(ElementResults, bool);
  ///@}

  /**
   * Reset the body to rest, and its time to 0, before the next execution. VTK keeps the last
   * requested time: after UpdateTimeStep(t), Update() advances to t again. A new sheet cuts the
   * body at rest.
   */
  void Reset();

  /**
   * Get the simulated time, in s.
   */
  double GetTime();

  /**
   * Get the number of nodes that handles held in the last execution; 0 after an error.
   */
  vtkGetMacro(NumberOfHeldNodes, vtkIdType);

  /**
   * Get a description of the last execution as text; "" before the first, and after an error.
   */
  virtual std::string GetSummary();

protected:
  vtkElasticDeformation();
  ~vtkElasticDeformation() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** input,
    vtkInformationVector* output, int requestFromOutputPort, vtkMTimeType* mtime) override;

#ifndef __VTK_WRAP__
  ///@{
  /// Subclasses implement these: set the properties of the simulation and return it; return the
  /// duration that an update without a time simulates, in s; clear the numbers of the last frame,
  /// after an update that failed. The first two throw deformvolume::Error.
  virtual deformvolume::ElasticSimulation& PrepareSimulation() = 0;
  virtual double GetFreeDuration() = 0;
  virtual void ClearReport() = 0;
  ///@}
#endif

private:
  vtkElasticDeformation(const vtkElasticDeformation&) = delete;
  void operator=(const vtkElasticDeformation&) = delete;

  void Execute(vtkInformationVector** input, vtkInformationVector* output);
  /// Undoes cuts, and cuts with the sheet. Returns the number of cuts before that of the sheet.
  std::size_t UpdateCuts(vtkPolyData* sheet, bool isToReset);
  void RevertCuts(deformvolume::ElasticSimulation& simulation, std::size_t left);
  /// The part of FrameTime that is neglected: rounding errors must not change the number of frames
  /// if a time is a multiple of FrameTime.
  double GetRoundOff() const
  {
    return 1e-6 * this->FrameTime;
  }
  /// Whether the simulation starts again from rest: after Reset(), or if an earlier time than the
  /// current one is requested.
  bool StartsAgain(vtkInformation* info);
  /// Advances to the requested time, if any. isToReset: becomes false as soon as the body is reset.
  void Advance(deformvolume::ElasticSimulation& simulation, vtkPointSet* handles,
    vtkInformation* info, deformvolume::ProgressReport& progress, bool& isToReset);
  /// Warns if a body of this size, in m, is probably not intended.
  void CheckSize(double size);

  double HandleRadius = 0.0;
  double Gravity[3] = { 0.0, 0.0, 0.0 };
  double YoungModulus = 1e4;
  double PoissonRatio = 0.3;
  double Density = 1000.0;
  int MaterialPreset = CUSTOM;
  double SweepVector[3] = { 0.0, 0.0, 0.0 };
  int LengthUnit = MILLIMETRE;
  double FrameTime = 1.0 / 60.0;
  double EndTime = 0.0;
  bool ElementResults = false;
  vtkIdType NumberOfHeldNodes = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
