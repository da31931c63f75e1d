// SPDX-License-Identifier: BSD-3-Clause
#include "WorldBoxes.h"

#include "Error.h"
#include "ImageGeometry.h"
#include "IndexBounds.h"
#include "MeshAtRest.h"
#include "OutsideVoxels.h"

#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <sstream>

namespace deformvolume
{

namespace
{

IndexBounds GetWorldBox(const ImageGeometry& geometry)
{
  return TransformBox(geometry.GetIndexToWorld(), GetBox(geometry.PointExtent));
}

// Returns the box of the nodes that tetrahedra use. transform: applied to each node, in indices of
// a volume.
IndexBounds FindBox(const MeshAtRest& mesh, const glm::dmat4& transform = glm::dmat4(1.0))
{
  IndexBounds box;
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      const glm::dvec4 point(mesh.Points[static_cast<std::size_t>(node)], 1.0);
      box.Add(glm::dvec3(transform * point));
    }
  }
  return box;
}

std::string Describe(const IndexBounds& box)
{
  std::ostringstream text;
  for (int axis = 0; axis < 3; ++axis)
  {
    text << (axis == 0 ? "" : ", ") << "xyz"[axis] << " from " << box.Min[axis] << " to "
         << box.Max[axis];
  }
  return text.str();
}

std::string Describe(const char* what, const IndexBounds& box, const ImageGeometry& volume)
{
  return std::string("The box of the ") + what + " is " + Describe(box) +
    ", and that of the volume " + Describe(GetWorldBox(volume)) +
    ". Give both in the same world coordinates and the same unit: the usual cause is that "
    "one is in meters and the other in millimeters.";
}

// Whether a box in indices of a volume is smaller than two voxels, and than a fourth of the volume,
// on each axis.
bool IsSmall(const IndexBounds& box, const ImageGeometry& volume)
{
  const IndexBounds voxels = GetBox(volume.PointExtent);
  const glm::dvec3 most = glm::min(glm::dvec3(2.0), 0.25 * (voxels.Max - voxels.Min));
  return glm::all(glm::lessThan(box.Max - box.Min, most));
}

// Whether a box in indices of a volume is more than so many times as long as the volume on each
// axis.
bool IsLarge(const IndexBounds& box, const ImageGeometry& volume, double times)
{
  const IndexBounds voxels = GetBox(volume.PointExtent);
  return glm::all(glm::greaterThan(box.Max - box.Min, times * (voxels.Max - voxels.Min)));
}

std::string DescribeSmallness(const char* what, const IndexBounds& box, const ImageGeometry& volume)
{
  return std::string("The ") + what + " is smaller than two voxels of the volume on each axis. " +
    Describe(what, box, volume);
}

bool AreVectorsEqual(const DisplacementField& field)
{
  const float* const end = field.Vectors + 3 * GetNumberOfPoints(field);
  return std::equal(field.Vectors + 3, end, field.Vectors);
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

std::string GetRoundingWarning(const ImageGeometry& volume)
{
  const Rounding rounding(volume);
  return rounding.IsSmall() ? ""
                            : rounding.Describe("Rest positions") +
      ". To avoid that, subtract one offset from all coordinates.";
}

std::string GetRoundingWarning(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  const Rounding rounding(volume);
  if (rounding.IsSmall())
  {
    return "";
  }
  const IndexBounds box = FindBox(mesh);
  const IndexBounds voxels = GetBox(volume.PointExtent);
  const glm::dvec3 gaps[2] = { box.Min - voxels.Min, voxels.Max - box.Max };
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

std::string GetSizeWarning(const ImageGeometry& field, const ImageGeometry& volume,
  const OutsideVoxels& outside, const std::function<DisplacementField()>& getField)
{
  const IndexBounds box =
    TransformBox(volume.GetWorldToIndex() * field.GetIndexToWorld(), GetBox(field.PointExtent));
  const bool isLarge = IsLarge(box, volume, 100.0);
  if ((!isLarge && !IsSmall(box, volume)) ||
    // The size of a field does not matter for a translation of all voxels.
    ((isLarge || outside.AreExtrapolated()) && AreVectorsEqual(getField())))
  {
    return "";
  }
  return isLarge ? "The field is more than a hundred times as long as the volume on each axis. " +
      Describe("field", GetWorldBox(field), volume)
                 : DescribeSmallness("field", GetWorldBox(field), volume);
}

std::string GetSizeWarning(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  IndexBounds box;
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    IndexBounds own;
    for (const std::int32_t node : tetrahedron)
    {
      own.Add(mesh.Points[static_cast<std::size_t>(node)]);
    }
    if (IsLarge(own, volume, 10.0))
    {
      return "The cells of the mesh are more than ten times as long as the volume. " +
        Describe("mesh", FindBox(mesh, volume.GetIndexToWorld()), volume);
    }
    box.Add(own);
    if (!IsSmall(box, volume))
    {
      return ""; // mostly after a few tetrahedra
    }
  }
  return !box.IsEmpty() ? DescribeSmallness("mesh", FindBox(mesh, volume.GetIndexToWorld()), volume)
                        : "";
}

std::string DescribeBoxes(const ImageGeometry& field, const ImageGeometry& volume)
{
  return Describe("field", GetWorldBox(field), volume);
}

void CheckBoxes(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  if (!FindBox(mesh).Overlaps(GetBox(volume.PointExtent)))
  {
    throw Error(DescribeMissedVolume(mesh, volume));
  }
}

std::string DescribeMissedVolume(const MeshAtRest& mesh, const ImageGeometry& volume)
{
  const IndexBounds box = FindBox(mesh, volume.GetIndexToWorld());
  return "The deformation mesh at rest holds no voxel of the volume. " +
    Describe("mesh", box, volume) +
    " Check also that the points of the deformation mesh, or those of the mesh at rest if there is "
    "one, are not deformed.";
}

} // namespace deformvolume
