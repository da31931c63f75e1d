// SPDX-License-Identifier: BSD-3-Clause
// Edits of the volume of a dv_deformer.
#include "Call.h"
#include "Conversions.h"
#include "Deformer.h"
#include "WorldTool.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

using namespace deformvolume;

namespace
{

static_assert(static_cast<int>(CarvingRule::Centroid) == DV_CARVE_CENTROID &&
    static_cast<int>(CarvingRule::Minimal) == DV_CARVE_MINIMAL,
  "rules are numbered alike");

WorldSheet ReadSurface(const dv_surface* given, const char* name)
{
  const dv_surface surface = ReadStruct(given, name);
  WorldSheet sheet;
  sheet.Points = ReadPoints(surface.points, surface.point_type, surface.number_of_points,
    (std::string("points of ") + name).c_str());
  const std::size_t triangles = GetProduct(surface.number_of_triangles, sizeof(Sheet::Triangle),
    (std::string("triangles of ") + name).c_str());
  if (triangles == 0)
  {
    throw Error("There are no triangles in " + std::string(name) + ". Give one or more.");
  }
  CheckPointer(surface.triangles, ("The list of triangles of " + std::string(name)).c_str());
  sheet.Triangles.resize(triangles);
  for (std::size_t i = 0; i < triangles; ++i)
  {
    std::copy_n(surface.triangles + 3 * i, 3, sheet.Triangles[i].begin());
  }
  return sheet;
}

void SetOptions(const dv_edit* given, EditFinder& finder)
{
  if (!given)
  {
    return;
  }
  const dv_edit edit = ReadStruct(given, "the edit");
  if (edit.rule < DV_CARVE_CENTROID || edit.rule > DV_CARVE_MINIMAL)
  {
    throw Error("The rule is " + std::to_string(edit.rule) +
      ". Set DV_CARVE_CENTROID, DV_CARVE_CONSERVATIVE or DV_CARVE_MINIMAL.");
  }
  finder.IsSmooth = edit.smooth != 0;
  finder.Rule = static_cast<CarvingRule>(edit.rule);
  finder.Progress = MakeProgress(edit.progress, edit.user);
}

// Makes an edit. find: finds the edit. If it throws, the edits do not change.
template <typename Find>
std::int32_t Edit(dv_deformer* deformer, const dv_edit* options, const Find& find)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      CheckHasVolume(*deformer, "it is edited");
      std::unique_ptr<WorldEdits> first;
      if (!deformer->Edits)
      {
        first = std::make_unique<WorldEdits>(deformer->Volume);
        first->SetBase(deformer->Masks);
      }
      WorldEdits& edits = first ? *first : *deformer->Edits;
      EditFinder finder = edits.MakeFinder();
      SetOptions(options, finder);
      edits.Add(find(finder));
      if (first)
      {
        deformer->Edits = std::move(first);
      }
      world.SetMasks(GetMasks(*deformer));
    });
}

// Undoes or redoes an edit. what: "undone" or "redone".
std::int32_t Step(dv_deformer* deformer, bool (WorldEdits::*step)(), const char* what)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      if (!deformer->Edits || !(*deformer->Edits.*step)())
      {
        throw Error(std::string("There is no edit to be ") + what + ".");
      }
      world.SetMasks(GetMasks(*deformer));
    });
}

LabelReader MakeLabelReader(const VolumeArray& labels)
{
  return [&labels](std::int64_t voxel, std::int64_t count, double* read)
  {
    DispatchElementType(labels.Type,
      [&](auto zero)
      {
        const auto* first = static_cast<const decltype(zero)*>(labels.Data) + voxel;
        std::transform(
          first, first + count, read, [](auto label) { return static_cast<double>(label); });
      });
  };
}

// Wraps a function of the program. With a mutex, it is called by one thread at a time.
template <typename Values>
std::function<void(const glm::dvec3*, std::size_t, Values*)> MakeFunction(
  dv_point_function function, void* user, const std::shared_ptr<std::mutex>& mutex)
{
  return [=](const glm::dvec3* points, std::size_t count, Values* values)
  {
    const auto lock = mutex ? std::unique_lock<std::mutex>(*mutex) : std::unique_lock<std::mutex>();
    function(static_cast<std::int64_t>(count), &points->x, reinterpret_cast<double*>(values), user);
  };
}

