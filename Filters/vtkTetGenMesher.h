// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkTetGenMesher
 * @brief   tetrahedral deformation mesh that fits the body in a volume, or a closed surface
 *
 * vtkTetGenMesher finds the surface of the body that a volume shows, simplifies it to the requested
 * edge length, and fills it with tetrahedra. Cavities of the body are filled, too: their voxels
 * move with the body. The tetrahedra are made by TetGen (Hang Si, "TetGen, a Delaunay-based quality
 * tetrahedral mesh generator"), a separate program under its own license (AGPL), which has to be
 * installed. It runs as a child process with a time limit.
 *
 * @par What the mesh of a volume holds:
 * A voxel is a voxel of the body if its value is finite and at least the isovalue, or one of the
 * labels, and if neither vtkGhostType nor a vtkValidPointMask of 0 hides it. A piece is a connected
 * component of the body: voxels that share a face, an edge or a corner are connected. A speck is a
 * piece of at most SpeckSize voxels. It is not meshed, and its voxels are not counted as voxels of
 * the body. A voxel is inside the mesh if its center is in a tetrahedron, or on its surface, to
 * within 1/256 of a voxel.
 * @par
 * The surface follows the body at the distance of Margin. If smoothing or decimation cuts off
 * voxels, vertices of the surface are moved outwards until the tetrahedra contain them. Except for
 * rounding, no voxel of the body then lies outside the mesh, unless PieceMode leaves out pieces.
 * GetNumberOfBodyVoxelsOutside() is the number of voxels outside. If it is at least one of 1,000,
 * there is a warning.
 *
 * @par Port 0, one of:
 * - vtkImageData, the volume, with at least two voxels on each axis; origin, spacing, direction
 *   matrix and an extent that does not start at 0 are taken into account. SetInputArrayToProcess(0,
 *   0, 0, POINTS, name) chooses the array, by default, and with an empty name, the active scalars;
 * of several components the first is used. Hidden points are outside the body. If the volume's
 * border cuts off the body, the surface is closed there.
 * - vtkPolyData, a closed surface without self-intersections. Coincident points are merged and
 *   polygons split into triangles. Shells inside others are kept as surfaces, and their insides
 *   are filled too.
 *
 * @par Output:
 * vtkUnstructuredGrid in world coordinates: points in double precision, vtkTetra cells, all with
 * positive volume, no data arrays. The first piece is the whole mesh, all others are empty: with
 * several ranks, only the first one runs TetGen, and only this rank has results and warnings of the
 * execution.
 *
 * @par Errors:
 * No body at the isovalue or with the labels; a volume of one slice; a surface that is empty, open,
 * flat, not manifold, not finite or that intersects itself; an edge length or refinement spheres
 * that require more than 20 million tetrahedra; a refinement sphere that is not valid; TetGen
 * missing, failing (the error says how it ended) or exceeding TimeLimit; a result without
 * tetrahedra. Each error is reported by one vtkErrorMacro, and the output is then empty.
 *
 * @sa vtkLatticeTetrahedraSource vtkDeformVolumeFilter
 */
#ifndef vtkTetGenMesher_h
#define vtkTetGenMesher_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGridAlgorithm.h"

#include <array>  // for std::array
#include <memory> // for std::unique_ptr
#include <string> // for std::string
#include <vector> // for std::vector

class vtkDataArray;
class vtkImageData;
class vtkPolyData;
namespace deformvolume
{
class PipelineExecution;
struct BodyVoxels;
struct RefinementSphere;
struct SurfaceParameters;
struct UncoveredVoxels;
}

class VTKDEFORMVOLUME_EXPORT vtkTetGenMesher : public vtkUnstructuredGridAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkTetGenMesher* New();
  vtkTypeMacro(vtkTetGenMesher, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  /**
   * How the body of a volume is defined, see SetBodyMode().
   */
  enum BodyModes
  {
    ISOSURFACE = 0,
    LABELS = 1
  };

  /**
   * Which pieces of the body are meshed, see SetPieceMode().
   */
  enum PieceModes
  {
    ALL_PIECES = 0,
    LARGEST_PIECE = 2
  };

  ///@{
  /**
   * Set/Get how the body of a volume is defined: the voxels with at least the isovalue, or those
   * with one of the labels. Default: ISOSURFACE.
   */
  vtkSetClampMacro(BodyMode, int, ISOSURFACE, LABELS);
  vtkGetMacro(BodyMode, int);
  void SetBodyModeToIsosurface() { this->SetBodyMode(ISOSURFACE); }
  void SetBodyModeToLabels() { this->SetBodyMode(LABELS); }
  ///@}

  ///@{
  /**
   * Set/Get whether the isovalue is computed from the volume's histogram by Otsu's method, instead
   * of set by Isovalue. The padding of CT (less than -1024) and metal do not count. Default: on.
   */
  vtkSetMacro(AutomaticIsovalue, bool);
  vtkGetMacro(AutomaticIsovalue, bool);
  vtkBooleanMacro(AutomaticIsovalue, bool);
  ///@}

  ///@{
  /**
   * Set/Get the isovalue when AutomaticIsovalue is off, in the array's units. Default 0.
   */
  vtkSetMacro(Isovalue, double);
  vtkGetMacro(Isovalue, double);
  ///@}

  ///@{
  /**
   * The labels of the body in the mode LABELS. Default: no labels, which means every label other
   * than 0.
   */
  void AddLabel(vtkTypeInt64 label);
  /// Remove all labels.
  void ClearLabels();
  int GetNumberOfLabels();
  vtkTypeInt64 GetLabel(int index);
  ///@}

  ///@{
  /**
   * Set/Get which pieces of a body are meshed: all (ALL_PIECES), or only the piece with the most
   * voxels (LARGEST_PIECE). Pieces whose meshes would touch, because of Margin, are meshed as one.
   * Volumes only. The value 1, formerly the convex hull, sets ALL_PIECES, with a warning. Default:
   * ALL_PIECES.
   */
  void SetPieceMode(int mode);
  int GetPieceModeMinValue() { return ALL_PIECES; }
  int GetPieceModeMaxValue() { return LARGEST_PIECE; }
  vtkGetMacro(PieceMode, int);
  void SetPieceModeToAllPieces() { this->SetPieceMode(ALL_PIECES); }
  void SetPieceModeToLargestPiece() { this->SetPieceMode(LARGEST_PIECE); }
  ///@}

  ///@{
  /**
   * Set/Get the largest size of a speck: pieces of at most this number of voxels are not meshed. 0:
   * there are no specks. A body that has only specks is meshed. Volumes only. Default: 26, one less
   * than a cube of 3 x 3 x 3 voxels; at least 0.
   */
  vtkSetClampMacro(SpeckSize, int, 0, VTK_INT_MAX);
  vtkGetMacro(SpeckSize, int);
  ///@}

  ///@{
  /**
   * Set/Get the length of the edges of the tetrahedra, in world units; 0 is a twentieth of the
   * diagonal of the input's bounding box. The surface does not follow finer detail, but encloses
   * it. Default 0, at least 0.
   */
  vtkSetClampMacro(TargetEdgeLength, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(TargetEdgeLength, double);
  ///@}

  ///@{
  /**
   * Set/Get the distance by which the mesh extends beyond the body, as a multiple of the target
   * edge length, so that the body's skin lies well inside the mesh and is deformed with it. A
   * simulation of the mesh simulates the margin as well: set 0.1 for it (Documents/physics.md).
   * Volumes only. Default: 0.5, range 0 to 10.
   */
  vtkSetClampMacro(Margin, double, 0.0, 10.0);
  vtkGetMacro(Margin, double);
  ///@}

  ///@{
  /**
   * Set/Get the iterations of windowed-sinc smoothing of a volume's surface, 0: none. If smoothing
   * makes the surface intersect itself, the surface is smoothed less. Default: 20, at most 1000.
   */
  vtkSetClampMacro(SmoothingIterations, int, 0, 1000);
  vtkGetMacro(SmoothingIterations, int);
  ///@}

  ///@{
  /**
   * Set/Get whether a surface with triangles finer than the target edge length is decimated to it.
   * If decimation makes the surface intersect itself, the surface is meshed without it (that of a
   * volume with less detail). Default: on.
   */
  vtkSetMacro(Decimation, bool);
  vtkGetMacro(Decimation, bool);
  vtkBooleanMacro(Decimation, bool);
  ///@}

  ///@{
  /**
   * Spheres with shorter edges: within a sphere, all edges, including those of the surface, are at
   * most edgeLength long. Outside, edges grow to the target edge length. A local displacement looks
   * smooth if the edges are at most a sixth of its radius. With longer edges, the tetrahedra are
   * visible as facets. All numbers are in world units; the radius and the edge length have to be
   * greater than 0, otherwise the update fails. An edge length above the target has no effect.
   * Default: no spheres. GetRefinementSphere() returns the center, the radius and the edge length,
   * all 0 for an index that is out of range.
   */
  void AddRefinementSphere(double x, double y, double z, double radius, double edgeLength);
  /// Remove all spheres.
  void ClearRefinementSpheres();
  int GetNumberOfRefinementSpheres();
  void GetRefinementSphere(int index, double sphere[5]);
  ///@}

  ///@{
  /**
   * Set/Get the quality of the tetrahedra: the greatest ratio of the radius of the circumscribed
   * sphere to the shortest edge that TetGen aims at inside the body (0.612 is a regular
   * tetrahedron). The lower, the more tetrahedra. Default 1.414, from 1 to 100.
   */
  vtkSetClampMacro(RadiusEdgeRatio, double, 1.0, 100.0);
  vtkGetMacro(RadiusEdgeRatio, double);
  ///@}

  ///@{
  /**
   * Set/Get the time limit for one execution of TetGen, in s. An update may execute TetGen several
   * times. Default: 60, at least 0.001.
   */
  vtkSetClampMacro(TimeLimit, double, 0.001, VTK_DOUBLE_MAX);
  vtkGetMacro(TimeLimit, double);
  ///@}

  ///@{
  /**
   * Set/Get the TetGen program: a path, or a name that is searched on PATH. Default: "", which
   * means the value of the environment variable DEFORMVOLUME_TETGEN, or else the program found when
   * this library was built, or else "tetgen" on PATH.
   */
  vtkSetMacro(TetGenExecutable, std::string);
  vtkGetMacro(TetGenExecutable, std::string);
  ///@}

  ///@{
  /**
   * Get the isovalue and the target edge length that the last execution used.
   */
  vtkGetMacro(UsedIsovalue, double);
  vtkGetMacro(UsedTargetEdgeLength, double);
  ///@}

  ///@{
  /**
   * Get results of the last execution: the number of voxels of the body; the number of these voxels
   * that are in no tetrahedron, including those of pieces that were left out; the number of voxels
   * of specks, which are in neither of these numbers; and the number of pieces that are not specks.
   * 0 for a surface.
   */
  vtkGetMacro(NumberOfBodyVoxels, vtkIdType);
  vtkGetMacro(NumberOfBodyVoxelsOutside, vtkIdType);
  vtkGetMacro(NumberOfSpeckVoxels, vtkIdType);
  vtkGetMacro(NumberOfPieces, vtkIdType);
  ///@}

  /**
   * Get these numbers as text, one in each line; "" before the first execution and for a surface.
   */
  std::string GetSummary();

protected:
  vtkTetGenMesher();
  ~vtkTetGenMesher() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector, int requestFromOutputPort, vtkMTimeType* mtime) override;

  int BodyMode = ISOSURFACE;
  bool AutomaticIsovalue = true;
  double Isovalue = 0.0;
  std::vector<vtkTypeInt64> Labels;
  int PieceMode = ALL_PIECES;
  int SpeckSize = 26;
  double TargetEdgeLength = 0.0;
  double Margin = 0.5;
  int SmoothingIterations = 20;
  bool Decimation = true;
  std::vector<std::array<double, 5>> RefinementSpheres;
  double RadiusEdgeRatio = 1.414;
  double TimeLimit = 60.0;
  std::string TetGenExecutable;

private:
  using Spheres = std::vector<deformvolume::RefinementSphere>;
  void MeshVolume(
    vtkImageData* volume, vtkDataArray* array, const Spheres& spheres, vtkUnstructuredGrid* output);
  void MeshSurface(vtkPolyData* surface, const Spheres& spheres, vtkUnstructuredGrid* output);
  deformvolume::UncoveredVoxels MeshBody(const deformvolume::BodyVoxels& body,
    const deformvolume::SurfaceParameters& parameters, const Spheres& spheres, bool isLast,
    vtkUnstructuredGrid* output);
  static void CheckSize(vtkPolyData* surface, double length, const Spheres& spheres);
  vtkSmartPointer<vtkUnstructuredGrid> Fill(
    vtkPolyData* surface, double length, const Spheres& spheres, bool diagnose);
  void WarnOfVoxelsOutside();
  void CheckStep(double share);
  std::string FindExecutable();

  double UsedIsovalue = 0.0;
  double UsedTargetEdgeLength = 0.0;
  vtkIdType NumberOfBodyVoxels = 0;
  vtkIdType NumberOfBodyVoxelsOutside = 0;
  vtkIdType NumberOfSpeckVoxels = 0;
  vtkIdType NumberOfPieces = 0;
  std::unique_ptr<deformvolume::PipelineExecution> Execution;

  vtkTetGenMesher(const vtkTetGenMesher&) = delete;
  void operator=(const vtkTetGenMesher&) = delete;
};

#endif
