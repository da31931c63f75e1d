// SPDX-License-Identifier: BSD-3-Clause
// Deforms an array by a tetrahedral mesh, without VTK: a volume of 64 x 64 x 64 voxels is sheared,
// by 16 voxels along x from its lowest slice to its highest one.
#include <deformvolume/Kernels/FiveTetrahedra.h>
#include <deformvolume/Kernels/StaticMapping.h>
#include <deformvolume/Kernels/VolumeDeformer.h>

#include <cmath>
#include <iostream>

using namespace deformvolume;

int main()
{
  const int size = 64;
  const int last = size - 1;
  std::vector<float> volume(size * size * size);
  for (std::size_t i = 0; i < volume.size(); ++i)
  {
    volume[i] = static_cast<float>(i % size); // the x index; x varies fastest
  }

  // The corners of the volume at rest, in voxels, the tetrahedra, and how far each corner moves.
  std::vector<glm::dvec3> corners;
  std::vector<float> displacements;
  for (int corner = 0; corner < 8; ++corner)
  {
    corners.emplace_back(last * (corner & 1), last * (corner >> 1 & 1), last * (corner >> 2));
    displacements.insert(displacements.end(), { 16.0F * (corner >> 2), 0.0F, 0.0F });
  }
  const std::vector<Tetrahedron> tetrahedra = DEFORMVOLUME_FIVE_TETRAHEDRA;

  DeformRequest request;
  request.OutputExtent = { 0, last + 16, 0, last, 0, last };
  const int width = size + 16;
  std::vector<float> output(width * size * size);
  std::vector<signed char> covered(output.size());
  request.Outputs = { output.data() };
  request.Coverage = covered.data();
  try
  {
    VoxelGrid voxelGrid;
    voxelGrid.VertexExtent = { 0, last, 0, last, 0, last };
    VolumeArray array;
    array.Data = volume.data();
    array.Type = ElementType::Float32;
    array.Background = -1.0;
    const StaticMapping mapping = BuildStaticMapping(voxelGrid.VertexExtent, glm::dvec3(1.0),
      corners, tetrahedra, false, StaticMappingForm::Links);

    VolumeDeformer deformer;
    std::cout << deformer.SetDevice("") << '\n';
    deformer.SetVoxelGrid(voxelGrid);
    deformer.SetArrays({ array });
    deformer.SetMesh(tetrahedra.data(), tetrahedra.size(), corners.size(), mapping.Links.data());
    // Repeat these two calls whenever the mesh has moved.
    deformer.SetNodeDisplacements(displacements.data());
    std::cout << deformer.Deform(request).NumberOfCoveredVoxels << " voxels covered\n";
  }
  catch (const Error& error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  // The middle of the highest slice has moved by 16.
  const std::size_t there = (static_cast<std::size_t>(last) * size + 32) * width + 32 + 16;
  return covered[there] && std::abs(output[there] - 32.0F) < 0.01F ? 0 : 1;
}
