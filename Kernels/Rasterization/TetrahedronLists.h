// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronLists_h
#define DeformVolumeTetrahedronLists_h

#include "OpenCLContext.h"
#include "RasterParameters.h"

#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// For each tile of the output the tetrahedra of the deformation mesh that may hold some of its
/// voxels (TetrahedronBinning.cl).
class TetrahedronLists
{
public:
  /// Lists them, and puts into the parameters how. tetrahedra, positions: of the mesh. Returns how
  /// many tetrahedra are inverted. Throws an Error where the deformation is beyond what can be
  /// rasterised.
  std::int64_t Make(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    RasterParameters& parameters);

  /// For each tile where its list begins, in the lists.
  const cl::Buffer& GetBegins() const { return this->Begins; }
  const cl::Buffer& GetLists() const { return this->Lists; }

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  std::int64_t Count(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& p);
  /// Makes places in the lists of what was counted. Returns how long these are.
  std::uint64_t FindPlaces(WorkDevice& device, const RasterParameters& p);

  cl::Buffer Places; // of each range of tetrahedra in the lists
  cl::Buffer Begins;
  cl::Buffer Lists;
};

} // namespace deformvolume

#endif
