// SPDX-License-Identifier: BSD-3-Clause
// Links of voxels outside the deformation mesh. The reference is a search of all voxels inside.
#include "StaticMapping.h"

#include "TetrahedralMeshes.h"

#include <algorithm>
#include <cstring>
#include <limits>

using namespace deformvolume;
using namespace tetrahedralMeshes;

TEST(LinkExtrapolation, NearestTetrahedra)
{
  std::mt19937 random(5);
  const Extent voxels{ { -6, 12, 4, 20, -3, 13 } };
  for (const glm::dvec3& spacing :
    { glm::dvec3(1.0), glm::dvec3(0.7, 2.3, 1.1), glm::dvec3(5.0, 0.4, 0.9) })
  {
    for (const Mesh& mesh : { MakeSoup(40, 10, -4.0, 18.0, 0.0, random),
           MakeLattice(
             { 3, 4, 3 }, glm::dvec3(0.3, 7.1, 2.0), glm::dvec3(6.9, 15.0, 8.2), 0.3, 0.0, random),
           // A mesh that contains one voxel only.
           MakeLattice(
             { 2, 2, 2 }, glm::dvec3(4.9, 7.9, 6.9), glm::dvec3(5.2, 8.2, 7.2), 0.0, 0.0, random) })
    {
      const StaticMapping inside = BuildStaticMapping(
        voxels, spacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
      const StaticMapping all = BuildStaticMapping(
        voxels, spacing, mesh.Points, mesh.Tetrahedra, true, StaticMappingForm::Automatic);
      EXPECT_GT(inside.NumberOfInnerVoxels, 0);
      EXPECT_LT(inside.NumberOfInnerVoxels, GetNumberOfPoints(voxels));
      EXPECT_EQ(all.NumberOfInnerVoxels, inside.NumberOfInnerVoxels);
      for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
      {
        const VertexLink& link = all.Links[i];
        if (inside.Links[i].Tetrahedron >= 0)
        {
          EXPECT_EQ(std::memcmp(&link, &inside.Links[i], sizeof(link)), 0);
          continue;
        }
        double nearest = std::numeric_limits<double>::infinity();
        double chosen = nearest;
        for (std::int64_t j = 0; j < GetNumberOfPoints(voxels); ++j)
        {
          if (inside.Links[j].Tetrahedron >= 0)
          {
            const double distance =
              glm::length(glm::dvec3(GetVoxel(voxels, i) - GetVoxel(voxels, j)) * spacing);
            nearest = std::min(nearest, distance);
            if (inside.Links[j].Tetrahedron == link.Tetrahedron)
            {
              chosen = std::min(chosen, distance);
            }
          }
        }
        EXPECT_LE(chosen, nearest * (1.0 + 1e-12));
        if (link.Tetrahedron >= 0)
        {
          CheckWeights(mesh, link, glm::dvec3(GetVoxel(voxels, i)));
        }
      }
    }
  }
}
