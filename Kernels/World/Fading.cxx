// SPDX-License-Identifier: BSD-3-Clause
#include "Fading.h"

#include "DeviceSession.h" // for WorldMasks
#include "Error.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace deformvolume
{

OutsideVoxels MakeKeptVoxels(double fadeDistance)
{
  if (!std::isfinite(fadeDistance) || fadeDistance < 0.0)
  {
    throw Error("The fade distance is " + FormatNumber(fadeDistance) +
      ". Set a distance in world units, or 0, with which nothing outside the mesh or the field "
      "moves.");
  }
  return { OutsideVoxels::Modes::Keep, fadeDistance };
}

namespace
{

// Returns the longest displacement of the points on the border of a field, in world units.
double GetLongestOnBorder(const DisplacementField& field, const glm::dvec3& spacing)
{
  const std::array<int, 3>& size = field.Dimensions;
  double longest = 0.0;
  std::int64_t point = 0;
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      const bool isOnBorder = z == 0 || z == size[2] - 1 || y == 0 || y == size[1] - 1;
      const int step = isOnBorder ? 1 : std::max(size[0] - 1, 1);
      for (int x = 0; x < size[0]; x += step)
      {
        const double length = glm::length(spacing * GetVector(field, point + x));
        longest = length > longest ? length : longest; // undefined points are not-a-number
      }
      point += size[0];
    }
  }
  return longest;
}

// Whether a tetrahedron is resampled, and a smooth cut does not divide it.
bool IsWhole(const WorldMasks& masks, const StretchedTetrahedra::Candidate& candidate)
{
  const auto cell = static_cast<std::size_t>(candidate.Cell);
  const unsigned int bit = 1U << static_cast<unsigned int>(candidate.Tetrahedron);
  int carved = 0;
  int beyond = 0;
  for (const std::int64_t vertex : candidate.Vertices)
  {
    const auto number = static_cast<std::size_t>(vertex);
    if (masks.Blanked && (masks.Blanked[number] & masks.BlankedBits) != 0)
    {
      return false;
    }
    carved += masks.BoundaryDistances && masks.BoundaryDistances[number] < 0.0F ? 1 : 0;
    beyond += masks.CutDistances && masks.CutDistances[number] < 0.0F ? 1 : 0;
  }
  const bool isActive = !masks.ActiveTetrahedra || (masks.ActiveTetrahedra[cell] & bit) != 0;
  const bool isCrossed = masks.CutTetrahedra && (masks.CutTetrahedra[cell] & bit) != 0;
  return isActive && carved < 4 && !(isCrossed && beyond > 0 && beyond < 4);
}

} // namespace

std::string GetFoldWarning(const std::string& border, double longest, double fadeDistance)
{
  // The slope of the weight is 1.5 at most.
  if (!(fadeDistance > 0.0) || 1.5 * longest <= fadeDistance)
  {
    return "";
  }
  return "The " + border + " by up to " + FormatNumber(longest) +
    ", more than two thirds of the fade distance, " + FormatNumber(fadeDistance) +
    ": what lies outside may fold over. Set a fade distance of at least twice that displacement.";
}

std::string GetFadingWarning(const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements, const glm::dvec3& spacing, double fadeDistance,
  const WorldMasks& masks)
{
  // Fading alone stretches as much as a jump then, and a smaller fade distance would be worse.
  std::string text = GetFoldWarning("boundary of the deformation mesh moves",
    links.GetLongestDisplacement(tetrahedra, displacements, spacing), fadeDistance);
  if (!text.empty())
  {
    return text;
  }
  const std::int64_t stretched = links.CountStretched(tetrahedra, displacements,
    [&](const StretchedTetrahedra::Candidate& candidate) { return IsWhole(masks, candidate); });
  if (stretched > 0)
  {
    text = (links.IsCountEstimated() ? "About " : "") + std::to_string(stretched) +
      " tetrahedra of the volume outside the deformation mesh are stretched over more than 2 "
      "output voxels, ";
    text += fadeDistance > 0.0
      ? "where the closest point of the mesh jumps, as between two bodies that move apart. Add "
        "cells to the mesh between them, or set a smaller fade distance."
      : "as the fade distance is 0 and the boundary of the mesh moves. Set a fade distance of at "
        "least twice its displacement, unless the volume is cut there.";
  }
  return text;
}

std::string GetFadingWarning(const DisplacementField& field, const IndexBounds& box,
  const glm::dvec3& spacing, double fadeDistance)
{
  if (HoldsBox(field, box, FieldTolerance))
  {
    return "";
  }
  const double longest = GetLongestOnBorder(field, spacing);
  const std::string border = "border of the displacement field moves";
  // Without fading, the displacement jumps at the border. A displacement longer than two voxels
  // folds or stretches the volume there.
  if (fadeDistance == 0.0 && longest > 2.0 * std::min({ spacing.x, spacing.y, spacing.z }))
  {
    return "The " + border + " by up to " + FormatNumber(longest) +
      ", and as the fade distance is 0 the volume is stretched or folded there. Set a fade "
      "distance of at least twice that displacement.";
  }
  return GetFoldWarning(border, longest, fadeDistance);
}

} // namespace deformvolume
