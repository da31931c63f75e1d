// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkMaterialFromVolume
 * @brief   give the tetrahedra of a mesh the stiffness of the voxels in them
 *
 * vtkMaterialFromVolume looks up the material of each voxel of a volume in a table, by its label or
 * by ranges of its value. Each tetrahedron gets the mean of the Young modulus, the Poisson ratio
 * and the density of the voxels in it, with equal weights. The elastic filters
 * (vtkElasticDeformation) read these arrays.
 *
 * A voxel that several tetrahedra contain belongs to one of them. A tetrahedron without voxels
 * gets the material of the voxel nearest to its centroid, and a tetrahedron outside the volume gets
 * the default material.
 *
 * @par Port 0, the mesh:
 * vtkUnstructuredGrid of vtkTetra or vtkQuadraticTetra cells in the world coordinates of the
 * volume. Edges of vtkQuadraticTetra cells are treated as straight. Cells of fewer than three
 * dimensions have the default material.
 *
 * @par Port 1, the volume:
 * vtkImageData of at least two voxels on each axis: any extent, origin, spacing and direction
 * matrix. The whole volume is requested. A point array of one component and any numeric type has
 * the materials, see MaterialArrayName. Points that vtkGhostType marks as hidden or duplicate, or
 * whose vtkValidPointMask is 0, are ignored.
 *
 * @par Output:
 * The mesh, with the cell arrays "YoungModulus" (Pa), "PoissonRatio" and "Density" (kg/m^3) of
 * doubles, one component each, in place of arrays of these names. All else is shared with the
 * input.
 *
 * @par Errors:
 * Each error is reported by one vtkErrorMacro, and the output is then empty: a volume that is flat
 * or has no valid spacing; an array that does not exist or has several components; a "vtkGhostType"
 * of another type or size; a value that has no material; a Young modulus or a density of 0 or less,
 * or a Poisson ratio of less than 0 or of 0.495 and more; cells that are not tetrahedra;
 * coordinates that are not finite.
 *
 * @sa vtkFiniteElementDeformation vtkMassSpringDeformation vtkChainMailDeformation
 */
#ifndef vtkMaterialFromVolume_h
#define vtkMaterialFromVolume_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class VTKDEFORMVOLUME_EXPORT vtkMaterialFromVolume : public vtkUnstructuredGridAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkMaterialFromVolume* New();
  vtkTypeMacro(vtkMaterialFromVolume, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the volume (port 1).
   */
  void SetVolumeConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  /// Set the data object of port 1 itself, without a pipeline.
  void SetVolumeData(vtkDataObject* data) { this->SetInputDataObject(1, data); }
  ///@}

  ///@{
  /**
   * Set a material. index: an integer from 0 to 255, passed as a double because panels of ParaView
   * pass only doubles; youngModulus: in Pa, greater than 0; poissonRatio: 0 or more, less than
   * 0.495; density: in kg/m^3, greater than 0. Other values are an error in the next execution.
   *
   * There are five materials by default. Their numbers are engineering values, not measurements: 0,
   * air: 100, 0, 100; 1, soft tissue: 1e4, 0.3, 1000; 2, muscle: 5e4, 0.4, 1060; 3, cartilage: 1e6,
   * 0.4, 1100; 4, bone: 1e7, 0.3, 1900. Air is a very soft tissue, so that a mesh may contain air.
   * Bone is less stiff than real bone (1e10), because stiffer springs need shorter time steps. Soft
   * tissue bends neither of them.
   */
  void SetMaterial(double index, double youngModulus, double poissonRatio, double density);
  /**
   * Get the values of a material in the order of SetMaterial(). Returns false, and does not change
   * `values`, if the material is not defined.
   */
  bool GetMaterialValues(int index, double values[3]);
  /**
   * Remove all materials that SetMaterial() has set, including the default ones.
   */
  void ClearMaterials();
  int GetNumberOfMaterials();
  ///@}

  ///@{
  /**
   * Set/Get the tissue that an index stands for: an index from 0 to 255, and a value of
   * vtkElasticDeformation::MaterialPresetType, such as vtkElasticDeformation::LIVER. Its Young
   * modulus, Poisson ratio and density are used instead of those of SetMaterial(), whichever is
   * called first. Other indices or presets are an error, and change nothing. CUSTOM, the default of
   * all indices: the values of SetMaterial() are used.
   *
   * The numbers are those of vtkElasticDeformation::GetMaterialPresetValues(); Documents/physics.md
   * describes their limits.
   */
  void SetMaterialPreset(int index, int preset);
  int GetMaterialPreset(int index);
  /**
   * Set all indices to CUSTOM.
   */
  void ClearMaterialPresets();
  /**
   * Get the number of indices that stand for a tissue.
   */
  int GetNumberOfMaterialPresets();
  ///@}

  ///@{
  /**
   * Set/Get the name of the point array of the volume with the material of each voxel; any numeric
   * type. Without ranges (AddMaterialRange()) its values are indices of materials, as labels are.
   * "": with ranges the active scalars, without ranges DefaultMaterial for all voxels. Default: "".
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
   * Set/Get the index of the material of voxels without another material, and of tetrahedra outside
   * the volume. Default: 1, soft tissue.
   */
  vtkSetClampMacro(DefaultMaterial, int, 0, 255);
  vtkGetMacro(DefaultMaterial, int);
  ///@}

  ///@{
  /**
   * Get the number of tetrahedra of the last execution that contain no voxel and have the material
   * of the nearest one, and the number of tetrahedra with the default material: those outside the
   * volume, and those whose nearest voxel is ignored. After an error they are 0.
   */
  vtkGetMacro(NumberOfTetrahedraWithoutVoxels, vtkIdType);
  vtkGetMacro(NumberOfTetrahedraOutside, vtkIdType);
  ///@}

protected:
  vtkMaterialFromVolume();
  ~vtkMaterialFromVolume() override;

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
  vtkMaterialFromVolume(const vtkMaterialFromVolume&) = delete;
  void operator=(const vtkMaterialFromVolume&) = delete;

  void Execute(vtkInformationVector** input, vtkInformationVector* output);

  std::string MaterialArrayName;
  int DefaultMaterial = 1;
  vtkIdType NumberOfTetrahedraWithoutVoxels = 0;
  vtkIdType NumberOfTetrahedraOutside = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
