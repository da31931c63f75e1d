// SPDX-License-Identifier: BSD-3-Clause
#include "WorldBoxes.h"

#include "Error.h"
#include "ImageGeometry.h"
#include "MeshAtRest.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include <limits>
#include <sstream>

namespace deformvolume
{

namespace
{

struct Box
{
  glm::dvec3 Least{ std::numeric_limits<double>::infinity() };
  glm::dvec3 Most{ -std::numeric_limits<double>::infinity() };

  void Add(const glm::dvec3& point)
  {
    this->Least = glm::min(this->Least, point);
    this->Most = glm::max(this->Most, point);
  }
};

Box GetIndexBox(const Extent& extent)
{
  Box box;
  box.Add({ extent[0], extent[2], extent[4] });
  box.Add({ extent[1], extent[3], extent[5] });
  return box;
}

// transform: applied to the indices of the points.
Box FindBox(const ImageGeometry& geometry, const glm::dmat4& transform)
{
  const Box indices = GetIndexBox(geometry.PointExtent);
  Box box;
  for (int corner = 0; corner < 8; ++corner)
  {
    glm::dvec3 index = indices.Least;
    for (int axis = 0; axis < 3; ++axis)
    {
      index[axis] = (corner >> axis) % 2 == 0 ? indices.Least[axis] : indices.Most[axis];
    }
    box.Add(glm::dvec3(transform * glm::dvec4(index, 1.0)));
  }
  return box;
}

Box GetWorldBox(const ImageGeometry& geometry)
{
  return FindBox(geometry, geometry.GetIndexToWorld());
}

// Returns the box of the nodes that tetrahedra use. transform: applied to each node, in indices of
// a volume.
template <typename Function>
Box FindBox(const MeshAtRest& mesh, const Function& transform)
{
  Box box;
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      box.Add(transform(mesh.Points[static_cast<std::size_t>(node)]));
    }
  }
  return box;
}

// volume: that whose indices are the coordinates of the mesh.
Box GetWorldBox(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  const glm::dmat4 toWorld = volume.GetIndexToWorld();
  return FindBox(
    mesh, [&](const glm::dvec3& point) { return glm::dvec3(toWorld * glm::dvec4(point, 1.0)); });
}

std::string Describe(const Box& box)
{
  std::ostringstream text;
  for (int axis = 0; axis < 3; ++axis)
  {
    text << (axis == 0 ? "" : ", ") << "xyz"[axis] << " from " << box.Least[axis] << " to "
         << box.Most[axis];
  }
  return text.str();
}

std::string Describe(const char* what, const Box& box, const ImageGeometry& volume)
{
  return std::string("The box of the ") + what + " is " + Describe(box) +
    ", and that of the volume " + Describe(GetWorldBox(volume)) +
    ". Give both in the same world coordinates and the same unit: the usual cause is that "
    "one is in meters and the other in millimeters.";
}

// Whether a box in indices of a volume is smaller than two voxels, and than a fourth of the volume,
// on each axis.
bool IsSmall(const Box& box, const ImageGeometry& volume)
{
  const Box voxels = GetIndexBox(volume.PointExtent);
  const glm::dvec3 most = glm::min(glm::dvec3(2.0), 0.25 * (voxels.Most - voxels.Least));
  return glm::all(glm::lessThan(box.Most - box.Least, most));
}

std::string DescribeSmallness(const char* what, const Box& box, const ImageGeometry& volume)
{
  return std::string("The ") + what + " is smaller than two voxels of the volume on each axis. " +
    Describe(what, box, volume);
}

// The rounding of world coordinates of a volume in single precision.
struct Rounding
{
  double Largest = 0.0; // coordinate
  double Error = 0.0;
  double Voxels = 0.0; // the error in voxels

  explicit Rounding(const ImageGeometry& volume)
  {
    this->Largest = GetLargestCoordinate(volume);
    this->Error = this->Largest / static_cast<double>(1 << 24);
    this->Voxels = this->Error / GetSmallestSpacing(volume);
  }
  bool IsSmall() const { return this->Voxels <= 1.0 / 256.0; }
  std::string Describe(const char* what) const
  {
    std::ostringstream text;
    text.precision(3);
    text << what << " are floats, which round coordinates of " << this->Largest << " by up to "
         << this->Error << ", " << this->Voxels << " times the spacing of the volume";
    return text.str();
  }
};

} // namespace

std::string DescribeRounding(const ImageGeometry& volume)
{
  const Rounding rounding(volume);
  return rounding.IsSmall() ? ""
                            : rounding.Describe("Rest positions") +
      ". To avoid that, subtract one offset from all coordinates.";
}

std::string DescribeRounding(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  const Rounding rounding(volume);
  if (rounding.IsSmall())
  {
    return "";
  }
  const Box box = FindBox(mesh, [](const glm::dvec3& point) { return point; });
  const Box voxels = GetIndexBox(volume.PointExtent);
  const glm::dvec3 gaps[2] = { box.Least - voxels.Least, voxels.Most - box.Most };
  bool isLost = false;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (const glm::dvec3& gap : gaps)
    {
      isLost = isLost || (gap[axis] > 0.0 && gap[axis] <= rounding.Voxels);
    }
  }
  return isLost ? rounding.Describe("The points of the deformation mesh") +
      ". So the mesh ends before the outermost voxels, which are lost: use points in double "
      "precision, or subtract one offset from all coordinates."
                : "";
}

std::string DescribeSmallness(const ImageGeometry& field, const ImageGeometry& volume)
{
  const Box box = FindBox(field, volume.GetWorldToIndex() * field.GetIndexToWorld());
  return IsSmall(box, volume) ? DescribeSmallness("field", GetWorldBox(field), volume) : "";
}

std::string DescribeSmallness(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  Box box;
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      box.Add(mesh.Points[static_cast<std::size_t>(node)]);
    }
    if (!IsSmall(box, volume))
    {
      return ""; // mostly after a few tetrahedra
    }
  }
  return box.Least.x <= box.Most.x ? DescribeSmallness("mesh", GetWorldBox(mesh, volume), volume)
                                   : "";
}

std::string DescribeBoxes(const ImageGeometry& field, const ImageGeometry& volume)
{
  return Describe("field", GetWorldBox(field), volume);
}

void CheckBoxes(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  const Box box = FindBox(mesh, [](const glm::dvec3& point) { return point; });
  const Box voxels = GetIndexBox(volume.PointExtent);
  for (int axis = 0; axis < 3; ++axis)
  {
    if (box.Least[axis] > voxels.Most[axis] || box.Most[axis] < voxels.Least[axis])
    {
      throw Error(DescribeMiss(mesh, volume));
    }
  }
}

std::string DescribeMiss(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  const Box box = GetWorldBox(mesh, volume);
  return "The deformation mesh at rest holds no voxel of the volume. " +
    Describe("mesh", box, volume) +
    " Check also that the deformation mesh or, where one is given, the rest configuration is "
    "at rest.";
}

} // namespace deformvolume
