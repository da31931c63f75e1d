// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformGeometryFilter
 * @brief   move points as vtkDeformVolumeFilter moves a volume
 *
 * vtkDeformGeometryFilter moves surfaces, landmarks, streamlines and grids with the deformation
 * that vtkDeformVolumeFilter applies to a volume, so that segmentations and measurements stay
 * aligned with the volume. It moves points at rest to their deformed positions or, with Inverse,
 * points of the deformed volume back to rest. It computes on the CPU, in double precision, and
 * needs no OpenCL device.
 *
 * @par Port 0, the points:
 * Any vtkPointSet, such as vtkPolyData, vtkUnstructuredGrid or vtkStructuredGrid, or a composite
 * dataset of these. All points must be finite, whether cells use them or not.
 *
 * @par Port 1, the deformation, optional:
 * A mesh with displacements or, with port 2, deformed points; or a vtkImageData with a displacement
 * field, in world units: the same as port 1 of vtkDeformVolumeFilter. The displacements are chosen
 * by SetInputArrayToProcess(0, 1, 0, POINTS, name), by default the active vectors; an empty name
 * stands for the active vectors or else the only array of three components. Without a deformation
 * points do not move.
 *
 * @par Port 2, optional, the mesh at rest:
 * A mesh, as on port 1, with the cells and the number of points of port 1.
 *
 * @par Output:
 * The same kind of data with moved points, of type float if the points of the input are, else
 * double. Cells, cell arrays and field data are passed. Point arrays are passed, except for these:
 * - Active normals are multiplied by the inverse transpose of the deformation gradient and
 *   normalized.
 * - Active vectors are multiplied by the deformation gradient. See also TransformAllInputVectors.
 *   If ports 0 and 1 are connected to the same source, the active vectors are the displacements:
 *   choose other active vectors if the displacements must not change.
 * - "vtkValidPointMask" (char) is 1 for points that the deformation moves, and 0 for points outside
 *   (see OutsideMode). It replaces an array of this name of the input. Points outside keep their
 *   positions, normals and vectors, and a warning has their number.
 *
 * Transformed arrays are of type float if those of the input are, else double. The deformation
 * gradient is the derivative of deformed by rest positions, with Inverse of rest by deformed ones.
 * It is constant in each tetrahedron, and jumps between them. Active normals and vectors of cells
 * are not transformed; a warning names them.
 *
 * @par The map:
 * - Mesh: a point follows the tetrahedron that contains it, of several the one with the lowest
 *   index. Points nearer to the mesh than 1e-6 of the diagonal of its bounds are treated as inside.
 *   For points of type float, their rounding is added: 2^-23 of the largest coordinate of the mesh.
 * - Field: trilinear between the points of the field. Points outside it by at most 1/1000 of a cell
 *   are treated as on its border. Points whose interpolation needs a hidden point are outside.
 * - With Inverse (or without, if FieldIsInverse is on), several points at rest may belong to one
 *   point where the deformation folds. Upright tetrahedra win over inverted ones, then lower
 *   indices over higher ones. In cells of a field Newton's method finds the point, to 1e-6 of a
 *   cell. If a cell is folded within itself, the method may miss a point. If it finds no point, the
 *   point to move is outside.
 *
 * This filter moves a voxel center to the same position as vtkDeformVolumeFilter, which rounds
 * positions to 1/256 of an output voxel. Between voxels, vtkDeformVolumeFilter interpolates in the
 * tetrahedra of the sampling mesh, while this filter evaluates the deformation itself.
 *
 * @par Ranks:
 * Under MPI each rank moves its points. Each rank may have a piece of the deformation mesh, no
 * piece, or the whole mesh. The mesh is gathered through
 * vtkMultiProcessController::GetGlobalController(). Every rank needs the whole of a displacement
 * field. All ranks have to update together. An error of one rank is reported on all ranks.
 *
 * @par Errors:
 * Each update that fails reports one error with vtkErrorMacro: points that are not finite, a mesh
 * without tetrahedra, displacements that are missing or not finite, a point array to transform with
 * a wrong number of tuples. The output is then empty. An input without points causes a warning, and
 * gives an output without points.
 *
 * @sa vtkDeformVolumeFilter vtkTransformFilter vtkWarpVector
 */
#ifndef vtkDeformGeometryFilter_h
#define vtkDeformGeometryFilter_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkPointSetAlgorithm.h"

#include <memory> // for std::unique_ptr

