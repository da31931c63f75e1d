// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLatticeTetrahedraSource
 * @brief   regular tetrahedral deformation mesh of a box or of a volume
 *
 * vtkLatticeTetrahedraSource makes the simplest deformation mesh: a regular lattice of nodes whose
 * cells are split into five tetrahedra each, mirrored from cell to neighbouring cell so that
 * shared faces match. It is the split that vtkDeformVolumeFilter uses for the voxels themselves.
 *
 * @par Port 0, optional, the volume:
 * vtkImageData, of which only the geometry is used. The lattice then covers the volume's whole
 * extent, from the first voxel centre to the last, along the volume's own axes: origin, spacing,
 * direction matrix and an extent that does not start at 0 are honoured. Each axis needs at least
 * two voxels. Without an input the lattice covers Bounds, along the world axes.
 *
 * @par Output:
 * vtkUnstructuredGrid. Points in double precision, the first axis varying fastest. Cells are
 * vtkTetra, all with positive volume (the fourth vertex on the side to which the normal of the
 * first three points); the five of a cell follow each other. For Dimensions of nx, ny and nz there
 * are nx * ny * nz points and 5 (nx-1) (ny-1) (nz-1) tetrahedra. The first piece is the whole
 * lattice, all others are empty.
 *
 * @par Errors:
 * Bounds that are empty or not finite, a volume with fewer than two voxels on an axis, fewer than
 * two nodes on an axis, and a lattice too large to be stored.
 *
 * @sa vtkTetGenMesher vtkDeformVolumeFilter
 */
#ifndef vtkLatticeTetrahedraSource_h
#define vtkLatticeTetrahedraSource_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkUnstructuredGridAlgorithm.h"

class VTKDEFORMVOLUME_EXPORT vtkLatticeTetrahedraSource : public vtkUnstructuredGridAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkLatticeTetrahedraSource* New();
  vtkTypeMacro(vtkLatticeTetrahedraSource, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Set/Get the number of nodes on each axis, at least 2; with EqualSpacing, at most as many.
   * Default: 13, 13, 13.
   */
  vtkSetVector3Macro(NumberOfNodes, int);
  vtkGetVector3Macro(NumberOfNodes, int);
  ///@}

  ///@{
  /**
   * Set/Get whether the cells are cubes, as vtkMassSpringDeformation needs them and as tetrahedra
   * are best. The edge of a cube is then the longest of the distances that NumberOfNodes gives on
   * the axes. Axes on which that takes fewer nodes get fewer, and the lattice reaches beyond the
   * box or the volume there, by less than half a cell and as far on both sides. When off, each axis
   * has NumberOfNodes, and the lattice ends where the box ends. Where the axes of a volume are not
   * perpendicular, edges are equally long, but cells are no cubes. Default: on.
   */
  vtkSetMacro(EqualSpacing, bool);
  vtkGetMacro(EqualSpacing, bool);
  vtkBooleanMacro(EqualSpacing, bool);
  ///@}

  ///@{
  /**
   * Nodes on each axis of the last output; 0, 0, 0 where that is empty.
   */
  vtkGetVector3Macro(Dimensions, int);
  ///@}

  ///@{
  /**
   * Set/Get the box in world coordinates (x min, x max, y min, y max, z min, z max) that the
   * lattice covers when no volume is connected. Default: -0.5, 0.5, -0.5, 0.5, -0.5, 0.5.
   */
  vtkSetVector6Macro(Bounds, double);
  vtkGetVector6Macro(Bounds, double);
  ///@}

  ///@{
  /**
   * Set/Get how far the lattice reaches beyond the box or the volume on each side at least, in
   * world units, at least 0. Default 0: without EqualSpacing, the outermost voxel centres lie on
   * the lattice's boundary.
   */
  vtkSetClampMacro(Margin, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Margin, double);
  ///@}

protected:
  vtkLatticeTetrahedraSource();
  ~vtkLatticeTetrahedraSource() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector, int requestFromOutputPort, vtkMTimeType* mtime) override;

  int NumberOfNodes[3] = { 13, 13, 13 };
  double Bounds[6] = { -0.5, 0.5, -0.5, 0.5, -0.5, 0.5 };
  double Margin = 0.0;
  bool EqualSpacing = true;
  int Dimensions[3] = { 0, 0, 0 };

private:
  bool Incomplete = false; // whether the last execution failed or was aborted

  vtkLatticeTetrahedraSource(const vtkLatticeTetrahedraSource&) = delete;
  void operator=(const vtkLatticeTetrahedraSource&) = delete;
};

#endif
