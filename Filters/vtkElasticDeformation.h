// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkElasticDeformation
 * @brief   common part of the filters that deform an elastic body by a simulation
 *
 * vtkElasticDeformation reads an elastic body, what holds it, and what acts on it, and gives the
 * mesh at rest with the displacements that a simulation finds. vtkDeformVolumeFilter takes that as
 * its deformation (SetDeformationConnection). Subclasses are the simulations. What is simulated is
 * kept from one execution to the next.
 *
 * @par Port 0, the rest mesh:
 * vtkUnstructuredGrid of vtkTetra cells, and with vtkFiniteElementDeformation of vtkQuadraticTetra
 * cells as well, all of them with the fourth point on the same side of the first three. Cells of
 * fewer than three dimensions are left out. These arrays are used, all of them optional:
 * - the point array "Fixed", one component: nodes where it is not 0 are held where they are;
 * - the point array "PrescribedDisplacement", three components, in the units of the mesh: where
 *   these nodes are displaced to. Its values at other nodes are not used;
 * - the point array "SlidingNormal", three components: nodes where it is not 0 slide without
 *   friction in the plane through their rest position to which it is normal, whatever its length
 *   and sign; "SecondSlidingNormal", of the same kind: nodes that have both slide along the line in
 *   both planes, such as where two planes of symmetry meet;
 * - the point array "Force", three components: a force on each node, in N;
 * - the cell arrays "YoungModulus" (Pa), "PoissonRatio" and "Density" (kg/m^3), one component: the
 *   material of each tetrahedron, in place of the properties of these names and of MaterialPreset.
 *
 * vtkMassSpringDeformation has neither prescribed displacements nor nodes that slide: it reports an
 * error where an array says otherwise.
 *
 * @par Port 1, optional, the handles:
 * vtkPointSet. A point is where a handle is now. A point array "RestPosition" of three components
 * says which place of the mesh at rest it holds: the nodes within HandleRadius of it, or the
 * nearest node where that is 0. Points that no tetrahedron uses do not count. Where several handles
 * hold a node the first one counts, and nodes that are fixed stay. A handle moves a node that
 * slides within its plane, or along its line, only.
 *
 * @par Port 2, optional, the sheet:
 * vtkPolyData in world coordinates: triangles, polygons and triangle strips; polylines where
 * SweepVector is set. It cuts the mesh where it is now, along the faces of its tetrahedra that are
 * nearest. What is on both sides of a cut parts: nodes get copies, which are appended. A cut is
 * made when the sheet is new, and cuts add up. Have vtkDeformVolumeFilter open the volume there
 * with OpenSplitsOn().
 *
 * @par Output:
 * The mesh at rest, with the point array "Displacement" (floats, three components, in the units of
 * the points), which is also the active vectors: a vtkFloatArray on a processor, and on a device
 * with memory of its own a vtkDeviceVectorArray. It is the same object, in the same memory, in all
 * executions for one mesh: make a deep copy to keep it as it is. With ElementResults there are cell
 * arrays besides. The first piece is the whole mesh, all others are empty. Points that are
 * appended, those of vtkFiniteElementDeformation and the copies of cuts, follow those of the input.
 *
 * @par Time:
 * Where a time is asked for (UpdateTimeStep(), ParaView's play button), the simulation goes on to
 * it in frames of FrameTime. Where it is earlier than the last one, the simulation restarts from
 * rest and goes on to it with the current handles and loads. Handles go straight to where they are
 * wanted in the first frame. Where no time is asked for, see the subclasses. The output has the
 * time range from 0 to EndTime, unless the inputs have times.
 *
 * @par Changes:
 * Where the rest mesh gets other points or cells, the simulation restarts from rest, with a
 * warning. With other materials, fixed or sliding nodes, forces or prescribed displacements it goes
 * on.
 *
 * @par Abort:
 * An execution that is aborted ends within some 50 ms, with an empty output; what was simulated is
 * kept. Reading the mesh, copying a body of springs to the device and cutting are not interrupted.
 *
 * @par Errors:
 * Each is one vtkErrorMacro that says what is wrong and what to do: no tetrahedra or other
 * three-dimensional cells; tetrahedra that are flat, or some of them inside out; coordinates and
 * numbers that are not finite; a Young modulus or a density of 0 or less, a Poisson ratio of less
 * than 0 or of 0.495 and more; arrays of another shape; nodes that are fixed and slide; prescribed
 * displacements without the array "Fixed", and second normals without first ones; a handle that
 * holds no node; a sheet that vtkCutVolume would refuse. The output is then empty, what was
 * simulated is kept, and a new sheet cuts in the next execution that succeeds. After a failure of
 * memory or of a device the body starts again from rest.
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
  void SetHandlesConnection(vtkAlgorithmOutput* output);
  void SetHandlesData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Connect the sheet that cuts (port 2, optional).
   */
  void SetSheetConnection(vtkAlgorithmOutput* output);
  void SetSheetData(vtkDataObject* data);
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
   * Before the next execution the last cut is taken back, or all are. Copies of nodes are gone
   * then, and the nodes that they were copies of stay where they are. The sheet cuts again when it
   * is another one.
   */
  void UndoCut();
  void ClearCuts();
  ///@}

  ///@{
  /**
   * Cuts that have split something, and the faces of tetrahedra that they have split.
   */
  vtkIdType GetNumberOfCuts();
  vtkIdType GetNumberOfSplitFaces();
  ///@}

  ///@{
  /**
   * Set/Get how far round its rest position a handle holds nodes, in the units of the mesh, at
   * least 0. Default 0: the nearest node.
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
   * Set/Get the Young modulus, in Pa, of tetrahedra that no cell array says one for; greater than
   * 0. Default 10000, a soft tissue.
   */
  vtkSetMacro(YoungModulus, double);
  vtkGetMacro(YoungModulus, double);
  ///@}

  ///@{
  /**
   * Set/Get the Poisson ratio of these, 0 or more and less than 0.495. Default 0.3.
   */
  vtkSetMacro(PoissonRatio, double);
  vtkGetMacro(PoissonRatio, double);
  ///@}

  ///@{
  /**
   * Set/Get the density of these, in kg/m^3, greater than 0. Default 1000.
   */
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}

  /**
   * Tissues whose materials are known. CUSTOM: none of them.
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
   * Set/Get the tissue whose Young modulus (Pa), Poisson ratio and density (kg/m^3) are used in
   * place of the properties of these names, which keep their values. Cell arrays still come first.
   * CUSTOM: the properties are used. Default CUSTOM.
   *
   * The Young moduli are means of measurements at small strains. They differ between people, and
   * between methods of measurement, by a factor of several: Documents/physics.md has the sources
   * and ranges. BONE is cortical bone. Time steps of springs become very short with it.
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
   * The table of presets: the name of a preset, such as "Liver"; the source of its Young modulus,
   * authors and year; and its Young modulus (Pa), Poisson ratio and density (kg/m^3), in this
   * order. CUSTOM has the name "Custom" only. Null, or false and no change, where there is none.
   */
  static const char* GetMaterialPresetName(int preset);
  static const char* GetMaterialPresetSource(int preset);
  static bool GetMaterialPresetValues(int preset, double values[3]);
  ///@}

  /**
   * The units of points.
   */
  enum LengthUnitType
  {
    METRE,
    MILLIMETRE
  };

  ///@{
  /**
   * Set/Get the unit of the mesh, the handles and the displacements: MILLIMETRE (default), as in
   * most medical images, or METRE. A body of less than 1 mm or more than 10 m is warned of.
   */
  vtkSetClampMacro(LengthUnit, int, METRE, MILLIMETRE);
  vtkGetMacro(LengthUnit, int);
  void SetLengthUnitToMetre() { this->SetLengthUnit(METRE); }
  void SetLengthUnitToMillimetre() { this->SetLengthUnit(MILLIMETRE); }
  ///@}

  ///@{
  /**
   * Set/Get how long a frame is, in s, at least 1e-6. Default 1/60.
   */
  vtkSetClampMacro(FrameTime, double, 1e-6, VTK_DOUBLE_MAX);
  vtkGetMacro(FrameTime, double);
  ///@}

  ///@{
  /**
   * Set/Get the end of the time range of the output, in s, where the inputs have no times. A filter
   * behind then asks for a time in each update. Default 0: there is no time range. In ParaView it
   * is 1.
   */
  vtkSetClampMacro(EndTime, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(EndTime, double);
  ///@}

  ///@{
  /**
   * Set/Get whether the output has cell arrays of doubles with what each tetrahedron undergoes:
   * "Stress" (Cauchy, in Pa, the components xx yy zz xy yz xz), "StrainEnergyDensity" (J/m^3 of the
   * volume at rest) and "DeformationGradientDeterminant" (how many times its volume at rest it has;
   * less than 0 where it is inside out). A flat tetrahedron, of a determinant within 1e-12 of 0,
   * has no volume for a stress: its "Stress" is 0. Default: off.
   */
  vtkSetMacro(ElementResults, bool);
  vtkGetMacro(ElementResults, bool);
  vtkBooleanMacro(ElementResults, bool);
  ///@}

  /**
   * The body is put to rest before the next execution, and its time to 0.
   */
  void Reset();

  /**
   * The time that the simulation has come to, in s.
   */
  double GetTime();

  /**
   * Nodes that handles held in the last execution.
   */
  vtkGetMacro(NumberOfHeldNodes, vtkIdType);

  /**
   * What the last execution did, in a few lines of words, for people to read; "" before the first.
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
  /// What subclasses do: give the simulation what it needs besides, and say how far it goes without
  /// a time, in s. They throw deformvolume::Error.
  virtual deformvolume::ElasticSimulation& PrepareSimulation() = 0;
  virtual double GetFreeDuration() = 0;
  ///@}
#endif

private:
  vtkElasticDeformation(const vtkElasticDeformation&) = delete;
  void operator=(const vtkElasticDeformation&) = delete;

  void Execute(vtkInformationVector** input, vtkInformationVector* output);
  /// Returns how many cuts there were before that of the sheet.
  std::size_t UpdateCuts(vtkPolyData* sheet);
  void TakeBackCuts(deformvolume::ElasticSimulation& simulation, std::size_t left);
  /// Goes on to the time that is asked for, if any.
  void Advance(deformvolume::ElasticSimulation& simulation, vtkPointSet* handles,
    vtkInformation* info, deformvolume::ProgressReport& progress);
  /// Warns where a body of so many metres is hardly meant.
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
