// SPDX-License-Identifier: BSD-3-Clause
// ChainMail of the interface for C is equal, bit by bit, to vtkChainMailDeformation. A dv_deformer
// that uses its displacements is equal to a vtkDeformVolumeFilter downstream of the filter.
// Testing/C/TestChainMail.c tests misuse.
#include "ArrayMaking.h"
#include "CTesting.h"
#include "ChainMailTesting.h"
#include "FilterTesting.h"

#include "vtkCutVolume.h"

#include <vtkDoubleArray.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <vector>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

/// A dv_chainmail that is compared with a vtkChainMailDeformation.
class MailInC
{
public:
  explicit MailInC(vtkImageData* volume)
    : Voxels(static_cast<std::size_t>(volume->GetNumberOfPoints()))
  {
    const dv_grid grid = MakeGrid(volume);
    Check(dv_chainmail_create(&grid, nullptr, 0, &this->ChainMail));
  }
  ~MailInC() { dv_chainmail_destroy(this->ChainMail); }
  MailInC(const MailInC&) = delete;
  MailInC& operator=(const MailInC&) = delete;

  /// Makes a step with the parameters of the filter.
  void Step(const std::vector<Handle>& handles, vtkChainMailDeformation* filter)
  {
    std::vector<double> rest;
    std::vector<double> now;
    for (const Handle& handle : handles)
    {
      rest.insert(rest.end(), { handle.Rest.x, handle.Rest.y, handle.Rest.z });
      now.insert(now.end(), { handle.Now.x, handle.Now.y, handle.Now.z });
    }
    dv_chainmail_request request = {};
    request.struct_size = sizeof(request);
    request.number_of_handles = static_cast<std::int64_t>(handles.size());
    request.rest_positions = rest.data();
    request.positions = now.data();
    request.handle_radius = filter->GetHandleRadius();
    request.elasticity = filter->GetElasticity();
    request.plasticity_threshold = filter->GetPlasticityThreshold();
    request.relaxation_sweeps = filter->GetRelaxationSweeps();
    this->Report.struct_size = sizeof(this->Report);
    Check(dv_chainmail_step(this->ChainMail, &request, &this->Report));
  }

  /// Makes a step, executes the filter with the same handles, and compares.
  void Compare(Dragged& dragged, const std::vector<Handle>& handles)
  {
    vtkFloatArray* wanted = dragged.Drag(handles);
    this->Step(handles, dragged.Filter);
    const float* made = nullptr;
    Check(dv_chainmail_displacements(this->ChainMail, &made));
    EXPECT_EQ(static_cast<std::size_t>(wanted->GetNumberOfTuples()), this->Voxels);
    EXPECT_EQ(std::memcmp(made, wanted->GetPointer(0), 3 * sizeof(float) * this->Voxels), 0);
    EXPECT_EQ(this->Report.number_of_moved_voxels,
      std::int64_t{ dragged.Filter->GetNumberOfMovedVoxels() });
    EXPECT_EQ(this->Report.number_of_sweeps, std::int64_t{ dragged.Filter->GetNumberOfSweeps() });
    EXPECT_EQ(this->Report.largest_violation, dragged.Filter->GetLargestViolation());
    EXPECT_EQ(this->Report.number_of_reduced_handles, dragged.Filter->GetNumberOfReducedHandles());
    EXPECT_EQ(
      this->Report.number_of_released_handles, dragged.Filter->GetNumberOfReleasedHandles());
    EXPECT_TRUE(std::equal(this->Report.changed_extent, this->Report.changed_extent + 6,
      dragged.Filter->GetChangedExtent()));
    EXPECT_EQ(std::string(dv_chainmail_device(this->ChainMail)),
      std::string(dragged.Filter->GetDeviceInUse()));
  }

  dv_chainmail* ChainMail = nullptr;
  dv_chainmail_report Report = {};

private:
  std::size_t Voxels;
};

dv_array MakeArrayInC(vtkDataArray* values)
{
  dv_array array = {};
  array.struct_size = sizeof(array);
  array.data = values->GetVoidPointer(0);
  array.type = Types.at(values->GetDataType());
  array.components = values->GetNumberOfComponents();
  return array;
}

glm::dvec3 GetCenter(vtkImageData* volume)
{
  glm::dvec3 center;
  volume->GetCenter(&center.x);
  return center;
}

std::vector<Handle> MakeDrag(vtkImageData* volume, double by)
{
  const glm::dvec3 center = GetCenter(volume);
  const glm::dvec3 other = center + glm::dvec3(-3.0, 2.0, 2.5);
  return { { center, center + by * glm::dvec3(1.3, -0.7, 0.4) },
    { other, other + by * glm::dvec3(-0.2, 0.9, 0.6) } };
}

