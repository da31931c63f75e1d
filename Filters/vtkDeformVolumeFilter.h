// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformVolumeFilter
 * @brief   deform a volume with a tetrahedral mesh or a displacement field
 *
 * vtkDeformVolumeFilter takes a volume at rest and a deformation, and gives the deformed volume as
 * vtkImageData: at full resolution, without holes, with every point array in its own type. It works
 * on an OpenCL device. Documents/deformation.md describes the method (Rodriguez, Leon, Martin and
 * Otaduy, "A parallel resampling method for interactive deformation of volumetric models"), all
 * conventions and all errors.
 *
 * @par Port 0, the volume:
 * vtkImageData at rest with at least two voxels on each axis. The source must announce its extent.
 * All numeric point arrays are deformed, and attributes keep their role; field data pass. Points
 * that vtkGhostType marks as hidden or duplicate are not used, nor are points whose
 * vtkValidPointMask is 0, such as those that an earlier filter of this class has not covered. These
 * arrays are read, too, if they exist:
 * - "ActiveTetrahedra" (cells, unsigned char): bit i is 1 if tetrahedron i of the cell is active.
 *   Cells that vtkGhostType hides have no active tetrahedra, except cells that are hidden by
 *   vtkVolumeEditAlgorithm::BlankCells.
 * - "BoundaryDistance" (points, numeric, one component, any unit): samples where it is negative are
 *   left out. NaN is not negative.
 * - "CutTetrahedra" (cells, unsigned char) and "CutDistance" (points, numeric): a smooth cut, see
 *   vtkCutVolume. It needs the resampler EXACT.
 *
 * A warning names all other cell arrays, which are not resampled.
 *
 * @par Port 1, the deformation, optional:
 * Without a deformation the volume stays at rest, and only its masks and cuts are applied. The
 * deformation is one of:
 * - a mesh: vtkUnstructuredGrid, vtkStructuredGrid, vtkExplicitStructuredGrid, vtkRectilinearGrid,
 *   or a composite dataset of these. Cells other than tetrahedra are split. Cells that vtkGhostType
 *   marks as hidden or duplicate are left out, and cells with a point that it hides or whose
 *   vtkValidPointMask is 0. The points are at rest, and their displacements are a point array of
 *   three components in world units; or they are deformed, see port 2 and PointsAreDeformed.
 * - a displacement field: vtkImageData with a point array of three components in world units. It
 *   may have another grid than the volume. Points that vtkGhostType hides, or whose
 *   vtkValidPointMask is 0, are undefined: voxels whose interpolation needs one are not covered.
 *   See also FieldIsInverse.
 *
 * SetInputArrayToProcess(0, 1, 0, POINTS, name) chooses the displacements. The default is the
 * active vectors. An empty name means the active vectors, or else the only array of three
 * components.
 *
 * @par Port 2, the mesh at rest, optional:
 * A mesh with the cells and the number of points of port 1, whose points are then the deformed
 * positions.
 *
 * @par Port 3, the reference image, optional:
 * vtkImageData whose grid becomes that of the output. Its values are not used. The grid does not
 * follow time: the output keeps the one that was read first.
 *
 * @par Output:
 * The arrays of the volume, and "vtkValidPointMask" (char): 1 where the deformed volume covers a
 * voxel, else 0. Each covered voxel is written by exactly one tetrahedron. Positions are rounded to
 * 1/256 of an output voxel. Without deformation the output equals the volume bit for bit. Where the
 * volume folds over itself, upright tetrahedra win over inverted ones, then cells with lower
 * indices over those with higher ones.
 *
 * @par Pieces and ranks:
 * The filter can produce any part of its output. Under MPI each rank produces its piece, which
 * equals that part of the whole output bit for bit. All ranks have to update together.
 * Documents/parallel.md describes which inputs are read.
 *
 * @par Errors:
 * An update that fails reports one error, which says what is wrong and what to do. The output is
 * then empty, and the filter works again after the cause is corrected.
 *
 * @sa vtkLatticeTetrahedraSource vtkTetGenMesher vtkDeformGeometryFilter
 */