CarvingTool MakeTool(const dv_body* given)
{
  const dv_body body = ReadStruct(given, "the body");
  if (!body.values)
  {
    throw Error("The body has no function of values. Give one that is negative inside.");
  }
  CarvingTool tool;
  tool.Bounds = GetUnlimitedBounds();
  if (std::any_of(body.bounds, body.bounds + 6, [](double bound) { return bound != 0.0; }))
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double least = body.bounds[2 * axis];
      const double most = body.bounds[2 * axis + 1];
      if (!std::isfinite(least) || !std::isfinite(most) || least > most)
      {
        throw Error("The bounds of the body on axis " + std::string(1, "xyz"[axis]) + " are " +
          FormatNumber(least) + " to " + FormatNumber(most) +
          ". Give finite ones in ascending order, or 0 for all six where it has none.");
      }
      tool.Bounds.Min[axis] = least;
      tool.Bounds.Max[axis] = most;
    }
  }
  const auto mutex = body.is_thread_safe ? nullptr : std::make_shared<std::mutex>();
  tool.Function = MakeFunction<double>(body.values, body.user, mutex);
  if (body.gradients)
  {
    tool.Distance = MakeFirstOrderDistance(
      tool.Function, MakeFunction<glm::dvec3>(body.gradients, body.user, mutex));
  }
  return tool;
}

} // namespace

std::int32_t dv_cut(dv_deformer* deformer, const dv_surface* sheet, const dv_edit* edit)
{
  return Edit(deformer, edit,
    [&](const EditFinder& finder) { return finder.Cut(ReadSurface(sheet, "the sheet")); });
}

std::int32_t dv_carve_surface(dv_deformer* deformer, const dv_surface* surface, const dv_edit* edit)
{
  return Edit(deformer, edit,
    [&](const EditFinder& finder)
    { return finder.CarveSurface(ReadSurface(surface, "the surface")); });
}

std::int32_t dv_carve_sphere(dv_deformer* deformer, std::int64_t count, const double* centers,
  double radius, const dv_edit* edit)
{
  return Edit(deformer, edit,
    [&](const EditFinder& finder)
    {
      return finder.CarveSweptSphere(
        ReadPoints(centers, DV_FLOAT64, count, "centers of the sphere"), radius);
    });
}

std::int32_t dv_carve_label(
  dv_deformer* deformer, const dv_array* labels, double label, const dv_edit* edit)
{
  return Edit(deformer, edit,
    [&](const EditFinder& finder)
    {
      const VolumeArray array = MakeScalars(labels, "labels");
      const LabelReader reader = MakeLabelReader(array);
      if (!HasLabel(finder.Volume.PointExtent, reader, label))
      {
        throw Error("No voxel has the label " + FormatNumber(label) +
          ". Give one that occurs in the array of labels.");
      }
      return finder.CarveLabel(reader, label);
    });
}

std::int32_t dv_carve_function(dv_deformer* deformer, const dv_body* body, const dv_edit* edit)
{
  return Edit(
    deformer, edit, [&](const EditFinder& finder) { return finder.Carve(MakeTool(body)); });
}

std::int32_t dv_undo_edit(dv_deformer* deformer)
{
  return Step(deformer, &WorldEdits::Undo, "undone");
}

std::int32_t dv_redo_edit(dv_deformer* deformer)
{
  return Step(deformer, &WorldEdits::Redo, "redone");
}

std::int32_t dv_reset_edits(dv_deformer* deformer)
{
  return Call(
    [&]
    {
      GetDeformer(deformer).SetMasks(deformer->Masks);
      deformer->Edits.reset();
    });
}

std::int32_t dv_get_masks(dv_deformer* deformer, dv_masks* given)
{
  return Call(
    [&]
    {
      CheckPointer(deformer, "The deformer");
      const WorldMasks masks = GetMasks(*deformer);
      dv_masks made = {};
      made.active = masks.ActiveTetrahedra;
      made.boundary_distances = masks.BoundaryDistances;
      made.crossed = masks.CutTetrahedra;
      made.cut_distances = masks.CutDistances;
      if (deformer->Edits)
      {
        const WorldEdits& edits = *deformer->Edits;
        made.number_of_switched_off_tetrahedra = edits.GetNumberOfSwitchedOffTetrahedra();
        made.number_of_divided_tetrahedra = edits.GetNumberOfDividedTetrahedra();
        made.number_of_edits = static_cast<std::int32_t>(edits.GetNumberOfEdits());
        made.number_of_undone_edits = static_cast<std::int32_t>(edits.GetNumberOfUndoneEdits());
      }
      WriteStruct(made, given, "the masks");
    });
}