// Default materials, labels, ranges and tables of materials, over several steps with relaxation.
TEST(CChainMail, Steps)
{
  const auto volume = MakeManyArrays();
  vtkDataArray* labels = volume->GetPointData()->GetArray("labels"); // 0 to 6
  for (const std::string kind : { "default", "labels", "ranges", "table" })
  {
    Dragged dragged(volume);
    dragged.Filter->SetRelaxationSweeps(4);
    dragged.Filter->SetElasticity(0.7);
    dragged.Filter->SetHandleRadius(1.5);
    dragged.Filter->SetPlasticityThreshold(0.01);
    MailInC inC(volume);
    dv_chainmail_materials materials = {};
    materials.struct_size = sizeof(materials);
    materials.default_material = 1;
    std::vector<double> table{ 0.1, 2.0, 1.0, 0.5, 1.5, 0.5, 0.8, 1.2, 0.2, 0.95, 1.05, 0.05, 0.99,
      1.01, 0.01, 0.7, 1.9, 0.4, 0.6, 1.1, 0.3 };
    dv_array array = MakeArrayInC(labels);
    const std::vector<double> ranges{ -50.0, 0.0, 3.0, 0.0, 1e9, 0.0 };
    if (kind == "labels" || kind == "table")
    {
      dragged.Filter->SetMaterial(5, 0.7, 1.9, 0.4);
      dragged.Filter->SetMaterial(6, 0.6, 1.1, 0.3);
      materials.table = table.data();
      materials.number_of_materials = 7;
    }
    if (kind == "labels")
    {
      dragged.Filter->SetMaterialArrayName("labels");
      materials.values = &array;
    }
    if (kind == "table")
    {
      dragged.Filter->SetDefaultMaterial(6);
      materials.default_material = 6;
    }
    if (kind == "ranges")
    {
      dragged.Filter->SetMaterialArrayName("double");
      dragged.Filter->AddMaterialRange(-50.0, 0.0, 3);
      dragged.Filter->AddMaterialRange(0.0, 1e9, 0);
      dragged.Filter->SetDefaultMaterial(2);
      array = MakeArrayInC(volume->GetPointData()->GetArray("double"));
      materials.values = &array;
      materials.ranges = ranges.data();
      materials.number_of_ranges = 2;
      materials.default_material = 2;
    }
    if (kind != "default")
    {
      Check(dv_chainmail_set_materials(inC.ChainMail, &materials));
    }
    for (const double by : { 1.0, 2.5, 4.0 })
    {
      inC.Compare(dragged, MakeDrag(volume, by));
      EXPECT_GT(inC.Report.number_of_moved_voxels, 100);
    }
    // Without handles the relaxation continues.
    inC.Compare(dragged, {});
    EXPECT_GT(inC.Report.number_of_moved_voxels, 100);
  }
}

// Pinned voxels, and a cut and a smooth cut by the masks of a dv_deformer.
TEST(CChainMail, Masks)
{
  const auto volume = MakeTwoArrays();
  const auto pinned = MakeArray<vtkUnsignedCharArray>("Pinned", volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < pinned->GetNumberOfTuples(); ++i)
  {
    pinned->SetValue(i, i % 20 < 2 ? 7 : 0);
  }
  volume->GetPointData()->AddArray(pinned);
  const glm::dvec3 center = GetCenter(volume);
  vtkNew<vtkPlaneSource> sheet;
  sheet->SetOrigin(center.x - 20.0, center.y - 20.0, center.z - 0.3);
  sheet->SetPoint1(center.x + 20.0, center.y - 20.0, center.z - 0.3);
  sheet->SetPoint2(center.x - 20.0, center.y + 20.0, center.z - 0.3);
  sheet->Update();
  const std::array<double, 12> points{ { center.x - 20.0, center.y - 20.0, center.z - 0.3,
    center.x + 20.0, center.y - 20.0, center.z - 0.3, center.x - 20.0, center.y + 20.0,
    center.z - 0.3, center.x + 20.0, center.y + 20.0, center.z - 0.3 } };
  const std::array<std::int64_t, 6> triangles{ { 0, 1, 3, 0, 3, 2 } };
  dv_surface surface = {};
  surface.struct_size = sizeof(surface);
  surface.number_of_points = 4;
  surface.points = points.data();
  surface.point_type = DV_FLOAT64;
  surface.number_of_triangles = 2;
  surface.triangles = triangles.data();
  for (const bool isSmooth : { false, true })
  {
    vtkNew<vtkCutVolume> cut;
    cut->SetInputData(volume);
    cut->SetSheetData(sheet->GetOutput());
    cut->SetSmoothCut(isSmooth);
    cut->Update();
    Dragged dragged(cut->GetOutput());
    dragged.Filter->SetRelaxationSweeps(3);
    MailInC inC(volume);
    Check(dv_chainmail_set_pinned(inC.ChainMail, pinned->GetPointer(0)));
    dv_deformer* deformer = nullptr;
    Check(dv_create(&deformer));
    const dv_grid grid = MakeGrid(volume);
    Check(dv_set_volume(deformer, &grid));
    dv_edit edit = {};
    edit.struct_size = sizeof(edit);
    edit.smooth = isSmooth ? 1 : 0;
    Check(dv_cut(deformer, &surface, &edit));
    dv_masks masks = {};
    masks.struct_size = sizeof(masks);
    Check(dv_get_masks(deformer, &masks));
    EXPECT_GT(masks.number_of_divided_tetrahedra + masks.number_of_switched_off_tetrahedra, 1000);
    Check(dv_chainmail_set_active_tetrahedra(inC.ChainMail, masks.active, masks.crossed));
    dv_destroy(deformer);
    for (const double by : { 1.0, 3.0 })
    {
      inC.Compare(dragged, MakeDrag(volume, by));
      EXPECT_GT(inC.Report.number_of_moved_voxels, 100);
    }
  }
}

