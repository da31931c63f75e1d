// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChainMailDeformation
 * @brief   drag the tissue of a volume, with a stiffness that follows the image
 *
 * vtkChainMailDeformation moves the voxels of a volume by ChainMail. Each voxel is linked to its
 * six neighbors. A link may be stretched, compressed and sheared within the limits of the materials
 * at its ends. It moves its ends only if a limit would be exceeded. Handles hold voxels and move
 * them; other voxels follow, each by as little as possible. Then relaxation evens out the
 * displacements. An execution is one step: displacements are kept from one execution to the next,
 * so that a drag continues. If no property, no position of a handle and no array that is used has
 * changed, as when another piece or another time is requested, the output of the last step is given
 * again. Call Modified() to continue the relaxation if nothing else has changed.
 *
 * The output is a displacement field for vtkDeformVolumeFilter (SetDeformationConnection). The time
 * of a step depends on the number of voxels that move, not on the size of the volume.
 *
 * @par Port 0, the volume:
 * vtkImageData at rest, of at least two voxels on each axis: any extent, origin, spacing and
 * direction matrix. The whole volume is requested. These arrays are used, all of them optional:
 * - a point array of one component with the materials, see MaterialArrayName;
 * - a point array "Pinned" of one component, any numeric type: voxels where it is not 0 do not
 *   move;
 * - a cell array "ActiveTetrahedra" (unsigned char, one component; bit i stands for tetrahedron i
 *   of the cell), and hidden cells, as vtkDeformVolumeFilter reads them. A link exists if one of
 *   the up to four tetrahedra with this edge is active. Bodies without a common voxel never move
 *   each other.
 *
 * @par Port 1, optional, the handles:
 * vtkPointSet. Each point is the current position of a handle. The point array "RestPosition" of
 * three components, any numeric type, is the position at rest of the tissue that a handle holds:
 * all voxels within HandleRadius of this position, and at least the nearest one. Both are world
 * coordinates. A handle displaces its voxels by the difference, at most 4095 voxels on each axis.
 * The voxels of a removed handle are free, and do not move until other voxels move them or they
 * relax.
 *
 * @par Output:
 * vtkImageData with the geometry of the volume, always the whole extent, with the point array
 * "Displacement" (float, three components, world units), which is also the active vectors. On CPU
 * devices it is a vtkFloatArray. On a device with memory of its own it is a vtkDeviceVectorArray,
 * whose values stay on the device until somebody accesses them. Displacements are multiples of
 * 1/65536 of the spacing, along the axes of the volume. The array is the same object, in the same
 * memory, in all executions with one geometry, and an execution writes only values that change
 * (GetChangedExtent()): make a deep copy to keep the values. Values that others write to a
 * vtkDeviceVectorArray are lost in the next execution.
 *
 * @par Reduced and released handles: The displacement of a handle is reduced, on each axis
 * separately, until no pinned voxel and no handle before it in the list would have to move. If
 * there is no such displacement, the handle is released. Both are counted
 * (GetNumberOfReducedHandles(), GetNumberOfReleasedHandles()). A handle that holds no voxel that
 * can move counts as released, and a warning says so. If the materials or the active tetrahedra
 * change so that displacements exceed the limits, all displacements are set to 0 before the step.
 *
 * @par Errors:
 * Each error is reported by one vtkErrorMacro. The output is then empty, and the displacements are
 * kept. Errors are: composite data; a volume that is flat or has no valid spacing; arrays of
 * another shape or type; a label that has no material; limits that exclude a link at rest; handles
 * with coordinates that are not finite, outside the volume at rest or displaced too far; too little
 * memory; and failures of the device, after which the displacements are lost.
 *
 * The volume takes 15 bytes per voxel on the device, in blocks of 8 x 8 x 8 voxels, and the output
 * takes 12 bytes per voxel. Under MPI each rank works on a whole volume.
 *
 * Sources: Gibson, "3D ChainMail: a fast algorithm for deforming volumetric objects" (1997), for
 * the model; Documents/chainmail.md for the scheme.
 *
 * @sa vtkDeformVolumeFilter
 */
