// SPDX-License-Identifier: BSD-3-Clause
#include "Conversions.h"

#include "Structs.h"

#include <limits>
#include <memory>

namespace deformvolume
{

static_assert(static_cast<int>(ElementType::Int8) == DV_INT8 &&
    static_cast<int>(ElementType::Float64) == DV_FLOAT64,
  "types are numbered alike");

std::size_t GetProduct(std::int64_t count, std::size_t factor, const char* what)
{
  if (count < 0 ||
    static_cast<std::uint64_t>(count) > std::numeric_limits<std::size_t>::max() / factor)
  {
    throw Error(std::string("The number of ") + what + " is " + std::to_string(count) +
      ". Give a number from 0 to " +
      std::to_string(std::numeric_limits<std::size_t>::max() / factor) + ".");
  }
  return static_cast<std::size_t>(count);
}

ImageGeometry MakeGeometry(const dv_grid* given, const char* name)
{
  const dv_grid grid = ReadStruct(given, name);
  ImageGeometry geometry;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int first = grid.extent[2 * axis];
    const int last = grid.extent[2 * axis + 1];
    // The same limit as for outputs (OutputExtent.cxx): sizes cannot overflow.
    constexpr int most = 1 << 29;
    if (first < -most || last > most || first > last)
    {
      throw Error("The extent of " + std::string(name) + " on axis " + "xyz"[axis] + " is " +
        std::to_string(first) + " to " + std::to_string(last) +
        ". Give the first and the last index, within 2^29.");
    }
    geometry.PointExtent[2 * axis] = first;
    geometry.PointExtent[2 * axis + 1] = last;
    geometry.Origin[axis] = grid.origin[axis];
    geometry.Spacing[axis] = grid.spacing[axis];
  }
  geometry.Direction = MakeDirection(grid.direction);
  CheckTransform(geometry, name);
  return geometry;
}

VectorView MakeView(const void* data, std::int32_t type, std::int64_t count, const char* what)
{
  if (type != DV_FLOAT32 && type != DV_FLOAT64)
  {
    throw Error(std::string("The type of the ") + what + " is " + std::to_string(type) +
      ". Give floats (DV_FLOAT32) or doubles (DV_FLOAT64).");
  }
  VectorView view;
  view.Count = GetProduct(count, 3 * sizeof(double), what);
  if (count > 0)
  {
    CheckPointer(data, what);
  }
  view.Data = data;
  view.AreDoubles = type == DV_FLOAT64;
  return view;
}

std::vector<glm::dvec3> ReadPoints(
  const void* data, std::int32_t type, std::int64_t count, const char* what)
{
  const VectorView view = MakeView(data, type, count, what);
  std::vector<glm::dvec3> points;
  points.reserve(view.Count);
  for (std::size_t i = 0; i < view.Count; ++i)
  {
    points.push_back(view.Get(i));
  }
  return points;
}

VolumeArray MakeArray(const dv_array& given, const std::string& name)
{
  if (!given.data)
  {
    throw Error(name + " has no data.");
  }
  if (given.type < DV_INT8 || given.type > DV_FLOAT64)
  {
    throw Error(name + " has the type " + std::to_string(given.type) +
      ". Give one from DV_INT8 to DV_FLOAT64.");
  }
  if (given.components < 1)
  {
    throw Error(name + " has " + std::to_string(given.components) + " components. Give 1 or more.");
  }
  VolumeArray array;
  array.Data = given.data;
  // The program owns the data, so there is nothing to delete.
  array.Owner = std::shared_ptr<const void>(given.data, [](const void*) {});
  array.Type = static_cast<ElementType>(given.type);
  array.Components = given.components;
  array.Categorical = given.categorical != 0;
  array.Background = given.background;
  return array;
}

VolumeArray MakeScalars(const dv_array* given, const char* what)
{
  const std::string name = std::string("The array of ") + what;
  VolumeArray array = MakeArray(ReadStruct(given, (std::string("the ") + what).c_str()), name);
  if (array.Components != 1)
  {
    throw Error(name + " has " + std::to_string(array.Components) + " components. Give 1.");
  }
  return array;
}

std::function<bool(double)> MakeProgress(dv_progress progress, void* user)
{
  if (!progress)
  {
    return {};
  }
  return [=](double fraction) { return progress(fraction, user) == 0; };
}

} // namespace deformvolume
