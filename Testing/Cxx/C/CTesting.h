// SPDX-License-Identifier: BSD-3-Clause
// For the tests of the interface for C: a dv_deformer that is compared with a
// vtkDeformVolumeFilter.
#ifndef CTesting_h
#define CTesting_h

#include "FilterTesting.h"

#include "deformvolume.h"

#include <vtkDataSetAttributes.h>
#include <vtkIdList.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace filterTesting
{

inline const std::map<int, std::int32_t> Types{ { VTK_SIGNED_CHAR, DV_INT8 },
  { VTK_UNSIGNED_CHAR, DV_UINT8 }, { VTK_SHORT, DV_INT16 }, { VTK_UNSIGNED_SHORT, DV_UINT16 },
  { VTK_INT, DV_INT32 }, { VTK_UNSIGNED_INT, DV_UINT32 }, { VTK_LONG_LONG, DV_INT64 },
  { VTK_UNSIGNED_LONG_LONG, DV_UINT64 }, { VTK_FLOAT, DV_FLOAT32 }, { VTK_DOUBLE, DV_FLOAT64 } };

inline void Check(std::int32_t status)
{
  EXPECT_EQ(status, DV_OK) << dv_last_error();
}

inline dv_grid MakeGrid(vtkImageData* image)
{
  dv_grid grid = {};
  grid.struct_size = sizeof(grid);
  std::copy_n(image->GetExtent(), 6, grid.extent);
  std::copy_n(image->GetOrigin(), 3, grid.origin);
  std::copy_n(image->GetSpacing(), 3, grid.spacing);
  std::copy_n(image->GetDirectionMatrix()->GetData(), 9, grid.direction);
  return grid;
}

/// A dv_deformer, with functions that set the inputs of a filter.
class InC
{
public:
  InC() { Check(dv_create(&this->Deformer)); }
  ~InC() { dv_destroy(this->Deformer); }
  InC(const InC&) = delete;
  InC& operator=(const InC&) = delete;

  void SetVolume(
    vtkImageData* volume, double background, const std::set<std::string>& categorical = {})
  {
    const dv_grid grid = MakeGrid(volume);
    Check(dv_set_volume(this->Deformer, &grid));
    std::vector<dv_array> arrays;
    this->Sizes.clear();
    vtkDataArray* blanked = nullptr;
    for (int i = 0; i < volume->GetPointData()->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* values = volume->GetPointData()->GetArray(i);
      const std::string name = values->GetName();
      if (name == "vtkGhostType")
      {
        blanked = values;
      }
      if (name == "vtkGhostType" || name == "CutDistance" || name == "BoundaryDistance")
      {
        continue;
      }
      dv_array array = {};
      array.struct_size = sizeof(array);
      array.data = values->GetVoidPointer(0);
      array.type = Types.at(values->GetDataType());
      array.components = values->GetNumberOfComponents();
      array.categorical = categorical.count(values->GetName()) > 0 ? 1 : 0;
      array.density = this->Densities.count(values->GetName()) > 0 ? 1 : 0;
      array.background = array.density != 0 ? 0.0 : background; // as in vtkDeformVolumeFilter
      arrays.push_back(array);
      this->Names.emplace_back(values->GetName());
      const bool isFloats = array.density != 0 && array.type != DV_FLOAT64;
      this->Sizes.push_back(
        (isFloats ? sizeof(float) : static_cast<std::size_t>(values->GetDataTypeSize())) *
        static_cast<std::size_t>(array.components));
    }
    Check(dv_set_arrays(this->Deformer, static_cast<std::int32_t>(arrays.size()), arrays.data()));
    Check(dv_set_blanked(this->Deformer,
      blanked ? static_cast<const std::uint8_t*>(blanked->GetVoidPointer(0)) : nullptr));
    this->Background = background;
    const auto find = [](vtkDataSetAttributes* attributes, const char* name)
    {
      vtkDataArray* array = attributes->GetArray(name);
      return array ? array->GetVoidPointer(0) : nullptr;
    };
    vtkCellData* cells = volume->GetCellData();
    vtkPointData* points = volume->GetPointData();
    Check(dv_set_active_tetrahedra(
      this->Deformer, static_cast<const std::uint8_t*>(find(cells, "ActiveTetrahedra"))));
    Check(dv_set_boundary_distances(
      this->Deformer, static_cast<const float*>(find(points, "BoundaryDistance"))));
    Check(dv_set_smooth_cut(this->Deformer,
      static_cast<const std::uint8_t*>(find(cells, "CutTetrahedra")),
      static_cast<const float*>(find(points, "CutDistance"))));
  }

  void SetMesh(vtkUnstructuredGrid* grid)
  {
    std::vector<std::int64_t> offsets{ 0 };
    std::vector<std::int64_t> connectivity;
    std::vector<std::uint8_t> types;
    std::vector<std::int64_t> faces;
    bool areTetrahedra = true;
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
    {
      vtkIdType count = 0;
      const vtkIdType* points = nullptr;
      grid->GetCellPoints(cell, count, points);
      connectivity.insert(connectivity.end(), points, points + count);
      offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
      types.push_back(static_cast<std::uint8_t>(grid->GetCellType(cell)));
      areTetrahedra = areTetrahedra && types.back() == VTK_TETRA;
      if (types.back() == VTK_POLYHEDRON)
      {
        vtkNew<vtkIdList> stream;
        grid->GetFaceStream(cell, stream);
        faces.insert(faces.end(), stream->begin(), stream->end());
      }
    }
    dv_mesh mesh = {};
    mesh.struct_size = sizeof(mesh);
    mesh.number_of_points = grid->GetNumberOfPoints();
    mesh.points = grid->GetPoints()->GetVoidPointer(0);
    mesh.point_type = Types.at(grid->GetPoints()->GetDataType());
    mesh.number_of_cells = grid->GetNumberOfCells();
    mesh.connectivity = connectivity.data();
    mesh.types = areTetrahedra ? nullptr : types.data();
    mesh.offsets = areTetrahedra ? nullptr : offsets.data();
    mesh.faces = faces.data();
    mesh.number_of_face_values = static_cast<std::int64_t>(faces.size());
    Check(dv_set_mesh(this->Deformer, &mesh));
    this->SetDisplacements(grid);
  }

  void SetDisplacements(vtkDataSet* mesh)
  {
    vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
    Check(dv_set_displacements(this->Deformer, Types.at(vectors->GetDataType()),
      vectors->GetNumberOfTuples(), vectors->GetVoidPointer(0)));
  }

  void SetField(vtkImageData* image, bool isInverse)
  {
    vtkDataArray* vectors = image->GetPointData()->GetVectors();
    const dv_grid grid = MakeGrid(image);
    dv_field field = {};
    field.struct_size = sizeof(field);
    field.grid = &grid;
    field.vectors = vectors->GetVoidPointer(0);
    field.type = Types.at(vectors->GetDataType());
    field.inverse = isInverse ? 1 : 0;
    vtkDataArray* ghosts = image->GetPointData()->GetArray("vtkGhostType");
    field.undefined =
      ghosts ? static_cast<const std::uint8_t*>(ghosts->GetVoidPointer(0)) : nullptr;
    Check(dv_set_field(this->Deformer, &field));
  }

  void SetReference(vtkImageData* image)
  {
    const dv_grid grid = MakeGrid(image);
    Check(dv_set_reference(this->Deformer, &grid));
  }

  /// The names of the arrays that are densities. Set them before SetVolume().
  std::set<std::string> Densities;
  /// Whether Deform() requests rest positions and Jacobians, and an incremental update.
  bool WithExtra = false;
  bool IsIncremental = false;
  std::int32_t Interpolation = DV_LINEAR;

  void Deform()
  {
    dv_grid grid = {};
    grid.struct_size = sizeof(grid);
    Check(dv_output_grid(this->Deformer, &grid));
    this->Grid = grid;
    std::size_t voxels = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      voxels *= static_cast<std::size_t>(grid.extent[2 * axis + 1] - grid.extent[2 * axis] + 1);
    }
    dv_request request = {};
    request.struct_size = sizeof(request);
    std::vector<void*> outputs;
    this->Outputs.resize(this->Sizes.size());
    for (std::size_t i = 0; i < this->Sizes.size(); ++i)
    {
      this->Outputs[i].resize(voxels * this->Sizes[i]);
      outputs.push_back(this->Outputs[i].data());
    }
    this->Coverage.resize(voxels);
    request.number_of_outputs = static_cast<std::int32_t>(outputs.size());
    request.outputs = outputs.data();
    request.coverage = this->Coverage.data();
    request.interpolation = this->Interpolation;
    request.incremental = this->IsIncremental ? 1 : 0;
    if (this->WithExtra)
    {
      this->RestPositions.resize(3 * voxels);
      this->Jacobian.resize(voxels);
      request.rest_positions = this->RestPositions.data();
      request.jacobian = this->Jacobian.data();
      request.extra_background = this->Background;
    }
    this->Report.struct_size = sizeof(this->Report);
    Check(dv_deform(this->Deformer, &request, &this->Report));
  }

  /// Whether values are equal to those of an array of an image, bit by bit.
  template <typename T>
  static bool AreBits(const std::vector<T>& made, vtkImageData* image, const char* name)
  {
    vtkDataArray* array = image->GetPointData()->GetArray(name);
    const std::size_t bytes = made.size() * sizeof(T);
    return array &&
      bytes ==
      static_cast<std::size_t>(array->GetNumberOfValues()) *
        static_cast<std::size_t>(array->GetDataTypeSize()) &&
      std::memcmp(made.data(), array->GetVoidPointer(0), bytes) == 0;
  }

  /// Deforms, and compares all results with those of a filter. warning: a part of the warning that
  /// both must report, or "" for none.
  void Compare(Deformed& deformed, const std::string& warning = "")
  {
    vtkImageData* wanted = deformed.Expect(warning);
    this->Deform();
    const dv_grid grid = MakeGrid(wanted);
    EXPECT_TRUE(std::equal(grid.extent, grid.extent + 6, this->Grid.extent));
    EXPECT_TRUE(std::equal(grid.origin, grid.origin + 3, this->Grid.origin));
    EXPECT_TRUE(std::equal(grid.spacing, grid.spacing + 3, this->Grid.spacing));
    EXPECT_TRUE(std::equal(grid.direction, grid.direction + 9, this->Grid.direction));
    for (std::size_t i = 0; i < this->Outputs.size(); ++i)
    {
      EXPECT_TRUE(AreBits(this->Outputs[i], wanted, this->Names[i].c_str()));
    }
    EXPECT_TRUE(AreBits(this->Coverage, wanted, "vtkValidPointMask"));
    EXPECT_TRUE(!this->WithExtra || AreBits(this->RestPositions, wanted, "RestPosition"));
    EXPECT_TRUE(!this->WithExtra || AreBits(this->Jacobian, wanted, "Jacobian"));
    EXPECT_EQ(this->Report.number_of_covered_voxels, deformed.Filter->GetNumberOfCoveredVoxels());
    EXPECT_GT(this->Report.number_of_covered_voxels, 100);
    EXPECT_EQ(
      this->Report.number_of_inverted_tetrahedra, deformed.Filter->GetNumberOfInvertedTetrahedra());
    EXPECT_EQ(this->Report.number_of_flat_tetrahedra, deformed.Filter->GetNumberOfFlatTetrahedra());
    EXPECT_EQ(std::string(this->Report.device), deformed.Filter->GetDeviceInUse());
    if (warning.empty())
    {
      EXPECT_EQ(std::string(this->Report.warnings), std::string());
    }
    EXPECT_TRUE(HasPart(this->Report.warnings, warning));
  }

  dv_deformer* Deformer = nullptr;
  dv_report Report = {};
  dv_grid Grid = {};

private:
  double Background = 0.0;
  std::vector<std::string> Names;
  std::vector<std::size_t> Sizes; // bytes of each voxel
  std::vector<std::vector<unsigned char>> Outputs;
  std::vector<std::int8_t> Coverage;
  std::vector<float> RestPositions;
  std::vector<float> Jacobian;
};