#ifndef vtkChainMailDeformation_h
#define vtkChainMailDeformation_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkImageAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class VTKDEFORMVOLUME_EXPORT vtkChainMailDeformation : public vtkImageAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkChainMailDeformation* New();
  vtkTypeMacro(vtkChainMailDeformation, vtkImageAlgorithm);
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
   * Set/Get the distance from its rest position within which a handle holds voxels, in world units,
   * at least 0. Default: 0, only the nearest voxel.
   */
  vtkSetClampMacro(HandleRadius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(HandleRadius, double);
  ///@}

  ///@{
  /**
   * Set the limits of a material, as fractions of the spacing. minimumStretch, 0 to 1, and
   * maximumStretch, 1 to 1000: the least and the largest length of a link along its axis, which is
   * 1 at rest. shear, 0 to 1000: how far the ends of a link may move relative to each other across
   * its axis. Other values are an error in the next execution. index: an integer from 0 to 255,
   * passed as a double because panels of ParaView pass only doubles. A link between two materials
   * has the mean of their limits. To keep tetrahedra upright the shear should be less than half of
   * the minimum stretch.
   *
   * There are five materials by default. Their limits are engineering values, not measurements: 0,
   * air: 0.1, 2, 1; 1, soft tissue: 0.5, 1.5, 0.5; 2, muscle: 0.8, 1.2, 0.2; 3, cartilage: 0.95,
   * 1.05, 0.05; 4, bone: 0.99, 1.01, 0.01.
   */
  void SetMaterial(double index, double minimumStretch, double maximumStretch, double shear);
  /**
   * Get the limits of a material in the order of SetMaterial(). Returns false, and does not change
   * `limits`, if the material is not defined.
   */
  bool GetMaterialLimits(int index, double limits[3]);
  /**
   * Remove all materials, the default ones included.
   */
  void ClearMaterials();
  int GetNumberOfMaterials();
  ///@}

  ///@{
  /**
   * Set/Get the name of the point array of the volume with the material of each voxel; any numeric
   * type. Without ranges (AddMaterialRange()) its values are indices of materials. "": with ranges
   * the active scalars, without ranges DefaultMaterial for all voxels. Default: "".
   */
  vtkSetMacro(MaterialArrayName, std::string);
  vtkGetMacro(MaterialArrayName, std::string);
  ///@}

  ///@{
  /**
   * Add a range of values: voxels with a value of at least minimum and less than maximum have the
   * material with this index, an integer from 0 to 255. The first range that contains a value is
   * used. Voxels with other values have the DefaultMaterial.
   */
  void AddMaterialRange(double minimum, double maximum, double index);
  /// Remove all ranges.
  void ClearMaterialRanges();
  int GetNumberOfMaterialRanges();
  ///@}

  ///@{
  /**
   * Set/Get the index of the material of voxels without another material. Default: 1, soft tissue.
   */
  vtkSetClampMacro(DefaultMaterial, int, 0, 255);
  vtkGetMacro(DefaultMaterial, int);
  ///@}

  ///@{
  /**
   * Set/Get the number of relaxation sweeps in an execution. A sweep visits the blocks of 8 x 8 x 8
   * voxels that a drag has moved in the last 30 executions. Default: 5, range 0 to 10000.
   */
  vtkSetClampMacro(RelaxationSweeps, int, 0, 10000);
  vtkGetMacro(RelaxationSweeps, int);
  ///@}

  ///@{
  /**
   * Set/Get the part of the way to the weighted mean of its neighbors that a voxel moves in a
   * relaxation sweep, 0 to 1. Stiffer links have greater weights. Default: 1.
   */
  vtkSetClampMacro(Elasticity, double, 0.0, 1.0);
  vtkGetMacro(Elasticity, double);
  ///@}

  ///@{
  /**
   * Set/Get the plasticity threshold, as a fraction of the spacing, at least 0. Relaxation does not
   * move a voxel on an axis on which it is nearer than this to the weighted mean of its neighbors.
   * 0: every body with a pinned voxel finally returns to rest. Default: 0.
   */
  vtkSetClampMacro(PlasticityThreshold, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(PlasticityThreshold, double);
  ///@}

  /**
   * Move all voxels back to rest before the next step.
   */
  void Reset();

  ///@{
  /**
   * Save the displacements of all voxels as a state, and restore a state bit for bit before the
   * next step, for example to undo a drag. SaveState() returns the number of the state, or -1 after
   * an error. A state takes 6 KiB for each block of 8 x 8 x 8 voxels that has moved since the last
   * state. RestoreState() and RemoveState() return false if there is no such state. RestoreState()
   * also returns false if the voxel grid of the volume has changed. If a restored state violates
   * the current limits, all voxels are moved back to rest.
   */
  vtkIdType SaveState();
  /// Restore a state before the next step. Returns false if there is no such state.
  bool RestoreState(vtkIdType state);
  /// Remove a state. Returns false if there is no such state.
  bool RemoveState(vtkIdType state);
  int GetNumberOfStates();
  ///@}

  /**
   * Get the host memory of all states, in bytes.
   */
  vtkTypeInt64 GetStateMemory();

  ///@{
  /**
   * Set/Get the OpenCL device, see vtkDeformVolumeFilter::SetDevice(). Displacements are bit for
   * bit the same on all devices. A change of device moves all voxels back to rest. Default: "", the
   * best device.
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  ///@}

  ///@{
  /**
   * Set/Get how many bytes of device memory may be used; 0: the available memory. A volume that
   * needs more is an error before anything is allocated. Default 0.
   */
  vtkSetClampMacro(MemoryLimit, vtkTypeInt64, 0, VTK_TYPE_INT64_MAX);
  vtkGetMacro(MemoryLimit, vtkTypeInt64);
  ///@}

  ///@{
  /**
   * Get results of the last step: the largest violation of a limit by a voxel that moved, as a
   * fraction of the spacing, which is 0 if the filter works correctly; the number of rounds over
   * active blocks and relaxation sweeps; the number of voxels that moved; and the numbers of
   * handles that were reduced and released. After an error they are 0.
   */
  vtkGetMacro(LargestViolation, double);
  vtkGetMacro(NumberOfSweeps, vtkIdType);
  vtkGetMacro(NumberOfMovedVoxels, vtkIdType);
  vtkGetMacro(NumberOfReducedHandles, int);
  vtkGetMacro(NumberOfReleasedHandles, int);
  ///@}

  ///@{
  /**
   * Get the extent of the output, in structured indices, in which the last step may have
   * changed displacements; (0, -1, 0, -1, 0, -1) if nothing has changed.
   */
  vtkGetVector6Macro(ChangedExtent, int);
  ///@}

  /**
   * Get the name of the device of the last execution; "" before the first, and after an error.
   */
  vtkGetMacro(DeviceInUse, std::string);

  /**
   * Get the device and the counters of the last execution as text; "" before the first, and after
   * an error.
   */
  std::string GetSummary();

protected:
  vtkChainMailDeformation();
  ~vtkChainMailDeformation() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** input,
    vtkInformationVector* output, int requestFromOutputPort, vtkMTimeType* mtime) override;

private:
  vtkChainMailDeformation(const vtkChainMailDeformation&) = delete;
  void operator=(const vtkChainMailDeformation&) = delete;

  double HandleRadius = 0.0;
  std::string MaterialArrayName;
  int DefaultMaterial = 1;
  int RelaxationSweeps = 5;
  double Elasticity = 1.0;
  double PlasticityThreshold = 0.0;
  std::string Device;
  vtkTypeInt64 MemoryLimit = 0;

  double LargestViolation = 0.0;
  vtkIdType NumberOfSweeps = 0;
  vtkIdType NumberOfMovedVoxels = 0;
  int NumberOfReducedHandles = 0;
  int NumberOfReleasedHandles = 0;
  int ChangedExtent[6] = { 0, -1, 0, -1, 0, -1 };
  std::string DeviceInUse;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
