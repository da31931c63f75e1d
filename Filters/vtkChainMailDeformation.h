// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChainMailDeformation
 * @brief   drag the tissue of a volume, with a stiffness that follows the image
 *
 * vtkChainMailDeformation moves the voxels of a volume by ChainMail. Each voxel is linked to its
 * six neighbours. A link may be stretched, compressed and sheared within the limits of the
 * materials at its ends, and moves its ends only where a limit would be exceeded. Handles hold
 * voxels and move them; other voxels follow, each by as little as possible. Then relaxation evens
 * out the displacements. An execution is one step: displacements are kept from one execution to the
 * next, so that a drag continues. Call Modified() to relax on where nothing else has changed.
 *
 * The output is a displacement field for vtkDeformVolumeFilter (SetDeformationConnection). A step
 * takes time for the voxels that move, not for the volume.
 *
 * @par Port 0, the volume:
 * vtkImageData at rest, of at least two voxels on each axis: any extent, origin, spacing and
 * direction matrix. It is asked for whole. These arrays are used, all of them optional:
 * - a point array of one component with the materials, see MaterialArrayName;
 * - a point array "Pinned" of one component, any numeric type: voxels where it is not 0 do not
 *   move;
 * - a cell array "ActiveTetrahedra" (unsigned char, one component; bit i stands for tetrahedron i
 *   of the cell), and hidden cells, as vtkDeformVolumeFilter reads them. A link is there if one of
 *   the up to four tetrahedra that have it as an edge is active. Bodies that have no voxel in
 *   common never move each other.
 *
 * @par Port 1, optional, the handles:
 * vtkPointSet. A point is where a handle is now. A point array "RestPosition" of three components,
 * any numeric type, is the position in the volume at rest that it holds: all voxels within
 * HandleRadius of that, and at least the nearest one. Both are world coordinates. A handle
 * displaces its voxels by the difference, at most 4095 voxels on each axis. Voxels of a handle that
 * is no longer there are free, and stay until they are moved or relax.
 *
 * @par Output:
 * vtkImageData on the lattice of the volume, always whole, with the point array "Displacement"
 * (floats, three components, world units), which is also the active vectors: a vtkFloatArray on a
 * processor, and on a device with memory of its own a vtkDeviceVectorArray, whose values stay there
 * until somebody asks for them. Displacements are whole multiples of 1/65536 of the spacing, along
 * the axes of the volume. The array is the same object, in the same memory, in all executions on
 * one lattice, and an execution writes only what it changes (GetChangedExtent()): make a deep copy
 * to keep it as it is. What others write to a vtkDeviceVectorArray is gone after the next
 * execution.
 *
 * @par What cannot be done:
 * The displacement of a handle is reduced, on each axis by itself, until no pinned voxel and no
 * handle before it in the list would have to move. Where no displacement would do, the handle is
 * released. Both are counted (GetNumberOfReducedHandles(), GetNumberOfReleasedHandles()). Where the
 * materials or the active tetrahedra change so that displacements exceed the limits, all of them
 * are put to 0 before the step.
 *
 * @par Errors:
 * Each is one vtkErrorMacro that says what is wrong and what to do, the output is then empty, and
 * the displacements are kept: a volume that is flat or has no valid spacing; arrays of another
 * shape or type; a label that has no material; limits that no link at rest meets; handles with
 * coordinates that are not finite, outside the volume at rest or displaced too far; too little
 * memory; and what goes wrong on the device, after which the displacements are lost.
 *
 * The volume takes 15 bytes a voxel on the device, in blocks of 8 x 8 x 8 voxels, and the output 12
 * bytes. Under MPI each rank works on a whole volume.
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
  void SetHandlesConnection(vtkAlgorithmOutput* output);
  void SetHandlesData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Set/Get how far round its rest position a handle holds voxels, in world units, at least 0.
   * Default 0: the nearest voxel.
   */
  vtkSetClampMacro(HandleRadius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(HandleRadius, double);
  ///@}

  ///@{
  /**
   * The limits of a material, as fractions of the spacing: the shortest and the longest that a link
   * may be along its axis (at rest it is 1), and how far its ends may move past each other across
   * it. index: a whole number from 0 to 255 (a double, since panels of ParaView pass nothing else);
   * minimumStretch: 0 to 1; maximumStretch: 1 to 1000; shear: 0 to 1000; others are an error of the
   * next execution. A link between two materials has the mean of their limits. To keep tetrahedra
   * upright the shear should be less than half of the minimum stretch.
   *
   * There are five materials by default, all of them engineering values: 0, air: 0.1, 2, 1;
   * 1, soft tissue: 0.5, 1.5, 0.5; 2, muscle: 0.8, 1.2, 0.2; 3, cartilage: 0.95, 1.05, 0.05;
   * 4, bone: 0.99, 1.01, 0.01.
   */
  void SetMaterial(double index, double minimumStretch, double maximumStretch, double shear);
  /**
   * The limits of a material, in this order; false, and no change, where there is none.
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
   * type. Without ranges (AddMaterialRange()) its values are indices of materials. "": the active
   * scalars where there are ranges, and DefaultMaterial everywhere where there are none. Default
   * "".
   */
  vtkSetMacro(MaterialArrayName, std::string);
  vtkGetMacro(MaterialArrayName, std::string);
  ///@}

  ///@{
  /**
   * Voxels with a value of minimum or more, and less than maximum, have a material. The first range
   * that holds a value counts; where none does, DefaultMaterial. The index is a whole number from 0
   * to 255.
   */
  void AddMaterialRange(double minimum, double maximum, double index);
  void ClearMaterialRanges();
  int GetNumberOfMaterialRanges();
  ///@}

  ///@{
  /**
   * Set/Get the index of the material of voxels that have no other one. Default 1, soft tissue.
   */
  vtkSetClampMacro(DefaultMaterial, int, 0, 255);
  vtkGetMacro(DefaultMaterial, int);
  ///@}

  ///@{
  /**
   * Set/Get the sweeps of relaxation in an execution, over the blocks of 8 x 8 x 8 voxels that a
   * drag has moved in the last 30 executions. Default 5, 0 to 10000.
   */
  vtkSetClampMacro(RelaxationSweeps, int, 0, 10000);
  vtkGetMacro(RelaxationSweeps, int);
  ///@}

  ///@{
  /**
   * Set/Get how much of the way to the weighted mean of its neighbours a voxel moves in a sweep of
   * relaxation, 0 to 1. Links that give way less weigh more. Default 1.
   */
  vtkSetClampMacro(Elasticity, double, 0.0, 1.0);
  vtkGetMacro(Elasticity, double);
  ///@}

  ///@{
  /**
   * Set/Get a fraction of the spacing: voxels that are nearer to that mean stay where they are, on
   * each axis by itself. 0: all that is pinned somewhere returns to rest in the end. Default 0, at
   * least 0.
   */
  vtkSetClampMacro(PlasticityThreshold, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(PlasticityThreshold, double);
  ///@}

  /**
   * All voxels are put to rest before the next step.
   */
  void Reset();

  ///@{
  /**
   * Keep where all voxels are now, and take them back to that before the next step, to the last
   * bit: an undo. SaveState() returns the number of the state, -1 after an error; each takes 6 KiB
   * for each block of 8 x 8 x 8 voxels that has moved since the state before. RestoreState() and
   * RemoveState() return false where there is no such state, the former as well where the volume
   * has other voxels now. Where a state that comes back violates the limits of now, all voxels are
   * put to rest.
   */
  vtkIdType SaveState();
  bool RestoreState(vtkIdType state);
  bool RemoveState(vtkIdType state);
  int GetNumberOfStates();
  ///@}

  /**
   * Bytes of host memory that the states take.
   */
  vtkTypeInt64 GetStateMemory();

  ///@{
  /**
   * Set/Get the OpenCL device, in the words of vtkDeformVolumeFilter::SetDevice(). Displacements
   * are the same on all of them, to the last bit. A change of device puts all voxels to rest.
   * Default "": the best there is.
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  ///@}

  ///@{
  /**
   * Set/Get how many bytes of device memory may be used; 0 is what the device has available. A
   * volume that needs more is an error before anything is allocated. Default 0.
   */
  vtkSetClampMacro(MemoryLimit, vtkTypeInt64, 0, VTK_TYPE_INT64_MAX);
  vtkGetMacro(MemoryLimit, vtkTypeInt64);
  ///@}

  ///@{
  /**
   * Of the last execution. The largest violation of a limit by a voxel that moved, as a fraction of
   * the spacing: 0 unless something is wrong. How many rounds over active blocks and sweeps of
   * relaxation it took. How many voxels moved. How many handles were reduced or released so that
   * others stay.
   */
  vtkGetMacro(LargestViolation, double);
  vtkGetMacro(NumberOfSweeps, vtkIdType);
  vtkGetMacro(NumberOfMovedVoxels, vtkIdType);
  vtkGetMacro(NumberOfReducedHandles, int);
  vtkGetMacro(NumberOfReleasedHandles, int);
  ///@}

  ///@{
  /**
   * The extent of the output, in structured indices, in which displacements may not be what they
   * were before the last execution; (0, -1, 0, -1, 0, -1) where nothing changed.
   */
  vtkGetVector6Macro(ChangedExtent, int);
  ///@}

  /**
   * Name of the device of the last execution; "" before the first.
   */
  vtkGetMacro(DeviceInUse, std::string);

  /**
   * The device and the counts of the last execution in a few lines of words, for people to read; ""
   * before the first.
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
