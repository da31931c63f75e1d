// SPDX-License-Identifier: BSD-3-Clause
// dv_deformer: checks and converts the input from C, and calls a WorldDeformer.
#include "Call.h"
#include "CellNumbers.h"
#include "CellReader.h"
#include "Conversions.h"
#include "Deformer.h"
#include "Fading.h"
#include "Structs.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

// Reads the faces of polyhedra, one after the other.
class FaceStream
{
public:
  explicit FaceStream(const dv_mesh& mesh)
    : Mesh(mesh)
    , Left(mesh.faces ? mesh.number_of_face_values : 0)
    , Next(mesh.faces)
  {
  }

  // Reads the faces of a polyhedron. Returns false if the numbers end before its last face.
  bool Read(std::int64_t cell, CellReader::PolyhedronFaces& faces)
  {
    std::int64_t numberOfFaces = 0;
    if (!this->Take(numberOfFaces))
    {
      return false;
    }
    for (; numberOfFaces > 0; --numberOfFaces)
    {
      std::int64_t size = 0;
      if (!this->Take(size) || size < 0 || size > this->Left)
      {
        return false;
      }
      std::vector<std::int32_t> face;
      for (; size > 0; --size)
      {
        std::int64_t point = 0;
        this->Take(point);
        CheckCellPoint(point, this->Mesh.number_of_points, cell);
        face.push_back(static_cast<std::int32_t>(point));
      }
      faces.push_back(face);
    }
    return true;
  }

private:
  bool Take(std::int64_t& value)
  {
    if (this->Left <= 0)
    {
      return false;
    }
    --this->Left;
    value = *this->Next++;
    return true;
  }

  const dv_mesh& Mesh;
  std::int64_t Left;
  const std::int64_t* Next;
};

// points: the points of the mesh.
MeshCells ReadCells(const dv_mesh& mesh, const VectorView& points)
{
  const std::size_t cells = GetProduct(mesh.number_of_cells, 4 * sizeof(std::int64_t), "cells");
  if (cells == 0)
  {
    throw Error("The deformation mesh has no cells. Give one of three-dimensional cells.");
  }
  CheckPointer(mesh.connectivity, "The connectivity of the mesh");
  if (mesh.types && !mesh.offsets)
  {
    throw Error("The deformation mesh has types of cells, but no offsets. Give both, or none.");
  }
  CellReader reader(
    static_cast<std::int32_t>(points.Count),
    [&points](std::int32_t node) { return points.Get(static_cast<std::size_t>(node)); },
    points.AreDoubles ? static_cast<double>(std::numeric_limits<double>::epsilon())
                      : static_cast<double>(std::numeric_limits<float>::epsilon()));
  reader.Reserve(cells);
  FaceStream faces(mesh);
  std::vector<std::int32_t> nodes;
  for (std::size_t cell = 0; cell < cells; ++cell)
  {
    const auto number = static_cast<std::int64_t>(cell);
    const int type = mesh.types ? mesh.types[cell] : static_cast<int>(cellNumbers::Tetrahedron);
    const std::int64_t begin = mesh.offsets ? mesh.offsets[cell] : 4 * number;
    const std::int64_t end = mesh.offsets ? mesh.offsets[cell + 1] : begin + 4;
    if (begin < 0 || end < begin || (cell == 0 && begin != 0))
    {
      throw Error("Cell " + std::to_string(cell) + " of the deformation mesh begins at " +
        std::to_string(begin) + " and ends at " + std::to_string(end) +
        ". Give offsets that begin with 0 and do not decrease.");
    }
    CellReader::CheckSize(number, type, end - begin);
    nodes.clear();
    for (std::int64_t i = begin; i < end; ++i)
    {
      const std::int64_t point = mesh.connectivity[i];
      CheckCellPoint(point, mesh.number_of_points, number);
      nodes.push_back(static_cast<std::int32_t>(point));
    }
    if (type == cellNumbers::Polyhedron)
    {
      CellReader::PolyhedronFaces read;
      const bool areComplete = faces.Read(number, read);
      reader.AddPolyhedron(number, end - begin, read, areComplete);
      continue;
    }
    std::array<int, 3> degrees{ { 0, 0, 0 } };
    for (std::size_t axis = 0; axis < 3 && mesh.degrees; ++axis)
    {
      const std::int32_t degree = mesh.degrees[3 * cell + axis];
      degrees[axis] = degree >= 1 && degree < 1000000 ? degree : 0;
    }
    reader.Add(number, type, nodes, mesh.degrees ? &degrees : nullptr);
  }
  MeshCells made = reader.Finish();
  if (made.Tetrahedra.empty())
  {
    throw Error("The deformation mesh has no tetrahedra, but " +
      (made.Ignored.empty() ? std::to_string(mesh.number_of_cells) + " cells without volume"
                            : made.Ignored) +
      ". Use a mesh of three-dimensional cells that can be split into tetrahedra.");
  }
  return made;
}

