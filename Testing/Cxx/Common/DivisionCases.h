// SPDX-License-Identifier: BSD-3-Clause
// For the tests of streaming and of several ranks: volumes and deformations whose result must not
// depend on how the output is divided into pieces.
#ifndef DivisionCases_h
#define DivisionCases_h

#include "FilterTesting.h"

#include "../../Sources.h"

#include <vtkCellData.h>
#include <vtkDataObject.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace divisionCases
{

using namespace filterTesting;

struct Case
{
  std::string Name;
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkDataSet> Deformation;
  std::function<void(vtkDeformVolumeFilter*)> Set = [](vtkDeformVolumeFilter*) {};
};

/// A volume that has more than one brick, with an array of shorts and one of floats. The kernels
/// for other arrays take seconds to compile.
inline vtkSmartPointer<vtkImageData> MakeVolume(
  const Extent& extent, const glm::dvec3& spacing = glm::dvec3(1.0))
{
  auto volume = MakeImage(extent, spacing, glm::dvec3(3.0, -2.0, 1.0));
  AddScalars<short>(
    volume, "short", [](const glm::dvec3& p) { return 20.0 * (p.x + 0.1 * p.y * p.z); });
  AddScalars<float>(volume, "float",
    [](const glm::dvec3& p)
    { return 100.0 * std::sin(0.7 * p.x) + 90.0 * std::cos(0.9 * p.y) + 35.0 * p.z; });
  return volume;
}

/// Adds arrays of other types, among them labels.
inline void AddOtherTypes(vtkImageData* volume)
{
  AddScalars<double>(volume, "double", [](const glm::dvec3& p) { return p.x + 0.1 * p.y * p.z; });
  AddScalars<unsigned char>(
    volume, "byte", [](const glm::dvec3& p) { return 120.0 + 100.0 * std::sin(p.x + 0.3 * p.y); });
  AddScalars<long long>(volume, "label",
    [](const glm::dvec3& p) { return std::floor(0.3 * p.x) + 1000.0 * std::floor(0.2 * p.z); });
  volume->GetPointData()->SetActiveScalars("float");
}

/// Random bits that depend only on the id of a point or cell.
inline std::uint32_t Scatter(vtkIdType id)
{
  std::uint32_t bits = static_cast<std::uint32_t>(id) * 2654435761U;
  bits ^= bits >> 15;
  return bits * 2246822519U >> 8;
}

inline glm::dvec3 GetCenter(vtkImageData* volume)
{
  glm::dvec3 center;
  volume->GetCenter(&center.x);
  return center;
}

/// Rotates the volume about its center, bends it, and makes it larger.
inline WorldMap Bend(vtkImageData* volume, double amount = 1.0)
{
  const glm::dvec3 center = GetCenter(volume);
  return [=](const glm::dvec3& point)
  {
    const glm::dvec3 p = point - center;
    const double angle = amount * 0.3 * std::sin(0.05 * p.z + 0.4);
    return center +
      glm::dvec3(
        p.x * std::cos(angle) - p.y * std::sin(angle) + amount * 2.0 * std::sin(0.11 * p.y),
        p.x * std::sin(angle) + p.y * std::cos(angle) + amount * 1.5 * std::cos(0.09 * p.z),
        p.z * (1.0 + 0.05 * amount) + amount * 1.7 * std::sin(0.13 * p.x));
  };
}

/// Folds the upper part of the volume back along z. With a factor of 1, the folded voxels are at
/// the positions of other voxels.
inline WorldMap Fold(vtkImageData* volume, double factor)
{
  const glm::dvec3 center = GetCenter(volume);
  return [=](const glm::dvec3& point)
  {
    glm::dvec3 p = point - center;
    p.z = p.z > 7.5 ? 7.5 - factor * (p.z - 7.5) : p.z;
    p.x += 0.25 * p.z;
    return center + p;
  };
}

/// Winds the volume about an axis until it overlaps itself. No tetrahedron is inverted.
inline WorldMap Wind(vtkImageData* volume)
{
  const glm::dvec3 center = GetCenter(volume);
  return [=](const glm::dvec3& point)
  {
    const glm::dvec3 p = point - center;
    const double angle = 0.12 * p.x;
    const double radius = 22.0 + 1.1 * p.y;
    return center + glm::dvec3(radius * std::sin(angle), radius * std::cos(angle), p.z);
  };
}

/// A reference image with another direction and spacing than the volume. It has the center of the
/// volume, but does not contain all of it. isMirrored: its axes are left-handed.
inline vtkSmartPointer<vtkImageData> MakeReference(vtkImageData* volume, bool isMirrored)
{
  const auto reference =
    MakeImage({ { 4, 61, -11, 29, -8, 33 } }, glm::dvec3(1.3, 0.9, isMirrored ? 1.05 : 1.1));
  const double z = isMirrored ? -1.0 : 1.0;
  const double direction[9] = { 0.96, 0.168, 0.224 * z, -0.28, 0.576, 0.768 * z, 0.0, -0.8,
    0.6 * z };
  reference->SetDirectionMatrix(direction);
  const glm::dvec3 origin = GetCenter(volume) - GetCenter(reference) + glm::dvec3(0.3, -0.2, 0.1);
  reference->SetOrigin(origin.x, origin.y, origin.z);
  return reference;
}

inline std::vector<Case> MakeCases()
{
  const Extent extent{ { -9, 62, 3, 29, -15, 18 } };
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, vtkSmartPointer<vtkImageData> volume,
                     vtkSmartPointer<vtkDataSet> deformation) -> Case&
  {
    Case made;
    made.Name = name;
    made.Volume = volume;
    made.Deformation = deformation;
    cases.push_back(made);
    return cases.back();
  };
  const auto volume = MakeVolume(extent);
  const auto deform = [&](vtkSmartPointer<vtkDataSet> dataSet, const WorldMap& map)
  {
    SetDisplacements(dataSet, map);
    return dataSet;
  };

  add("Identity", volume, deform(MakeMesh(volume, 4), Shift(0.0, 0.0, 0.0)));
  add("Half a voxel", volume, deform(MakeMesh(volume, 4), Shift(0.5, 1.5, -2.0)));
  add("Runs", volume, deform(MakeMesh(volume, 4), Bend(volume))).Set =
    [](vtkDeformVolumeFilter* filter)
  {
    filter->SetPadding(2);
    filter->SetBackgroundValue(7.0);
  };
  const auto types = MakeVolume(extent);
  AddOtherTypes(types);
  add("Other types", types, deform(MakeMesh(types, 4), Bend(types))).Set =
    [](vtkDeformVolumeFilter* filter)
  {
    filter->AddCategoricalArray("label");
    filter->SetBackgroundValue(7.0);
  };
  add("Links", volume, deform(MakeMesh(volume, 24), Bend(volume)));
  add("Smaller mesh", volume, deform(MakeMesh(volume, 5, -6.3), Bend(volume, 1.5)));
  add("Torn mesh", volume, nullptr).Deformation = [&]
  {
    // Two lattices that are pulled apart. The gap between them is inside one layer of cells.
    double bounds[6];
    volume->GetBounds(bounds);
    const double middle = 0.5 * (bounds[4] + bounds[5]) + 0.4;
    auto whole = vtkSmartPointer<vtkUnstructuredGrid>::New();
    whole->Allocate();
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> vectors;
    vectors->SetName("displacement");
    vectors->SetNumberOfComponents(3);
    for (int half = 0; half < 2; ++half)
    {
      const auto lattice =
        MakeTetrahedra({ { bounds[0] - 1.0, bounds[1] + 1.0, bounds[2] - 1.0, bounds[3] + 1.0,
                         half ? middle + 0.1 : bounds[4] - 1.0, half ? bounds[5] + 1.0 : middle } },
          { { 4, 4, 3 } });
      const vtkIdType first = points->GetNumberOfPoints();
      for (vtkIdType id = 0; id < lattice->GetNumberOfPoints(); ++id)
      {
        points->InsertNextPoint(lattice->GetPoint(id));
        vectors->InsertNextTuple3(half ? 2.3 : -1.1, 0.7, half ? 9.4 : -8.2);
      }
      for (vtkIdType id = 0; id < lattice->GetNumberOfCells(); ++id)
      {
        vtkNew<vtkIdList> ids;
        lattice->GetCellPoints(id, ids);
        for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k)
        {
          ids->SetId(k, first + ids->GetId(k));
        }
        whole->InsertNextCell(lattice->GetCellType(id), ids);
      }
    }
    whole->SetPoints(points);
    whole->GetPointData()->SetVectors(vectors);
    return whole;
  }();
  const auto setCubic = [](vtkDeformVolumeFilter* filter)
  { filter->SetInterpolationToCubicInterpolation(); };
  const auto masked = MakeVolume(extent);
  {
    const auto active = vtkSmartPointer<vtkUnsignedCharArray>::New();
    active->SetName("ActiveTetrahedra");
    for (vtkIdType id = 0; id < masked->GetNumberOfCells(); ++id)
    {
      const std::uint32_t bits = Scatter(id);
      active->InsertNextValue(bits % 4 == 0 ? bits >> 3 & 31 : 31);
    }
    masked->GetCellData()->AddArray(active);
    const auto ghosts = vtkSmartPointer<vtkUnsignedCharArray>::New();
    ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    for (vtkIdType id = 0; id < masked->GetNumberOfPoints(); ++id)
    {
      ghosts->InsertNextValue(Scatter(id + 99) % 200 == 0 ? vtkDataSetAttributes::HIDDENPOINT : 0);
    }
    masked->GetPointData()->AddArray(ghosts);
  }
  {
    add("Masks", masked, deform(MakeMesh(masked, 4), Bend(masked)));
    add("Masks, half a voxel", masked, deform(MakeMesh(masked, 4), Shift(0.5, 1.0, -2.5)));
  }
  {
    // A smooth cut in a plane that is oblique to the axes. The two sides are moved apart.
    const auto divided = MakeVolume(extent);
    double center[3];
    divided->GetCenter(center);
    const auto distance = [=](const glm::dvec3& p)
    { return 0.4 * (p.x - center[0]) - 0.3 * (p.y - center[1]) + (p.z - center[2]) + 0.15; };
    const auto distances = vtkSmartPointer<vtkFloatArray>::New();
    distances->SetName("CutDistance");
    for (vtkIdType id = 0; id < divided->GetNumberOfPoints(); ++id)
    {
      distances->InsertNextValue(static_cast<float>(distance(GetPoint(divided, id))));
    }
    divided->GetPointData()->AddArray(distances);
    const auto crossed = vtkSmartPointer<vtkUnsignedCharArray>::New();
    crossed->SetName("CutTetrahedra");
    for (vtkIdType id = 0; id < divided->GetNumberOfCells(); ++id)
    {
      // All cells near the sheet are crossed, except a few whose vertices stay connected.
      double bounds[6];
      divided->GetCellBounds(id, bounds);
      const bool isNear = std::abs(distance({ bounds[0], bounds[2], bounds[4] })) < 4.0;
      crossed->InsertNextValue(isNear && Scatter(id) % 50 != 0 ? 31 : 0);
    }
    divided->GetCellData()->AddArray(crossed);
    const auto open = [=](const glm::dvec3& p)
    { return p + (distance(p) < 0.0 ? glm::dvec3(-0.5, 0.3, -3.7) : glm::dvec3(0.8, 0.0, 4.1)); };
    const auto field = MakeImage(extent, glm::dvec3(1.0), glm::dvec3(3.0, -2.0, 1.0));
    add("Smooth cut", divided, deform(field, open));
    add("Smooth cut, sides over each other", divided,
      deform(MakeImage(extent, glm::dvec3(1.0), glm::dvec3(3.0, -2.0, 1.0)),
        [=](const glm::dvec3& p) { return 2.0 * p - open(p); }));
    add("Smooth cut, mesh", divided, deform(MakeMesh(divided, 30), open));
    add("Smooth cut, cubic", divided, cases.back().Deformation).Set = setCubic;
  }
  add("Coarser output", volume, deform(MakeMesh(volume, 6), Bend(volume))).Set =
    [](vtkDeformVolumeFilter* filter)
  {
    filter->SetOutputSpacingModeToCustomSpacing();
    filter->SetCustomSpacing(1.3, 0.7, 1.1);
  };
  add("Volume's bounds", volume, deform(MakeMesh(volume, 6), Bend(volume))).Set =
    [](vtkDeformVolumeFilter* filter) { filter->SetOutputBoundsModeToVolumeBounds(); };
  {
    // The points of the field are not at voxels, and the field is smaller than the volume.
    const auto field =
      MakeImage({ { 0, 9, 0, 6, 0, 5 } }, glm::dvec3(7.3, 5.9, 6.7), glm::dvec3(-4.1, 2.2, -15.3));
    add("Field", volume, deform(field, Bend(volume)));
    add("Extrapolated field", volume, field).Set = [](vtkDeformVolumeFilter* filter)
    { filter->SetOutsideModeToExtrapolate(); };
    const auto same = MakeImage(extent, glm::dvec3(1.0), glm::dvec3(3.0, -2.0, 1.0));
    add("Field of voxels", volume, deform(same, Bend(volume)));
    const auto setInverse = [](vtkDeformVolumeFilter* filter) { filter->SetFieldIsInverse(true); };
    add("Inverse field", volume, field).Set = setInverse;
    add("Inverse field, masks", masked, field).Set = setInverse;
  }
  add("Extrapolated mesh", volume, deform(MakeMesh(volume, 5, -6.3), Bend(volume))).Set =
    [](vtkDeformVolumeFilter* filter) { filter->SetOutsideModeToExtrapolate(); };
  add("Mesh rasterization", volume, deform(MakeMesh(volume, 5), Bend(volume))).Set =
    [](vtkDeformVolumeFilter* filter)
  { filter->SetResampler(vtkDeformVolumeFilter::MESH_RASTERIZATION); };
  // The fold is along nodes of the mesh.
  add("Folded", volume, deform(MakeMesh(volume, 12), Fold(volume, 0.75)));
  add("Folded on voxels", volume, deform(MakeMesh(volume, 35), Fold(volume, 1.0)));
  add("Folded, masks", masked, deform(MakeMesh(masked, 35), Fold(masked, 1.0)));
  add("Wound", volume, deform(MakeMesh(volume, 25), Wind(volume)));
  {
    // In most cells all voxels that a cubic interpolation reads have active tetrahedra.
    const auto few = MakeVolume(extent);
    const auto active = vtkSmartPointer<vtkUnsignedCharArray>::New();
    active->SetName("ActiveTetrahedra");
    for (vtkIdType id = 0; id < few->GetNumberOfCells(); ++id)
    {
      active->InsertNextValue(Scatter(id) % 400 == 0 ? 27 : 31);
    }
    few->GetCellData()->AddArray(active);
    add("Cubic", few, deform(MakeMesh(few, 4), Bend(few))).Set = setCubic;
    add("Cubic, smaller mesh", few, deform(MakeMesh(few, 5, -6.3), Bend(few, 1.5))).Set = setCubic;
    add("Cubic, folded", few, deform(MakeMesh(few, 12), Fold(few, 0.75))).Set = setCubic;
    add("Cubic, field", few,
      deform(MakeImage(extent, glm::dvec3(1.0), glm::dvec3(3.0, -2.0, 1.0)), Bend(few)))
      .Set = setCubic;
  }
  {
    // Outputs on the grid of a reference image, whose axes are oblique to those of the volume.
    using Filter = vtkDeformVolumeFilter;
    const auto addOn = [&](
                         const std::string& name, bool isMirrored,
                         const vtkSmartPointer<vtkImageData>& from,
                         const vtkSmartPointer<vtkDataSet>& deformation,
                         const std::function<void(Filter*)>& set = [](Filter*) {})
    {
      const auto reference = MakeReference(from, isMirrored);
      add(name + (isMirrored ? ", mirrored reference" : ", turned reference"), from, deformation)
        .Set = [=](Filter* filter)
      {
        set(filter);
        filter->SetReferenceData(reference);
        filter->SetBackgroundValue(7.0);
      };
    };
    const auto runs = deform(MakeMesh(volume, 4), Bend(volume));
    const auto smaller = deform(MakeMesh(volume, 5, -6.3), Bend(volume));
    const auto field = deform(
      MakeImage({ { 0, 9, 0, 6, 0, 5 } }, glm::dvec3(7.3, 5.9, 6.7), glm::dvec3(-4.1, 2.2, -15.3)),
      Bend(volume));
    for (const bool isMirrored : { false, true })
    {
      addOn("Runs", isMirrored, volume, runs);
      addOn("Links and masks", isMirrored, masked, deform(MakeMesh(masked, 24), Bend(masked)));
      addOn("Cubic", isMirrored, volume, smaller,
        [](Filter* filter) { filter->SetInterpolationToCubicInterpolation(); });
      addOn("Inverse field", isMirrored, volume, field,
        [](Filter* filter) { filter->FieldIsInverseOn(); });
    }
    addOn("At rest", true, volume, nullptr);
    addOn("Field", true, volume, field);
    addOn("Nearest", false, volume, runs,
      [](Filter* filter) { filter->SetInterpolationToNearestInterpolation(); });
    addOn("Extrapolated mesh", false, volume, smaller,
      [](Filter* filter) { filter->SetOutsideModeToExtrapolate(); });
    addOn("Kept tissue", true, volume, smaller,
      [](Filter* filter)
      {
        filter->SetOutsideModeToKeep();
        filter->SetFadeDistance(9.0);
      });
    addOn("Cubic by mesh rasterization", true, volume, runs,
      [](Filter* filter)
      {
        filter->SetResamplerToMeshRasterization();
        filter->SetInterpolationToCubicInterpolation();
      });
    addOn("Folded", true, volume, deform(MakeMesh(volume, 12), Fold(volume, 0.75)));
  }
  return cases;
}

} // namespace divisionCases

#endif
