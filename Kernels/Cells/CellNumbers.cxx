// SPDX-License-Identifier: BSD-3-Clause
#include "CellNumbers.h"

#include <map>

namespace deformvolume
{

std::string GetCellName(int type)
{
  static const auto& names = *new std::map<int, const char*>{
    { 0, "empty cell" },
    { 1, "vertex" },
    { 2, "poly vertex" },
    { 3, "line" },
    { 4, "poly line" },
    { 5, "triangle" },
    { 6, "triangle strip" },
    { 7, "polygon" },
    { 8, "pixel" },
    { 9, "quad" },
    { 10, "tetra" },
    { 11, "voxel" },
    { 12, "hexahedron" },
    { 13, "wedge" },
    { 14, "pyramid" },
    { 15, "pentagonal prism" },
    { 16, "hexagonal prism" },
    { 21, "quadratic edge" },
    { 22, "quadratic triangle" },
    { 23, "quadratic quad" },
    { 24, "quadratic tetra" },
    { 25, "quadratic hexahedron" },
    { 26, "quadratic wedge" },
    { 27, "quadratic pyramid" },
    { 28, "bi quadratic quad" },
    { 29, "tri quadratic hexahedron" },
    { 30, "quadratic linear quad" },
    { 31, "quadratic linear wedge" },
    { 32, "bi quadratic quadratic wedge" },
    { 33, "bi quadratic quadratic hexahedron" },
    { 34, "bi quadratic triangle" },
    { 35, "cubic line" },
    { 36, "quadratic polygon" },
    { 37, "tri quadratic pyramid" },
    { 41, "convex point set" },
    { 42, "polyhedron" },
    { 68, "lagrange curve" },
    { 69, "lagrange triangle" },
    { 70, "lagrange quadrilateral" },
    { 71, "lagrange tetra" },
    { 72, "lagrange hexahedron" },
    { 73, "lagrange wedge" },
    { 74, "lagrange pyramid" },
    { 75, "bezier curve" },
    { 76, "bezier triangle" },
    { 77, "bezier quadrilateral" },
    { 78, "bezier tetra" },
    { 79, "bezier hexahedron" },
    { 80, "bezier wedge" },
    { 81, "bezier pyramid" },
  };
  const auto found = names.find(type);
  return found == names.end() ? "cell of unknown type" : found->second;
}

} // namespace deformvolume