class VTKDEFORMVOLUME_EXPORT vtkDeformGeometryFilter : public vtkPointSetAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkDeformGeometryFilter* New();
  vtkTypeMacro(vtkDeformGeometryFilter, vtkPointSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the deformation (port 1, optional): a tetrahedral mesh or a displacement field.
   */
  void SetDeformationConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  /// Set the data object of port 1 itself, without a pipeline.
  void SetDeformationData(vtkDataObject* data) { this->SetInputDataInternal(1, data); }
  ///@}

  ///@{
  /**
   * Connect the mesh at rest (port 2, optional).
   */
  void SetRestConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  /// Set the data object of port 2 itself, without a pipeline.
  void SetRestData(vtkDataObject* data) { this->SetInputDataInternal(2, data); }
  ///@}

  ///@{
  /**
   * Set/Get whether the points lie in the deformed volume and are moved back to rest. Default: off.
   */
  vtkSetMacro(Inverse, bool);
  vtkGetMacro(Inverse, bool);
  vtkBooleanMacro(Inverse, bool);
  ///@}

  ///@{
  /**
   * Set/Get a factor on the displacements of port 1, as in vtkWarpVector. Not used with port 2.
   * Default 1.
   */
  vtkSetMacro(DisplacementScale, double);
  vtkGetMacro(DisplacementScale, double);
  ///@}

  ///@{
  /**
   * Set/Get whether the points of the mesh on port 1 are deformed already. The rest positions are
   * then the points minus the displacements. See vtkDeformVolumeFilter. Default: off.
   */
  vtkSetMacro(PointsAreDeformed, bool);
  vtkGetMacro(PointsAreDeformed, bool);
  vtkBooleanMacro(PointsAreDeformed, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether a displacement field on port 1 is inverse: its vectors lead from points of the
   * deformed volume to points at rest, as registration programs write them. With Inverse points are
   * then moved by the vectors of the field, and without it by the inverse of the field. Not used
   * with a mesh. Default: off.
   */
  vtkSetMacro(FieldIsInverse, bool);
  vtkGetMacro(FieldIsInverse, bool);
  vtkBooleanMacro(FieldIsInverse, bool);
  ///@}

  /**
   * What happens to points outside the deformation, see SetOutsideMode().
   */
  enum OutsideModes
  {
    DISCARD = 0,
    EXTRAPOLATE = 1,
    KEEP = 2
  };

  ///@{
  /**
   * Set/Get what happens to points outside the deformation mesh or field.
   * - DISCARD: the deformed volume does not contain them. They do not move, and vtkValidPointMask
   *   is 0 for them.
   * - EXTRAPOLATE: they follow the affine map of the tetrahedron with the closest face of the
   *   boundary of the mesh; with a field, the displacement of the closest point of the field. (In
   *   vtkDeformVolumeFilter it is the tetrahedron of the closest voxel inside the mesh: the two may
   *   differ far from the mesh.)
   * - KEEP: they do not move, except that the displacement of the boundary fades to zero within
   *   FadeDistance.
   *
   * With Inverse, Newton's method inverts the map outside, as far as it converges. Where the
   * closest point of the mesh jumps, there are positions to which no point moves. Points at these
   * positions are outside (vtkValidPointMask is 0). Default: DISCARD.
   */
  vtkSetClampMacro(OutsideMode, int, DISCARD, KEEP);
  vtkGetMacro(OutsideMode, int);
  void SetOutsideModeToDiscard() { this->SetOutsideMode(DISCARD); }
  void SetOutsideModeToExtrapolate() { this->SetOutsideMode(EXTRAPOLATE); }
  void SetOutsideModeToKeep() { this->SetOutsideMode(KEEP); }
  ///@}

  ///@{
  /**
   * Set/Get, for OutsideMode KEEP, the distance from the mesh or the field within which the
   * displacement fades to zero, in world units. A point at the distance d is displaced as the
   * closest point of the boundary, times 1 - 3 s^2 + 2 s^3 with s = d / FadeDistance. 0: no point
   * outside moves. Negative, infinite and NaN are errors at the next update. If points outside get
   * a displacement of more than two thirds of FadeDistance, space may fold, and there is a warning.
   * Default: 0.
   */
  vtkSetMacro(FadeDistance, double);
  vtkGetMacro(FadeDistance, double);
  ///@}

  ///@{
  /**
   * Set/Get whether all point arrays of three components of type float or double are transformed
   * like the active vectors, except for normals and texture coordinates. Default: off.
   */
  vtkSetMacro(TransformAllInputVectors, bool);
  vtkGetMacro(TransformAllInputVectors, bool);
  vtkBooleanMacro(TransformAllInputVectors, bool);
  ///@}

  /**
   * Get the number of points of the last update that were outside (vtkValidPointMask is 0), of all
   * blocks, on this rank.
   */
  vtkGetMacro(NumberOfOutsidePoints, vtkIdType);

protected:
  vtkDeformGeometryFilter();
  ~vtkDeformGeometryFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** input,
    vtkInformationVector* output, int requestFromOutputPort, vtkMTimeType* mtime) override;
  int RequestDataObject(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int ExecuteInformation(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int ComputeInputUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

private:
  vtkDeformGeometryFilter(const vtkDeformGeometryFilter&) = delete;
  void operator=(const vtkDeformGeometryFilter&) = delete;

  bool Inverse = false;
  double DisplacementScale = 1.0;
  bool PointsAreDeformed = false;
  bool FieldIsInverse = false;
  int OutsideMode = DISCARD;
  double FadeDistance = 0.0;
  bool TransformAllInputVectors = false;
  vtkIdType NumberOfOutsidePoints = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