inline glm::dvec3 Bend(const glm::dvec3& p)
{
  return p + glm::dvec3(0.02 * p.z * p.z, 1.5 * std::sin(0.3 * p.x), 0.05 * p.x * p.y);
}

/// A volume without arrays, on an oblique grid.
inline vtkSmartPointer<vtkImageData> MakeObliqueVolume()
{
  auto volume =
    MakeImage({ { -7, 12, 3, 20, -9, 8 } }, glm::dvec3(0.7, -1.1, 0.9), glm::dvec3(3.0, -4.0, 2.0));
  SetObliqueDirection(volume);
  return volume;
}

/// Adds an array of the type of the second argument, which is not the active scalars.
template <typename T>
void AddValues(vtkImageData* volume, T, const char* name, const WorldFunction& function)
{
  AddScalars<T>(volume, name, function);
  volume->GetPointData()->SetActiveAttribute(-1, vtkDataSetAttributes::SCALARS);
}

inline double Wave(const glm::dvec3& p)
{
  return 60.0 * std::sin(0.7 * p.x) + 40.0 * std::cos(0.9 * p.y) + 5.0 * p.z;
}

/// Adds the labels 0 to 6.
inline void AddLabels(vtkImageData* volume)
{
  AddValues(volume, static_cast<unsigned char>(0), "labels",
    [](const glm::dvec3& p) { return std::fmod(std::abs(Wave(p)), 7.0); });
}

