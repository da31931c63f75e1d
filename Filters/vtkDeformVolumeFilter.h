// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformVolumeFilter
 * @brief   deform a volume with a tetrahedral mesh or a displacement field
 *
 * vtkDeformVolumeFilter takes a volume at rest and something that deforms it, and gives the
 * deformed volume as ordinary vtkImageData: at full resolution, without holes, with every point
 * array in its own type. The voxels of the volume are the vertices of an implicit sampling mesh of
 * five tetrahedra per cell. Each vertex is linked once into the deformation (static mapping); at
 * each update all vertices are moved (deformation mapping) and all tetrahedra of the sampling mesh
 * are rasterised into the output (resampling), both on an OpenCL device.
 *
 * @par Port 0, the volume:
 * vtkImageData at rest, of at least two voxels on each axis. Any extent, origin, spacing and
 * direction matrix; the source must announce in its information what it gives (an origin or a
 * spacing that is not announced is read from the data). All numeric point arrays go through, each
 * in its own type, with any number of components: interpolated linearly (integers rounded to
 * nearest), or, where the array is named with AddCategoricalArray(), taken from one vertex, so that
 * label ids of 64 bits survive. Attributes keep their role, field data passes. Points that
 * vtkGhostType marks as hidden or duplicate are no source. A cell array "ActiveTetrahedra"
 * (unsigned char, one component; bit i stands for tetrahedron i of the cell) switches tetrahedra of
 * the sampling mesh off; hidden cells are off too, but for those that only an edit hides
 * (vtkVolumeEditAlgorithm::BlankCells). A point array "BoundaryDistance" (numeric, one component,
 * any unit) clips them: it is interpolated in each tetrahedron, and samples where it is negative
 * are left out; NaN is not negative. A cell array "CutTetrahedra" (unsigned char) and a point array
 * "CutDistance" (numeric) are a smooth cut, which divides tetrahedra between its two sides
 * (vtkCutVolume); resamplers other than EXACT do not know it: an error. Other cell arrays are not
 * resampled, and a warning names them.
 *
 * @par Port 1, the deformation, optional:
 * Without it the output is the volume itself, at rest: masks, cuts and carvings show. Otherwise one
 * of:
 * - vtkUnstructuredGrid, vtkStructuredGrid, vtkRectilinearGrid, or a composite dataset of such
 *   (they are joined): tetrahedra; other three-dimensional cells, quadratic and Lagrange cells
 *   included, are split into tetrahedra (Bezier cells are an error, and so are concave polyhedra
 *   that are not star-shaped). Cells that vtkGhostType marks
 *   as hidden or duplicate are left out, and so are cells of structured and rectilinear grids with
 *   a hidden point. Without port 2 its points are the rest positions, and the vectors chosen by
 *   SetInputArrayToProcess(0, 1, 0, POINTS, name), three components in world units, are added
 *   DisplacementScale times. By default these are the active vectors; an empty name stands for the
 *   active vectors or else the only array of three components. With port 2 its points are the
 *   deformed positions, in world coordinates. Positions and displacements of nodes that no
 *   three-dimensional cell uses have no effect and need not be finite (in a vtkDeviceVectorArray
 *   they must be), and a block without such cells needs no displacements.
 * - vtkImageData with a three-component point array chosen in the same way: a displacement field,
 *   in world units, at the volume's resolution or any other, trilinear between its points. It is
 *   forward: it leads from a point of the volume at rest to where that point goes. Registration
 *   programs write inverse fields, see FieldIsInverse. At points that vtkGhostType marks as hidden
 *   it is undefined: voxels whose interpolation needs one are not covered.
 *
 * @par Port 2, optional, the rest configuration:
 * A mesh, as on port 1, with the cells and the number of points of port 1.
 *
 * @par Port 3, optional, the reference image:
 * vtkImageData whose grid the output has: its whole extent, origin, spacing and direction, also
 * where nothing is covered. Any rotation, mirror image and spacing is allowed, as between a fixed
 * and a moving image of registration. Only what its source announces in its information is used; it
 * is never asked for data. OutputBoundsMode, CustomBounds, Padding, BoundsGranularity and
 * OutputSpacingMode then have no effect, and a warning names those that are set. SamplingFactor
 * leaves voxels of the volume out, and none of the output.
 *
 * @par Output:
 * Without port 3: vtkImageData with the volume's origin and direction matrix, and by default its
 * spacing; only the extent differs (see OutputBoundsMode). An undeformed volume therefore comes out
 * bit for bit equal. A point array "vtkValidPointMask" (char) is 1 where the deformed volume covers
 * a voxel and 0 elsewhere, where the other arrays hold BackgroundValue. Each covered voxel is
 * written by exactly one tetrahedron; positions are rounded to 1/256 of an output voxel. Where
 * tetrahedra overlap, upright ones win over inverted ones and then the lowest cell; the result is
 * the same from run to run.
 *
 * @par Parts and ranks:
 * The filter makes any extent of its output, and under MPI each rank makes its piece; voxels are
 * the same to the last bit however the output is divided. Where a part is asked for, with
 * CUSTOM_BOUNDS, and with a reference image, the input is asked only for the voxels that can land
 * there, provided that all sources of the volume can make parts (they say so with
 * CAN_PRODUCE_SUB_EXTENT), that the resampler is EXACT or AUTOMATIC, that OutsideMode is DISCARD
 * for a mesh, and that the volume has no smooth cut or SamplingFactor is above 1. AUTOMATIC is then
 * EXACT, even if the whole would not have fit into memory. Else, and with FieldIsInverse, the input
 * is asked for whole. Of the deformation mesh each rank may have a piece, none, or the whole: it is
 * gathered through vtkMultiProcessController::GetGlobalController(). A displacement field every
 * rank must be given whole. All ranks have to update together; an error on one is reported on all.
 * Counts of voxels, tetrahedra and bricks are summed over the ranks: what two of them have counts
 * twice.
 *
 * @par Errors:
 * Each failure is one vtkErrorMacro, which says what is wrong and what to do, at each update that
 * fails. The output is then empty, and the filter works again once the cause is removed. Errors of
 * the information pass are reported when data are requested. VTK's executive reports an input that
 * is not connected; the output then stays as it was.
 *
 * The method is that of Rodriguez, Leon, Martin and Otaduy, "A parallel resampling method for
 * interactive deformation of volumetric models".
 *
 * @sa vtkLatticeTetrahedraSource vtkTetGenMesher
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
  static vtkDeformVolumeFilter* New();
  vtkTypeMacro(vtkDeformVolumeFilter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Connect the deformation (port 1, optional): a tetrahedral mesh or a displacement field.
   */
  void SetDeformationConnection(vtkAlgorithmOutput* output);
  void SetDeformationData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Connect the rest configuration of the deformation mesh (port 2, optional).
   */
  void SetRestConnection(vtkAlgorithmOutput* output);
  void SetRestData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Connect the reference image, whose grid the output has (port 3, optional).
   */
  void SetReferenceConnection(vtkAlgorithmOutput* output);
  void SetReferenceData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Factor on the displacements of port 1, as in vtkWarpVector. Not used with port 2. Default 1.
   */
  vtkSetMacro(DisplacementScale, double);
  vtkGetMacro(DisplacementScale, double);
  ///@}

  ///@{
  /**
   * Whether the points of the mesh on port 1 are deformed already, with the displacements that led
   * there beside them, as some readers give them (vtkExodusIIReader with ApplyDisplacements). The
   * rest positions are then the points minus the displacements, to which these are added
   * DisplacementScale times. With a rest configuration on port 2, or a displacement field on port
   * 1, it is an error. Where points are stored as float, rest positions differ from time step to
   * time step by rounding, and the static mapping is built for each step. Default: off.
   */
  vtkSetMacro(PointsAreDeformed, bool);
  vtkGetMacro(PointsAreDeformed, bool);
  vtkBooleanMacro(PointsAreDeformed, bool);
  ///@}

  ///@{
  /**
   * Whether a displacement field on port 1 is inverse: it leads from a point of the output to the
   * point of the volume that is seen there, as registration programs write it (from the fixed to
   * the moving image), and not from a point of the volume to where that goes. Each output voxel
   * within the field is then looked up in the volume, by the resampler MESH_RASTERIZATION (which
   * AUTOMATIC takes; others are errors), linearly over the voxels of a cell or cubically. No field
   * is inverted. Not used with a mesh. Default: off.
   */
  vtkSetMacro(FieldIsInverse, bool);
  vtkGetMacro(FieldIsInverse, bool);
  vtkBooleanMacro(FieldIsInverse, bool);
  ///@}

  enum OutputBoundsModes
  {
    DEFORMED_BOUNDS = 0,
    VOLUME_BOUNDS = 1,
    CUSTOM_BOUNDS = 2
  };

  ///@{
  /**
   * What decides the output's whole extent: the bounds of the deformed volume, those of the volume
   * at rest, or CustomBounds. For a deformation that varies in time DEFORMED_BOUNDS is the union
   * over the times seen since it or a setting has changed. Where the volume leaves it at another
   * time, it grows: at once where this filter is updated; where a consumer asks, which does not
   * know of the new extent yet, the volume is cut off in that update, and a warning tells. Default:
   * DEFORMED_BOUNDS.
   */
  vtkSetClampMacro(OutputBoundsMode, int, DEFORMED_BOUNDS, CUSTOM_BOUNDS);
  vtkGetMacro(OutputBoundsMode, int);
  void SetOutputBoundsModeToDeformedBounds() { this->SetOutputBoundsMode(DEFORMED_BOUNDS); }
  void SetOutputBoundsModeToVolumeBounds() { this->SetOutputBoundsMode(VOLUME_BOUNDS); }
  void SetOutputBoundsModeToCustomBounds() { this->SetOutputBoundsMode(CUSTOM_BOUNDS); }
  ///@}

  ///@{
  /**
   * The box in world coordinates (x min, x max, y min, y max, z min, z max) that the output must
   * contain in the mode CUSTOM_BOUNDS. Default: -1, 1, -1, 1, -1, 1.
   */
  vtkSetVector6Macro(CustomBounds, double);
  vtkGetVector6Macro(CustomBounds, double);
  ///@}

  ///@{
  /**
   * A border of so many output voxels on each side of the output, so that isosurfaces close.
   * Default 0, at least 0.
   */
  vtkSetClampMacro(Padding, int, 0, 1000);
  vtkGetMacro(Padding, int);
  ///@}

  ///@{
  /**
   * In the mode DEFORMED_BOUNDS the whole extent, Padding included, is rounded outwards to
   * multiples of so many voxels (in structured indices of the output), so that it stays while the
   * body moves a little: only an output of the same extent is updated in part (see Incremental),
   * and viewers need no new texture. It is kept until the deformed body with its padding leaves it,
   * or a side could be more than so many voxels nearer; then that side moves. What is kept starts
   * anew with a change of the volume's geometry, of the settings that decide the bounds, or of the
   * time steps. So the extent depends on the updates before; the voxels in it do not. 0 and 1: off.
   * Default 0, at least 0.
   */
  vtkSetClampMacro(BoundsGranularity, int, 0, 1000);
  vtkGetMacro(BoundsGranularity, int);
  ///@}

  enum OutputSpacingModes
  {
    VOLUME_SPACING = 0,
    CUSTOM_SPACING = 1
  };

  ///@{
  /**
   * Whether the output has the volume's spacing or CustomSpacing. With another spacing the
   * output's index 0 stays at the volume's origin. Default: VOLUME_SPACING.
   */
  vtkSetClampMacro(OutputSpacingMode, int, VOLUME_SPACING, CUSTOM_SPACING);
  vtkGetMacro(OutputSpacingMode, int);
  void SetOutputSpacingModeToVolumeSpacing() { this->SetOutputSpacingMode(VOLUME_SPACING); }
  void SetOutputSpacingModeToCustomSpacing() { this->SetOutputSpacingMode(CUSTOM_SPACING); }
  ///@}

  ///@{
  /**
   * Spacing of the output in the mode CUSTOM_SPACING, in world units, greater than 0.
   * Default: 1, 1, 1.
   */
  vtkSetVector3Macro(CustomSpacing, double);
  vtkGetVector3Macro(CustomSpacing, double);
  ///@}

  ///@{
  /**
   * With 2 or 4 the filter works on every second or fourth voxel of the volume on each axis, those
   * whose structured indices are divisible by the factor, as if they were the volume. They lie
   * where they lay; voxels beyond the last of them are left out. The output's spacing, the volume's
   * or CustomSpacing, is so many times as large, and Padding and BoundsGranularity count such
   * voxels. Voxels that stay keep their blanking; what is blanked between them does not matter. A
   * cell has all its tetrahedra where all cells of the volume that it covers have all of theirs,
   * and none otherwise, so that nothing shows that is cut off. No values are averaged.
   *
   * This is for the time in which something moves. What is kept from one update to the next (the
   * static mapping, what the device holds, the output) is kept for each factor that has been used
   * since the volume was connected: to change the factor and back builds nothing anew. Where the
   * memory does not suffice, what is kept for other factors is freed first. Other values are an
   * error. Default 1.
   */
  vtkSetMacro(SamplingFactor, int);
  vtkGetMacro(SamplingFactor, int);
  ///@}

  ///@{
  /**
   * What the voxels get that the deformed volume does not cover, in every component of every
   * array, clamped to the range of the array's type. Default 0.
   */
  vtkSetMacro(BackgroundValue, double);
  vtkGetMacro(BackgroundValue, double);
  ///@}

  enum OutsideModes
  {
    DISCARD = 0,
    EXTRAPOLATE = 1,
    KEEP = 2
  };

  ///@{
  /**
   * What happens to the volume outside the deformation mesh or field.
   * - DISCARD: it is discarded, so that the deformed volume ends where the deformed mesh ends (up
   *   to 1/128 output voxel, as node positions are rounded).
   * - EXTRAPOLATE: its voxels follow the nearest tetrahedron, whose affine map is extended (it is
   *   the tetrahedron of the nearest voxel inside the mesh; with a field, the displacement of the
   *   nearest point of the field).
   * - KEEP: it stays where it is, and the displacement fades to zero within FadeDistance. Cavities
   *   of the mesh count as outside. With an inverse field it is the output outside the field that
   *   shows the volume where it is at rest. Meshes with OpenSplits or MESH_RASTERIZATION are
   *   errors.
   *
   * For meshes, EXTRAPOLATE and KEEP need 16 bytes a voxel for the mapping, while DISCARD makes do
   * with less where tetrahedra are large. Default: DISCARD.
   */
  vtkSetClampMacro(OutsideMode, int, DISCARD, KEEP);
  vtkGetMacro(OutsideMode, int);
  void SetOutsideModeToDiscard() { this->SetOutsideMode(DISCARD); }
  void SetOutsideModeToExtrapolate() { this->SetOutsideMode(EXTRAPOLATE); }
  void SetOutsideModeToKeep() { this->SetOutsideMode(KEEP); }
  ///@}

  ///@{
  /**
   * With OutsideMode KEEP, the distance from the mesh at rest, or from the grid of the field,
   * within which the displacement fades to zero, in world units. A voxel at the distance d is
   * displaced as the closest point of the boundary, times 1 - 3 s^2 + 2 s^3 with s = d /
   * FadeDistance. Voxels farther away stay where they are to the last bit. A distance of at least
   * twice the largest displacement keeps the volume from folding; less than 1.5 times that, and
   * tetrahedra of the volume that are stretched over more than 2 output voxels where the closest
   * point of a mesh jumps (between two bodies, within a ring), are reported in one warning for each
   * change of the deformation.
   *
   * 0 is a hard edge: no voxel outside moves. Where the boundary moves, the cells that it crosses
   * are stretched or folded. An inverse field is then zero outside its grid, as a displacement
   * field of ITK is. Negative, infinite and NaN are errors at the next update. Default: 0.
   */
  vtkSetMacro(FadeDistance, double);
  vtkGetMacro(FadeDistance, double);
  ///@}

  ///@{
  /**
   * Names of point arrays that hold labels: they are taken from one voxel and never mixed. With
   * MESH_RASTERIZATION that is the nearest voxel. With EXACT it is the vertex that weighs most in
   * the sampling tetrahedron that holds the output voxel: mostly the nearest voxel, and always one
   * of its cell.
   */
  void AddCategoricalArray(const char* name);
  void RemoveCategoricalArray(const char* name);
  void ClearCategoricalArrays();
  int GetNumberOfCategoricalArrays();
  const char* GetCategoricalArray(int index);
  ///@}

  ///@{
  /**
   * Whether the output has a point array "RestPosition" (float, three components): where what a
   * voxel shows lies at rest, in world coordinates, interpolated as the other arrays are, but
   * linearly with NEAREST_INTERPOLATION. It is the inverse of the deformation: RestPosition minus
   * the voxel's own position is the displacement field that resampling programs take. Takes 12
   * bytes a voxel of the volume and of the output. Default: off.
   */
  vtkSetMacro(GenerateRestPositions, bool);
  vtkGetMacro(GenerateRestPositions, bool);
  vtkBooleanMacro(GenerateRestPositions, bool);
  ///@}

  ///@{
  /**
   * Whether the output has a point array "Jacobian" (float, one component): the determinant of the
   * derivative of the deformed position with respect to the position at rest, which is how many
   * times as large the deformation makes the volume there; less than 0 where it turns it inside
   * out. It is found at each voxel of the volume, from displacements that no position rounds, and
   * interpolated as the other arrays are: in a mesh that of the tetrahedron that holds the voxel,
   * elsewhere from the differences of displacements half a voxel before and after it, and with
   * FieldIsInverse at each voxel of the output. The volume is read whole. A mesh with
   * MESH_RASTERIZATION is an error. Default: off.
   */
  vtkSetMacro(GenerateJacobian, bool);
  vtkGetMacro(GenerateJacobian, bool);
  vtkBooleanMacro(GenerateJacobian, bool);
  ///@}

  ///@{
  /**
   * Whether the output has a point array "FoldCount" (unsigned int): how many tetrahedra of the
   * sampling mesh hold a voxel, of which the output shows one. 1 where nothing is folded, more
   * where the volume lies over itself, and 0 where it covers nothing. Where cells at the boundary
   * of the deformation mesh lie over others only these others are counted, and with FieldIsInverse
   * each covered voxel has 1. All of the output is resampled at each update. A mesh with
   * MESH_RASTERIZATION is an error. Default: off.
   */
  vtkSetMacro(GenerateFoldCount, bool);
  vtkGetMacro(GenerateFoldCount, bool);
  vtkBooleanMacro(GenerateFoldCount, bool);
  ///@}

  ///@{
  /**
   * Names of point arrays that hold amounts for each unit of volume, such as a dose, an activity or
   * a density: their values are divided by the Jacobian, so that their sum, times the volume of a
   * voxel, stays that of the volume at rest. In the output they are of float, or stay double. Where
   * the Jacobian is not greater than 0 they have BackgroundValue. Where the volume folds, several
   * parts of it lie in one place, and the output shows one of them. A warning gives the share of
   * the volume that is hidden, and the number of voxels without a value. All of the output is
   * resampled at each update. A name that no numeric array has, or that of a categorical array, is
   * an error. As with GenerateJacobian, the volume is read whole, and a mesh with
   * MESH_RASTERIZATION is an error.
   */
  void AddDensityArray(const char* name);
  void RemoveDensityArray(const char* name);
  void ClearDensityArrays();
  int GetNumberOfDensityArrays();
  const char* GetDensityArray(int index);
  ///@}

  enum Resamplers
  {
    EXACT = 0,
    MESH_RASTERIZATION = 2,
    AUTOMATIC = 3
  };

  ///@{
  /**
   * How the deformed volume is resampled.
   * - EXACT: the tetrahedra of the sampling mesh are rasterised, and values are interpolated over
   *   their vertices; every covered voxel is written by exactly one tetrahedron.
   * - MESH_RASTERIZATION: the tetrahedra of the deformation mesh (port 1) are rasterised
   *   themselves, and the volume is interpolated, over the voxels of a cell, at the rest position
   *   of each output voxel. Every covered voxel is written once: by the first tetrahedron that is
   *   upright, or else by the first inverted one. There is no sampling mesh and no static mapping,
   *   which saves their memory and suits coarse meshes. Not for forward displacement fields, and
   *   not for meshes with EXTRAPOLATE or KEEP. With FieldIsInverse the field says the rest
   *   position.
   * - AUTOMATIC: EXACT, unless the memory suffices for MESH_RASTERIZATION only and that can do the
   *   deformation. The whole extent of the output counts, so that its parts are done alike.
   *
   * Both give the same image of an undeformed volume, bit for bit, and of one that moves by whole
   * voxels. The value 1 is an error. Default: AUTOMATIC.
   */
  void SetResampler(int resampler);
  int GetResamplerMinValue() { return EXACT; }
  int GetResamplerMaxValue() { return AUTOMATIC; }
  vtkGetMacro(Resampler, int);
  void SetResamplerToExact() { this->SetResampler(EXACT); }
  void SetResamplerToMeshRasterization() { this->SetResampler(MESH_RASTERIZATION); }
  void SetResamplerToAutomatic() { this->SetResampler(AUTOMATIC); }
  ///@}

  /**
   * Set a property by its name in state files and scripts of ParaView, also in those of former
   * versions. StreamInput, WorkGroupSize and NumberOfTimeSamples have been removed: they are
   * ignored, with a warning where the value is not the former default. Resampler 1 is AUTOMATIC,
   * with a warning.
   */
  void SetFromState(const char* property, int value);

  /**
   * The resampler of the last execution: EXACT or MESH_RASTERIZATION; AUTOMATIC before the first.
   */
  vtkGetMacro(ResamplerInUse, int);

  enum Interpolations
  {
    LINEAR_INTERPOLATION = 0,
    CUBIC_INTERPOLATION = 1,
    NEAREST_INTERPOLATION = 2
  };

  ///@{
  /**
   * The interpolation of arrays that are not categorical: linear, or cubic (Catmull-Rom, as
   * vtkImageInterpolator does it) over four voxels on each axis, rounded and clamped to the range
   * of integer types, or nearest: every array is treated as categorical. All go with every
   * deformation.
   *
   * Cubic interpolation is done at the rest position of the output voxel. EXACT does it where all
   * of the 64 voxels are there and no cut or boundary passes between them, and interpolates
   * linearly elsewhere: in the outermost cells of the volume, and in the cells round a blanked
   * voxel, a cell with inactive or clipped tetrahedra, one that a smooth cut crosses, and one that
   * the boundary of the deformation mesh crosses. It takes about 5 times as long as linear
   * interpolation on a processor. With MESH_RASTERIZATION the 64 voxels repeat those of the border
   * beyond it, and a voxel is covered only where none of them is blanked. Default:
   * LINEAR_INTERPOLATION.
   */
  vtkSetClampMacro(Interpolation, int, LINEAR_INTERPOLATION, NEAREST_INTERPOLATION);
  vtkGetMacro(Interpolation, int);
  void SetInterpolationToLinearInterpolation() { this->SetInterpolation(LINEAR_INTERPOLATION); }
  void SetInterpolationToCubicInterpolation() { this->SetInterpolation(CUBIC_INTERPOLATION); }
  void SetInterpolationToNearestInterpolation() { this->SetInterpolation(NEAREST_INTERPOLATION); }
  ///@}

  ///@{
  /**
   * Whether a gap opens in the volume where the deformation mesh is split: where tetrahedra that
   * have a place at rest in common name different nodes there, as after a cut. Tetrahedra of the
   * sampling mesh with vertices on both sides are left out then, a layer as thick as a cell;
   * otherwise they are stretched over the gap. Which sides there are is told by nodes with one rest
   * position, so that a mesh of several parts opens between these, too. The deformation mesh, or
   * what its cells are split into, should not be finer than the volume: a cell sees the split by
   * the tetrahedra that its vertices lie in. MESH_RASTERIZATION leaves gaps by itself. Default:
   * off.
   */
  vtkSetMacro(OpenSplits, bool);
  vtkGetMacro(OpenSplits, bool);
  vtkBooleanMacro(OpenSplits, bool);
  ///@}

  ///@{
  /**
   * Whether an update resamples only the bricks of the volume (192 x 16 x 16 cells, or parts of
   * these) whose nodes moved or whose masks changed, and, unless all that moved is inside the mesh,
   * those that overlap them in the output. The result is the same to the last bit. A device with
   * memory of its own keeps the last output there, and only what may have changed is copied from it
   * (see GetChangedExtent). Needs the resampler EXACT, and an output of the same extent as the last
   * one; all is resampled where that is not so, where the device works on the volume or the output
   * in several parts, where more than 60 % would have to be resampled, where the volume's arrays
   * changed, where the first fold of the volume comes or the last one goes, and after an
   * abort or an error. Default: on.
   */
  vtkSetMacro(Incremental, bool);
  vtkGetMacro(Incremental, bool);
  vtkBooleanMacro(Incremental, bool);
  ///@}

  ///@{
  /**
   * Whether the arrays of the output stay in the memory of a device that has its own until somebody
   * reads or writes one of them; then that one is brought to the host, once. An update takes no
   * time for that, and what nobody reads never passes the bus. Where memory of the host still holds
   * an earlier output, only what has changed since is copied (see Incremental). Arrays of integers
   * of 64 bits go to the host at once: VTK reads arrays of classes that it does not know as
   * doubles.
   *
   * The arrays have the interfaces that all of VTK's arrays have, GetVoidPointer() included, and
   * may be read by several threads. They are none of VTK's own classes: what needs one of these,
   * such as a vtkShortArray, gets it from a copy (DeepCopy() of the data set or into such an
   * array).
   *
   * What is still held of an output, and not read, is brought to the host before the device writes
   * the next one, has another volume, or is to release its memory (ReleaseDeviceMemory()). Until
   * then it is part of GetDeviceMemory(). It can be read when this filter is no more. Where it
   * cannot be brought, that is an error of the array, which holds the background.
   *
   * The property is without effect on devices that are processors, as they work in the memory of
   * the host, and where the device does not hold the output in one piece. Default: off.
   */
  vtkSetMacro(OutputOnDevice, bool);
  vtkGetMacro(OutputOnDevice, bool);
  vtkBooleanMacro(OutputOnDevice, bool);
  ///@}

  ///@{
  /**
   * The OpenCL device: "" or "best" is the best there is (the first of GetDeviceNames()), or what
   * the environment variable DEFORMVOLUME_DEVICE asks for in the same words; "cpu" and "gpu" are
   * the best of that kind; anything else is a part of a device's name, without regard to case. A
   * request that cannot be met is an error at the next update. Default: "".
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  ///@}

  /**
   * Names of the OpenCL devices of this machine, the best first; empty where there is none. The
   * order is: graphics processors with memory of their own, other accelerators with memory of their
   * own, processors, devices that share the memory of the processor, and devices that software
   * emulates (llvmpipe). Of one kind those with double precision come first, then those with more
   * compute units. The array is a new one and belongs to the caller (Python sees to that by
   * itself).
   */
  static VTK_NEWINSTANCE vtkStringArray* GetDeviceNames();

  ///@{
  /**
   * Bytes of device memory that may be used; 0 is what the device has available. An update that
   * needs more is an error before anything is allocated. Default 0.
   */
  vtkSetClampMacro(MemoryLimit, vtkTypeInt64, 0, VTK_TYPE_INT64_MAX);
  vtkGetMacro(MemoryLimit, vtkTypeInt64);
  ///@}

  /**
   * Active tetrahedra of the sampling mesh that the deformation turned inside out at the last
   * execution, and, in cells that the boundary of the deformation mesh crosses or touches,
   * tetrahedra of the deformation mesh; with MESH_RASTERIZATION tetrahedra of the deformation mesh,
   * and with FieldIsInverse those of the field's lattice, five for each cell: parts of the volume
   * are then seen twice.
   */
  vtkGetMacro(NumberOfInvertedTetrahedra, vtkIdType);

  /**
   * Tetrahedra without volume of the deformation mesh at rest: they are skipped.
   */
  vtkGetMacro(NumberOfFlatTetrahedra, vtkIdType);

  /**
   * Voxels of the output that the deformed volume covers.
   */
  vtkGetMacro(NumberOfCoveredVoxels, vtkIdType);

  /**
   * The smallest extent, in structured indices of the output, that is known to hold all voxels that
   * the last execution may have changed, so that a viewer sends only these to the device that draws
   * them. It is the extent of the output where all of it was made anew, and empty
   * (0, -1, 0, -1, 0, -1) where nothing changed, before the first execution and after one that
   * failed. Less than all of it is known after incremental executions only, see Incremental. It
   * compares with the execution before: after an Update() that had nothing to execute it is what it
   * was. Under MPI it is about the piece of the output on this rank.
   */
  vtkGetVector6Macro(ChangedExtent, int);

  /**
   * Name of the device of the last execution; "" before the first.
   */
  vtkGetMacro(DeviceInUse, std::string);

  /**
   * What the last execution did, one "name: value" a line; "" before the first. It also goes to
   * vtkLogger (TRACE).
   *
   * "Device" and "Resampler"; "Covered voxels", "Inverted tetrahedra", "Flat tetrahedra". "Bricks
   * resampled", all or in part, and "Bricks of the volume", each of 192 x 16 x 16 cells: 0 with
   * MESH_RASTERIZATION, which knows none. "Static mappings made" and "Volumes sent" to the device
   * since the filter is there: a moved mesh costs neither; another mesh at rest (not where nodes
   * are added, or tetrahedra get other nodes in the same places), another geometry of the volume,
   * ratio of spacings, OutsideMode, FadeDistance or device, and ReleaseDeviceMemory() cost a
   * mapping. "Arrays on the device" that nobody has read (OutputOnDevice).
   *
   * "Seconds for the static mapping", 0 when that of an earlier execution served; "for transfer" to
   * and from the device, without arrays that are read later; "for mapping", which exact kernels do
   * while they resample (0), and which for MESH_RASTERIZATION is the listing of the tetrahedra of
   * each part of the output; "for resampling"; "for compilation" of kernels, which is part of no
   * other time and close to 0 once the kernels are known. Under MPI voxels, inverted tetrahedra and
   * bricks are summed over the ranks, and times are those of this rank.
   */
  std::string GetSummary();

  /**
   * Bytes that this filter holds on the device.
   */
  vtkTypeInt64 GetDeviceMemory();

  /**
   * Free what this filter holds on the device; the next update sends it again.
   */
  void ReleaseDeviceMemory();

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
  vtkIdType NumberOfFlatTetrahedra = 0;
  vtkIdType NumberOfCoveredVoxels = 0;
  int ChangedExtent[6] = { 0, -1, 0, -1, 0, -1 };
  int ResamplerInUse = AUTOMATIC;
  std::string DeviceInUse;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