// The displacements as the deformation of a dv_deformer, step by step: incremental and whole, on
// the grid of the volume and on another one.
TEST(CChainMail, Deformer)
{
  const auto volume = MakeTwoArrays();
  auto coarse = MakeImage({ { 0, 13, 0, 15, 0, 14 } }, glm::dvec3(2.0), glm::dvec3(0.0));
  double bounds[6];
  volume->GetBounds(bounds);
  coarse->SetOrigin(bounds[0] - 1.0, bounds[2] - 1.0, bounds[4] - 1.0);
  for (vtkImageData* grid : { volume.Get(), coarse.Get() })
  {
    for (const int mode :
      { vtkDeformVolumeFilter::DEFORMED_BOUNDS, vtkDeformVolumeFilter::VOLUME_BOUNDS })
    {
      Dragged dragged(grid);
      dragged.Filter->SetRelaxationSweeps(2);
      MailInC mail(grid);
      Deformed deformed;
      deformed.Filter->SetInputData(volume);
      deformed.Filter->SetDeformationConnection(dragged.Filter->GetOutputPort());
      deformed.Filter->SetOutputBoundsMode(mode);
      deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::EXTRAPOLATE);
      InC inC;
      inC.SetVolume(volume, 0.0);
      inC.IsIncremental = mode == vtkDeformVolumeFilter::VOLUME_BOUNDS;
      dv_output output = {};
      output.struct_size = sizeof(output);
      output.bounds_mode =
        mode == vtkDeformVolumeFilter::VOLUME_BOUNDS ? DV_BOUNDS_VOLUME : DV_BOUNDS_DEFORMED;
      Check(dv_set_output(inC.Deformer, &output));
      Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_EXTRAPOLATE, 0.0));
      Check(dv_set_chainmail(inC.Deformer, mail.ChainMail));
      for (const double by : { 1.0, 3.0, 2.0 })
      {
        mail.Compare(dragged, MakeDrag(grid, by));
        inC.Compare(deformed);
      }
      // A corner is pulled out of the volume, which makes the output larger, and then smaller.
      glm::dvec3 corner;
      grid->GetPoint(0, &corner.x);
      for (const double by : { 0.4, 0.8, 0.1 })
      {
        mail.Compare(dragged, { { corner, corner + by * (corner - GetCenter(grid)) } });
        inC.Compare(deformed);
      }
      // Another spacing of the output.
      std::fill_n(output.spacing, 3, 1.3);
      deformed.Filter->SetCustomSpacing(1.3, 1.3, 1.3);
      deformed.Filter->SetOutputSpacingModeToCustomSpacing();
      Check(dv_set_output(inC.Deformer, &output));
      inC.Compare(deformed);
      mail.Compare(dragged, { { corner, corner + 0.6 * (corner - GetCenter(grid)) } });
      inC.Compare(deformed);
      // Another call without changes.
      inC.Deform();
      EXPECT_TRUE(
        !inC.IsIncremental || inC.Report.changed_extent[0] > inC.Report.changed_extent[1]);
      // Rest positions, Jacobians and KEEP, which need the displacements on the host.
      deformed.Filter->GenerateJacobianOn();
      deformed.Filter->GenerateRestPositionsOn();
      inC.WithExtra = true;
      inC.IsIncremental = false;
      inC.Compare(deformed);
      Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_KEEP, 60.0));
      deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::KEEP);
      deformed.Filter->SetFadeDistance(60.0);
      inC.Compare(deformed);
      // Change to another deformation, and back.
      auto mesh = MakeMesh(volume, 4);
      SetDisplacements(mesh, Bend);
      inC.SetMesh(mesh);
      inC.Deform();
      Check(dv_set_chainmail(inC.Deformer, mail.ChainMail));
      inC.Compare(deformed);
      // The deformation is kept when the dv_chainmail is destroyed.
      dv_chainmail_destroy(mail.ChainMail);
      mail.ChainMail = nullptr;
      inC.Compare(deformed);
    }
  }
}

} // namespace