/// A volume with an array of shorts and one of floats, for tests that do not depend on types. The
/// kernels for many arrays take seconds to compile.
inline vtkSmartPointer<vtkImageData> MakeTwoArrays()
{
  auto volume = MakeObliqueVolume();
  AddValues(volume, short{}, "int16", Wave);
  AddValues(volume, float{}, "float", [](const glm::dvec3& p) { return 0.1 * Wave(p); });
  return volume;
}

/// A volume with arrays of many types: values, labels and vectors.
inline vtkSmartPointer<vtkImageData> MakeManyArrays()
{
  auto volume = MakeObliqueVolume();
  using SignedChar = signed char;
  AddValues(volume, SignedChar{}, "int8", Wave);
  using Unsigned = unsigned short;
  AddValues(
    volume, Unsigned{}, "uint16", [](const glm::dvec3& p) { return 200.0 * (Wave(p) + 150.0); });
  AddValues(volume, int{}, "int32", Wave);
  using Long = long long;
  AddValues(volume, Long{}, "int64", [](const glm::dvec3& p) { return 1e10 * Wave(p); });
  AddValues(volume, double{}, "double", Wave);
  AddLabels(volume);
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("vectors");
  vectors->SetNumberOfComponents(2);
  vectors->SetNumberOfTuples(volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < vectors->GetNumberOfValues(); ++i)
  {
    vectors->SetValue(i, static_cast<float>(std::sin(0.37 * static_cast<double>(i))));
  }
  volume->GetPointData()->AddArray(vectors);
  return volume;
}

} // namespace filterTesting

#endif