#ifndef vtkDeformVolumeFilter_h
#define vtkDeformVolumeFilter_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkImageAlgorithm.h"
#include "vtkWrappingHints.h" // for VTK_NEWINSTANCE

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkStringArray;

class VTKDEFORMVOLUME_EXPORT vtkDeformVolumeFilter : public vtkImageAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkDeformVolumeFilter* New();
  vtkTypeMacro(vtkDeformVolumeFilter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the deformation (port 1), its mesh at rest (port 2) and the reference image (port 3).
   * All are optional.
   */
  void SetDeformationConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  /// Set the data object of port 1 itself, without a pipeline.
  void SetDeformationData(vtkDataObject* data) { this->SetInputDataInternal(1, data); }
  /// Connect the mesh at rest (port 2, optional).
  void SetRestConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  /// Set the data object of port 2 itself, without a pipeline.
  void SetRestData(vtkDataObject* data) { this->SetInputDataInternal(2, data); }
  /// Connect the reference image (port 3, optional).
  void SetReferenceConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(3, output); }
  /// Set the data object of port 3 itself, without a pipeline.
  void SetReferenceData(vtkDataObject* data) { this->SetInputDataInternal(3, data); }
  ///@}

  ///@{
  /**
   * Set/Get a factor on the displacements of port 1. Not used with port 2. Default: 1.
   */
  vtkSetMacro(DisplacementScale, double);
  vtkGetMacro(DisplacementScale, double);
  ///@}

  ///@{
  /**
   * Set/Get whether the points of the mesh on port 1 are deformed already, as vtkExodusIIReader
   * gives them if the name of the displacements begins with dis or DIS. The rest positions are then
   * the points minus the displacements. An error with port 2 and with a field. Default: off.
   */
  vtkSetMacro(PointsAreDeformed, bool);
  vtkGetMacro(PointsAreDeformed, bool);
  vtkBooleanMacro(PointsAreDeformed, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether a displacement field is inverse: it leads from a point of the output to the
   * point of the volume that is seen there, as registration programs write it. The field is
   * evaluated, not inverted. Needs the resampler MESH_RASTERIZATION or AUTOMATIC. Not used with a
   * mesh. Default: off.
   */
  vtkSetMacro(FieldIsInverse, bool);
  vtkGetMacro(FieldIsInverse, bool);
  vtkBooleanMacro(FieldIsInverse, bool);
  ///@}

  /**
   * Bounds that determine the extent of the output, see SetOutputBoundsMode().
   */
  enum OutputBoundsModes
  {
    DEFORMED_BOUNDS = 0,
    VOLUME_BOUNDS = 1,
    CUSTOM_BOUNDS = 2
  };

  ///@{
  /**
   * Set/Get which bounds determine the extent of the output: those of the deformed volume, those of
   * the volume at rest, or the box CustomBounds (x min, x max, y min, y max, z min, z max, in world
   * coordinates). DEFORMED_BOUNDS contains the deformed volume at all times that were requested so
   * far. With a reference image, OutputBoundsMode, Padding, BoundsGranularity and OutputSpacingMode
   * have no effect, and a warning names those that are set. Defaults: DEFORMED_BOUNDS; -1, 1, -1,
   * 1, -1, 1.
   */
  vtkSetClampMacro(OutputBoundsMode, int, DEFORMED_BOUNDS, CUSTOM_BOUNDS);
  vtkGetMacro(OutputBoundsMode, int);
  void SetOutputBoundsModeToDeformedBounds() { this->SetOutputBoundsMode(DEFORMED_BOUNDS); }
  void SetOutputBoundsModeToVolumeBounds() { this->SetOutputBoundsMode(VOLUME_BOUNDS); }
  void SetOutputBoundsModeToCustomBounds() { this->SetOutputBoundsMode(CUSTOM_BOUNDS); }
  /// Set/Get the box of CUSTOM_BOUNDS, in world coordinates. Default: -1, 1, -1, 1, -1, 1.
  vtkSetVector6Macro(CustomBounds, double);
  vtkGetVector6Macro(CustomBounds, double);
  ///@}

  ///@{
  /**
   * Set/Get how many output voxels are added on each side, so that isosurfaces close. Default: 0,
   * range 0 to 1000.
   */
  vtkSetClampMacro(Padding, int, 0, 1000);
  vtkGetMacro(Padding, int);
  ///@}

  ///@{
  /**
   * Set/Get a number of voxels. Deformed bounds are rounded outwards to its multiples, so that the
   * extent does not change while the body moves a little. Incremental and viewers need such an
   * extent. 0 and 1: off. Default: 0, range 0 to 1000.
   */
  vtkSetClampMacro(BoundsGranularity, int, 0, 1000);
  vtkGetMacro(BoundsGranularity, int);
  ///@}

  /**
   * Spacings of the output, see SetOutputSpacingMode().
   */
  enum OutputSpacingModes
  {
    VOLUME_SPACING = 0,
    CUSTOM_SPACING = 1
  };

  ///@{
  /**
   * Set/Get whether the output has the volume's spacing or CustomSpacing, which is in world units
   * and greater than 0. Index 0 stays at the volume's origin. Defaults: VOLUME_SPACING; 1, 1, 1.
   */
  vtkSetClampMacro(OutputSpacingMode, int, VOLUME_SPACING, CUSTOM_SPACING);
  vtkGetMacro(OutputSpacingMode, int);
  void SetOutputSpacingModeToVolumeSpacing() { this->SetOutputSpacingMode(VOLUME_SPACING); }
  void SetOutputSpacingModeToCustomSpacing() { this->SetOutputSpacingMode(CUSTOM_SPACING); }
  /// Set/Get the spacing of CUSTOM_SPACING, in world units, greater than 0. Default: 1, 1, 1.
  vtkSetVector3Macro(CustomSpacing, double);
  vtkGetVector3Macro(CustomSpacing, double);
  ///@}

  /**
   * What happens to the volume outside the deformation, see SetOutsideMode().
   */
  enum OutsideModes
  {
    DISCARD = 0,
    EXTRAPOLATE = 1,
    KEEP = 2
  };

  ///@{
  /**
   * Set/Get what happens to the volume outside the deformation mesh or field.
   * - DISCARD: voxels outside are left out. The deformed volume ends where the deformed mesh ends,
   *   to 1/128 output voxel.
   * - EXTRAPOLATE: each voxel outside follows the tetrahedron of the nearest voxel inside the mesh,
   *   or the nearest point of the field.
   * - KEEP: voxels outside do not move, except that the displacement fades to zero within
   *   FadeDistance, in world units, of the mesh at rest or of the grid of the field. A FadeDistance
   *   of less than twice the largest displacement may fold the volume. With 0 no voxel outside
   *   moves. Negative, infinite and NaN distances are errors. KEEP is an error for meshes with
   *   OpenSplits or MESH_RASTERIZATION.
   *
   * Defaults: DISCARD; 0.
   */
  vtkSetClampMacro(OutsideMode, int, DISCARD, KEEP);
  vtkGetMacro(OutsideMode, int);
  void SetOutsideModeToDiscard() { this->SetOutsideMode(DISCARD); }
  void SetOutsideModeToExtrapolate() { this->SetOutsideMode(EXTRAPOLATE); }
  void SetOutsideModeToKeep() { this->SetOutsideMode(KEEP); }
  /// Set/Get the distance within which the displacement fades to zero with KEEP, in world units.
  /// Default: 0.
  vtkSetMacro(FadeDistance, double);
  vtkGetMacro(FadeDistance, double);
  ///@}

  /**
   * Interpolations of arrays that are not categorical, see SetInterpolation().
   */
  enum Interpolations
  {
    LINEAR_INTERPOLATION = 0,
    CUBIC_INTERPOLATION = 1,
    NEAREST_INTERPOLATION = 2
  };

  ///@{
  /**
   * Set/Get the interpolation of arrays that are not categorical: linear; cubic (Catmull-Rom, over
   * four voxels on each axis; linear if one of these 64 voxels does not exist, or if they lie on
   * different sides of a cut); or nearest, which treats every array as categorical. With an inverse
   * field or MESH_RASTERIZATION, voxels beyond the border are extrapolated linearly instead.
   * Integers are rounded to the nearest. Default: LINEAR_INTERPOLATION.
   */
  vtkSetClampMacro(Interpolation, int, LINEAR_INTERPOLATION, NEAREST_INTERPOLATION);
  vtkGetMacro(Interpolation, int);
  void SetInterpolationToLinearInterpolation() { this->SetInterpolation(LINEAR_INTERPOLATION); }
  void SetInterpolationToCubicInterpolation() { this->SetInterpolation(CUBIC_INTERPOLATION); }
  void SetInterpolationToNearestInterpolation() { this->SetInterpolation(NEAREST_INTERPOLATION); }
  ///@}

  ///@{
  /**
   * Set/Get the value of output voxels outside the deformed volume, in every component of every
   * array, clamped to the range of the array's type. Default: 0.
   */
  vtkSetMacro(BackgroundValue, double);
  vtkGetMacro(BackgroundValue, double);
  ///@}

  ///@{
  /**
   * Names of point arrays that hold labels. Labels are not interpolated: each is that of one voxel
   * of the cell, usually the nearest one. Labels of 64 bits keep all bits. A name that the volume
   * does not have is a warning. Default: none.
   */
  void AddCategoricalArray(const char* name);
  /// Remove one name.
  void RemoveCategoricalArray(const char* name);
  /// Remove all names.
  void ClearCategoricalArrays();
  int GetNumberOfCategoricalArrays();
  const char* GetCategoricalArray(int index);
  ///@}

  ///@{
  /**
   * Names of point arrays that hold amounts per unit of volume, such as a dose. Their values are
   * divided by the change of volume, so that their sum is kept. They are 0, and not
   * BackgroundValue, where the deformed volume covers no voxel or is inside out. The output array
   * is of type double if the array of the volume is, else of type float. It is an error if an array
   * is missing or categorical, and for meshes with MESH_RASTERIZATION. Default: none.
   */
  void AddDensityArray(const char* name);
  /// Remove one name.
  void RemoveDensityArray(const char* name);
  /// Remove all names.
  void ClearDensityArrays();
  int GetNumberOfDensityArrays();
  const char* GetDensityArray(int index);
  ///@}

  ///@{
  /**
   * Set/Get whether the output has a point array "RestPosition" (three components): the world
   * coordinates at rest of the tissue at a voxel, to 1/256 of an output voxel. Their type is float,
   * or double if a coordinate of the volume is over 16,384 times the spacing. Default: off.
   */
  vtkSetMacro(GenerateRestPositions, bool);
  vtkGetMacro(GenerateRestPositions, bool);
  vtkBooleanMacro(GenerateRestPositions, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether the output has a point array "Jacobian" (float): the determinant of the
   * derivative of deformed by rest positions. A value of 2 means twice the volume, a negative value
   * an inverted tetrahedron. It is an error for meshes with MESH_RASTERIZATION. Default: off.
   */
  vtkSetMacro(GenerateJacobian, bool);
  vtkGetMacro(GenerateJacobian, bool);
  vtkBooleanMacro(GenerateJacobian, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether the output has a point array "FoldCount" (unsigned int): the number of
   * tetrahedra of the sampling mesh that contain a voxel. More than 1 means a fold. With an inverse
   * field it is 1 at each covered voxel and does not show folds: the Jacobian is negative there. It
   * is an error for meshes with MESH_RASTERIZATION. Default: off.
   */
  vtkSetMacro(GenerateFoldCount, bool);
  vtkGetMacro(GenerateFoldCount, bool);
  vtkBooleanMacro(GenerateFoldCount, bool);
  ///@}

  ///@{
  /**
   * Get counters of the last execution: voxels of the output that the deformed volume covers;
   * tetrahedra that the deformation turned inside out (of the sampling mesh, of the deformation
   * mesh at its boundary and with MESH_RASTERIZATION, or of the grid of an inverse field), where
   * parts of the volume are seen twice; tetrahedra of the deformation mesh without volume at rest,
   * which are skipped; and voxels of tissue that is missing in the output because other tissue lies
   * at the same place, where the volume folds or where the sides of a cut overlap. The last number
   * is 0 with an inverse field and after an incremental update, which do not count them.
   */
  vtkGetMacro(NumberOfCoveredVoxels, vtkIdType);
  vtkGetMacro(NumberOfInvertedTetrahedra, vtkIdType);
  vtkGetMacro(NumberOfFlatTetrahedra, vtkIdType);
  vtkGetMacro(NumberOfHiddenVoxels, vtkIdType);
  ///@}

  ///@{
  /**
   * Get an extent of the output that contains all voxels that the last execution may have changed:
   * the whole output, or less after an incremental update. Empty (0, -1, 0, -1, 0, -1) if nothing
   * has changed, and after a failure. Under MPI it refers to the piece of this rank.
   */
  vtkGetVector6Macro(ChangedExtent, int);
  ///@}

  /**
   * Get statistics of the last execution as text, with one "name: value" in each line, such as
   * "Seconds for resampling"; "" before the first execution. Times are those of this rank. Counts
   * are summed over the ranks.
   */
  std::string GetSummary();

  /**
   * How the deformed volume is resampled, see SetResampler().
   */
  enum Resamplers
  {
    EXACT = 0,
    MESH_RASTERIZATION = 2,
    AUTOMATIC = 3
  };

  ///@{
  /**
   * Set/Get how the deformed volume is resampled.
   * - EXACT: the tetrahedra of the sampling mesh are rasterized.
   * - MESH_RASTERIZATION: the tetrahedra of the deformation mesh are rasterized, and the volume is
   *   sampled at the rest position of each output voxel. It takes less memory. Not for forward
   *   fields, nor for meshes with EXTRAPOLATE or KEEP.
   * - AUTOMATIC: EXACT, unless the field is inverse, or the memory suffices for MESH_RASTERIZATION
   *   only.
   *
   * The value 1 is an error. Default: AUTOMATIC. ResamplerInUse is the resampler of the last
   * execution; AUTOMATIC before the first.
   */
  void SetResampler(int resampler);
  int GetResamplerMinValue() { return EXACT; }
  int GetResamplerMaxValue() { return AUTOMATIC; }
  vtkGetMacro(Resampler, int);
  void SetResamplerToExact() { this->SetResampler(EXACT); }
  void SetResamplerToMeshRasterization() { this->SetResampler(MESH_RASTERIZATION); }
  void SetResamplerToAutomatic() { this->SetResampler(AUTOMATIC); }
  vtkGetMacro(ResamplerInUse, int);
  ///@}

  ///@{
  /**
   * Set/Get whether a gap opens where the deformation mesh is split, as after a cut: tetrahedra of
   * the sampling mesh with vertices on both sides are left out. Off: they are stretched over the
   * gap. Default: off.
   */
  vtkSetMacro(OpenSplits, bool);
  vtkGetMacro(OpenSplits, bool);
  vtkBooleanMacro(OpenSplits, bool);
  ///@}

  ///@{
  /**
   * Set/Get which voxels the filter uses: all (1), or every second (2) or fourth one (4) on each
   * axis, for fast previews while something moves. Other values are an error. The output's spacing
   * is larger by the factor, except with a reference image. The data that the filter keeps between
   * updates are kept for each factor. Default: 1.
   */
  vtkSetMacro(SamplingFactor, int);
  vtkGetMacro(SamplingFactor, int);
  ///@}

  ///@{
  /**
   * Set/Get whether an update resamples only the parts of the volume that a changed deformation or
   * mask affects. The result has the same bits. Needs the resampler EXACT and an output of the same
   * extent as the last one. A program that writes values of the output works on a copy, or calls
   * Modified() of each array that it has written: otherwise the next update keeps these values
   * where nothing changes. Default: on.
   */
  vtkSetMacro(Incremental, bool);
  vtkGetMacro(Incremental, bool);
  vtkBooleanMacro(Incremental, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether the arrays of the output stay in the memory of a device that has its own until
   * somebody reads them. They have all interfaces of vtkDataArray, but their class is not one of
   * VTK's own. No effect on CPU devices. Default: off.
   */
  vtkSetMacro(OutputOnDevice, bool);
  vtkGetMacro(OutputOnDevice, bool);
  vtkBooleanMacro(OutputOnDevice, bool);
  ///@}

  ///@{
  /**
   * Set/Get the OpenCL device: "" or "best" for the best one, or for the one that the environment
   * variable DEFORMVOLUME_DEVICE names; "cpu" or "gpu" for the best one of that kind; or a part of
   * a device's name, without regard to case. It is an error if there is no such device. Default:
   * "". DeviceInUse is the name of the device of the last execution; "" before the first.
   * GetDeviceNames() lists the devices of this machine, the best first, in an array that belongs to
   * the caller. In a process that was forked after the first use of a device it is empty, with a
   * warning.
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  vtkGetMacro(DeviceInUse, std::string);
  /// Get the names of the devices of this machine, the best first. The array belongs to the caller.
  static VTK_NEWINSTANCE vtkStringArray* GetDeviceNames();
  ///@}

  ///@{
  /**
   * Set/Get how many bytes of device memory may be used; 0: the available memory. An update that
   * needs more is an error before anything is allocated. Default: 0. GetDeviceMemory() returns the
   * bytes that this filter holds on the device. ReleaseDeviceMemory() frees them; the next update
   * sends everything again.
   */
  vtkSetClampMacro(MemoryLimit, vtkTypeInt64, 0, VTK_TYPE_INT64_MAX);
  vtkGetMacro(MemoryLimit, vtkTypeInt64);
  /// Get the bytes that this filter holds on the device.
  vtkTypeInt64 GetDeviceMemory();
  /// Free what this filter holds on the device. The next update sends everything again.
  void ReleaseDeviceMemory();
  ///@}

  /**
   * Set a property by its name in state files and scripts of ParaView. Properties that were removed
   * are ignored, with a warning if their value is not the former default.
   */
  void SetFromState(const char* property, int value);

protected:
  vtkDeformVolumeFilter();
  ~vtkDeformVolumeFilter() override;

  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** input,
    vtkInformationVector* output, int requestFromOutputPort, vtkMTimeType* mtime) override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

private:
  vtkDeformVolumeFilter(const vtkDeformVolumeFilter&) = delete;
  void operator=(const vtkDeformVolumeFilter&) = delete;

  double DisplacementScale = 1.0;
  bool PointsAreDeformed = false;
  bool FieldIsInverse = false;
  int OutputBoundsMode = DEFORMED_BOUNDS;
  double CustomBounds[6] = { -1.0, 1.0, -1.0, 1.0, -1.0, 1.0 };
  int Padding = 0;
  int BoundsGranularity = 0;
  int OutputSpacingMode = VOLUME_SPACING;
  double CustomSpacing[3] = { 1.0, 1.0, 1.0 };
  int SamplingFactor = 1;
  double BackgroundValue = 0.0;
  int OutsideMode = DISCARD;
  double FadeDistance = 0.0;
  int Resampler = AUTOMATIC;
  int Interpolation = LINEAR_INTERPOLATION;
  bool GenerateRestPositions = false;
  bool GenerateJacobian = false;
  bool GenerateFoldCount = false;
  bool OpenSplits = false;
  bool Incremental = true;
  bool OutputOnDevice = false;
  std::string Device;
  vtkTypeInt64 MemoryLimit = 0;

  vtkIdType NumberOfInvertedTetrahedra = 0;
  vtkIdType NumberOfHiddenVoxels = 0;
  vtkIdType NumberOfFlatTetrahedra = 0;
  vtkIdType NumberOfCoveredVoxels = 0;
  int ChangedExtent[6] = { 0, -1, 0, -1, 0, -1 };
  int ResamplerInUse = AUTOMATIC;
  std::string DeviceInUse;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