WorldRequest MakeRequest(const dv_request& given)
{
  WorldRequest request;
  for (std::size_t i = 0; i < 6 && given.use_extent; ++i)
  {
    request.OutputExtent[i] = given.extent[i];
  }
  for (int axis = 0; axis < 3 && given.use_extent; ++axis)
  {
    if (given.extent[2 * axis] > given.extent[2 * axis + 1])
    {
      throw Error("The extent of the request, " + DescribeExtent(request.OutputExtent) +
        ", is empty. Set use_extent to 0 for the whole output.");
    }
  }
  if (given.interpolation < DV_LINEAR || given.interpolation > DV_NEAREST)
  {
    throw Error("The interpolation is " + std::to_string(given.interpolation) +
      ". Set DV_LINEAR, DV_CUBIC or DV_NEAREST.");
  }
  request.Interpolation =
    given.interpolation == DV_CUBIC ? Interpolation::Cubic : Interpolation::Linear;
  request.IsNearest = given.interpolation == DV_NEAREST;
  request.Incremental = given.incremental != 0;
  GetProduct(given.number_of_outputs, sizeof(void*), "outputs");
  if (given.number_of_outputs > 0)
  {
    CheckPointer(given.outputs, "The list of outputs");
  }
  for (std::int32_t i = 0; i < given.number_of_outputs; ++i)
  {
    CheckPointer(given.outputs[i], ("Output " + std::to_string(i)).c_str());
    if (std::count(given.outputs, given.outputs + i, given.outputs[i]) > 0)
    {
      throw Error("Output " + std::to_string(i) +
        " has the memory of another output. Give each output its own memory.");
    }
    request.Outputs.push_back(given.outputs[i]);
  }
  CheckPointer(given.coverage, "The memory for the coverage");
  request.Coverage = reinterpret_cast<signed char*>(given.coverage);
  request.RestPositions = given.rest_positions;
  request.Jacobians = given.jacobian;
  request.FoldCounts = given.fold_count;
  request.Background = given.extra_background;
  request.Progress = MakeProgress(given.progress, given.user);
  return request;
}

template <typename Change>
std::int32_t SetMasks(dv_deformer* deformer, const Change& change)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      CheckHasVolume(*deformer, "its masks");
      WorldMasks masks = deformer->Masks;
      change(masks);
      if (deformer->Edits)
      {
        deformer->Edits->SetBase(masks);
      }
      deformer->Masks = masks;
      world.SetMasks(GetMasks(*deformer));
    });
}

} // namespace

std::int32_t dv_create(dv_deformer** deformer)
{
  return Call(
    [&]
    {
      CheckPointer(deformer, "The place for the deformer");
      *deformer = nullptr;
      *deformer = std::make_unique<dv_deformer>().release();
    });
}

void dv_destroy(dv_deformer* deformer)
{
  Call([&] { delete deformer; });
}

std::int32_t dv_set_device(dv_deformer* deformer, const char* name)
{
  return Call([&] { GetDeformer(deformer).SetDevice(name ? name : ""); });
}

std::int32_t dv_set_memory_limit(dv_deformer* deformer, std::uint64_t bytes)
{
  return Call([&] { GetDeformer(deformer).SetMemoryLimit(bytes); });
}

std::int32_t dv_set_volume(dv_deformer* deformer, const dv_grid* grid)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      const ImageGeometry volume = MakeGeometry(grid, "the volume");
      world.SetVolume(volume);
      if (volume != deformer->Volume)
      {
        deformer->Volume = volume;
        deformer->Masks = WorldMasks();
        deformer->Edits.reset();
      }
    });
}

std::int32_t dv_set_arrays(dv_deformer* deformer, std::int32_t count, const dv_array* arrays)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      GetProduct(count, sizeof(dv_array), "arrays");
      std::vector<WorldArray> made;
      if (count > 0)
      {
        const std::size_t step = CheckStruct(arrays, "the array");
        const auto* bytes = reinterpret_cast<const unsigned char*>(arrays);
        for (std::int32_t i = 0; i < count; ++i)
        {
          dv_array array{};
          std::memcpy(
            &array, bytes + static_cast<std::size_t>(i) * step, std::min(step, sizeof(dv_array)));
          made.push_back({ MakeArray(array, "Array " + std::to_string(i)), array.density != 0 });
        }
      }
      CheckHasVolume(*deformer, "its arrays");
      world.SetArrays(made);
    });
}

std::int32_t dv_set_blanked(dv_deformer* deformer, const std::uint8_t* blanked)
{
  return SetMasks(deformer, [&](WorldMasks& masks) { masks.Blanked = blanked; });
}

std::int32_t dv_set_active_tetrahedra(dv_deformer* deformer, const std::uint8_t* active)
{
  return SetMasks(deformer, [&](WorldMasks& masks) { masks.ActiveTetrahedra = active; });
}

std::int32_t dv_set_boundary_distances(dv_deformer* deformer, const float* distances)
{
  return SetMasks(deformer, [&](WorldMasks& masks) { masks.BoundaryDistances = distances; });
}

std::int32_t dv_set_smooth_cut(
  dv_deformer* deformer, const std::uint8_t* crossed, const float* distances)
{
  return SetMasks(deformer,
    [&](WorldMasks& masks)
    {
      if ((crossed == nullptr) != (distances == nullptr))
      {
        throw Error("A smooth cut has crossed tetrahedra and distances. Give both, or none.");
      }
      masks.CutTetrahedra = crossed;
      masks.CutDistances = distances;
    });
}

std::int32_t dv_set_mesh(dv_deformer* deformer, const dv_mesh* given)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      const dv_mesh mesh = ReadStruct(given, "the mesh");
      if (mesh.number_of_points < 1 ||
        mesh.number_of_points > std::numeric_limits<std::int32_t>::max())
      {
        throw Error("The deformation mesh has " + std::to_string(mesh.number_of_points) +
          " points. Give 1 to 2,147,483,647.");
      }
      const VectorView points =
        MakeView(mesh.points, mesh.point_type, mesh.number_of_points, "points of the mesh");
      world.SetMesh(points, ReadCells(mesh, points));
    });
}

std::int32_t dv_set_displacements(
  dv_deformer* deformer, std::int32_t type, std::int64_t count, const void* displacements)
{
  return Call(
    [&] {
      GetDeformer(deformer).SetNodeVectors(MakeView(displacements, type, count, "displacements"));
    });
}

std::int32_t dv_set_field(dv_deformer* deformer, const dv_field* given)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      const dv_field field = ReadStruct(given, "the field");
      const ImageGeometry grid = MakeGeometry(field.grid, "the grid of the field");
      world.SetField(grid,
        MakeView(
          field.vectors, field.type, GetNumberOfPoints(grid.PointExtent), "vectors of the field"),
        field.inverse != 0, field.undefined);
    });
}

std::int32_t dv_set_outside(dv_deformer* deformer, std::int32_t mode, double fade_distance)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      if (mode < DV_OUTSIDE_DISCARD || mode > DV_OUTSIDE_KEEP)
      {
        throw Error("The outside mode is " + std::to_string(mode) +
          ". Set DV_OUTSIDE_DISCARD, DV_OUTSIDE_EXTRAPOLATE or DV_OUTSIDE_KEEP.");
      }
      world.SetOutside(mode == DV_OUTSIDE_KEEP ? MakeKeptVoxels(fade_distance)
                                               : OutsideVoxels(mode == DV_OUTSIDE_EXTRAPOLATE));
    });
}

std::int32_t dv_set_reference(dv_deformer* deformer, const dv_grid* grid)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      std::optional<ImageGeometry> reference;
      if (grid)
      {
        reference = MakeGeometry(grid, "the reference grid");
      }
      world.SetReference(reference);
    });
}

std::int32_t dv_set_output(dv_deformer* deformer, const dv_output* given)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      OutputSettings settings;
      if (given)
      {
        const dv_output output = ReadStruct(given, "the output");
        if (output.bounds_mode < DV_BOUNDS_DEFORMED || output.bounds_mode > DV_BOUNDS_CUSTOM)
        {
          throw Error("The bounds mode is " + std::to_string(output.bounds_mode) +
            ". Set DV_BOUNDS_DEFORMED, DV_BOUNDS_VOLUME or DV_BOUNDS_CUSTOM.");
        }
        settings.Bounds = static_cast<OutputSettings::BoundsModes>(output.bounds_mode);
        settings.Padding = output.padding;
        std::copy_n(output.custom_bounds, 6, settings.CustomBounds.begin());
        const glm::dvec3 spacing(output.spacing[0], output.spacing[1], output.spacing[2]);
        if (spacing != glm::dvec3(0.0))
        {
          settings.Spacing = spacing;
        }
      }
      world.SetOutput(settings);
    });
}

std::int32_t dv_output_grid(dv_deformer* deformer, dv_grid* grid)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      CheckStruct(grid, "the grid");
      const ImageGeometry output = world.FindOutput();
      if (GetNumberOfPoints(output.PointExtent) == 0)
      {
        throw Error("The extent of the output is empty. Use a greater padding or larger bounds.");
      }
      dv_grid made = {};
      for (int axis = 0; axis < 3; ++axis)
      {
        made.extent[2 * axis] = output.PointExtent[2 * axis];
        made.extent[2 * axis + 1] = output.PointExtent[2 * axis + 1];
        made.origin[axis] = output.Origin[axis];
        made.spacing[axis] = output.Spacing[axis];
        for (int column = 0; column < 3; ++column)
        {
          made.direction[3 * axis + column] = output.Direction[column][axis];
        }
      }
      WriteStruct(made, grid, "the grid");
    });
}

std::int32_t dv_deform(dv_deformer* deformer, const dv_request* given, dv_report* report)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      const WorldRequest request = MakeRequest(ReadStruct(given, "the request"));
      if (report)
      {
        CheckStruct(report, "the report");
      }
      deformer->Warnings.clear();
      const WorldReport done = world.Deform(request);
      deformer->Device = done.Device;
      deformer->Warnings = done.Warnings;
      if (request.Progress)
      {
        request.Progress(1.0);
      }
      if (report)
      {
        dv_report made = {};
        made.number_of_covered_voxels = done.NumberOfCoveredVoxels;
        made.number_of_inverted_tetrahedra = done.NumberOfInvertedTetrahedra;
        made.number_of_flat_tetrahedra = done.NumberOfFlatTetrahedra;
        made.number_of_overstretched_cells = done.NumberOfOverstretchedCells;
        made.number_of_hidden_samples = done.NumberOfHiddenSamples;
        std::copy_n(done.ChangedExtent.begin(), 6, made.changed_extent);
        made.device = deformer->Device.c_str();
        made.warnings = deformer->Warnings.c_str();
        WriteStruct(made, report, "the report");
      }
    });
}

std::int32_t dv_deform_points(
  dv_deformer* deformer, const dv_points_request* given, dv_points_report* report)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      const dv_points_request points = ReadStruct(given, "the request");
      if (report)
      {
        CheckStruct(report, "the report");
      }
      PointsRequest request;
      GetProduct(points.number_of_points, 3 * sizeof(double), "points");
      request.Count = static_cast<std::size_t>(points.number_of_points);
      request.Points = points.points;
      request.IsInverse = points.inverse != 0;
      request.AreFloats = points.were_floats != 0;
      request.Moved = points.moved;
      request.Valid = reinterpret_cast<signed char*>(points.valid);
      if (request.Count > 0)
      {
        CheckPointer(request.Points, "The list of points");
        CheckPointer(request.Moved, "The memory for the moved points");
        CheckPointer(request.Valid, "The memory for the validity of points");
      }
      request.Progress = MakeProgress(points.progress, points.user);
      deformer->Warnings.clear();
      const PointsReport done = world.DeformPoints(request);
      deformer->Warnings = done.Warnings;
      if (request.Progress)
      {
        request.Progress(1.0);
      }
      if (report)
      {
        dv_points_report made = {};
        made.number_of_outside_points = done.NumberOfOutsidePoints;
        made.warnings = deformer->Warnings.c_str();
        WriteStruct(made, report, "the report");
      }
    });
}

std::int32_t dv_device_memory(const dv_deformer* deformer, std::uint64_t* bytes)
{
  return Call(
    [&]
    {
      CheckPointer(deformer, "The deformer");
      CheckPointer(bytes, "The place for the number of bytes");
      *bytes = deformer->Deformer.GetDeviceMemory();
    });
}

std::int32_t dv_release_memory(dv_deformer* deformer)
{
  return Call([&] { GetDeformer(deformer).ReleaseMemory(); });
}
