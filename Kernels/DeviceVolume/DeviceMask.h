// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceMask_h
#define DeformVolumeDeviceMask_h

#include "Extent.h"
#include "MaskChanges.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// A mask of a volume on the device: blanked vertices, boundary distances of vertices, or active
/// tetrahedra of cells. Only differences to the mask on the device are copied.
class DeviceMask
{
public:
  enum class Kind
  {
    BlankedVertices,
    ActiveTetrahedra,
    BoundaryDistances // a float per vertex
  };

  explicit DeviceMask(Kind kind)
    : MaskKind(kind)
  {
  }

  /// Whether the chunks have buffers for the mask. Otherwise no vertex is blanked, all tetrahedra
  /// are active, or no distance is negative.
  bool HasBuffers() const { return this->WithBuffers; }

  /// Set the mask. vertices: number of vertices on each axis. next: one byte per vertex or cell, or
  /// one float per vertex; null: no vertex is blanked, all tetrahedra are active, or no distance is
  /// negative. bits: the bits of a byte that belong to the mask. written: vertices or cells that
  /// may have been written since the last call; null: any. Returns boxes of local indices that
  /// contain all changes and do not overlap.
  std::vector<Extent> Set(const OpenCLContext& context, const cl::CommandQueue& queue,
    const std::array<int, 3>& vertices, std::vector<VolumeChunk>& chunks, const unsigned char* next,
    unsigned char bits, const PointRanges* written);

private:
  cl::Buffer& GetBuffer(VolumeChunk& chunk) const;
  /// Bytes per vertex or cell.
  int GetWidth() const;
  std::size_t CountBytes() const
  {
    return static_cast<std::size_t>(this->Size[0]) * static_cast<std::size_t>(this->Size[1]) *
      static_cast<std::size_t>(this->Size[2]);
  }
  MaskValues MakeValues(const unsigned char* bytes, unsigned char bits) const;
  /// Whether a mask has any effect. Sets Farthest to the largest distance.
  bool IsAny(const MaskValues& values);
  /// Returns the first and the last plane of a chunk in the mask.
  std::array<int, 2> GetPlanes(const VolumeChunk& chunk) const;
  void Allocate(
    const OpenCLContext& context, const cl::CommandQueue& queue, std::vector<VolumeChunk>& chunks);
  void Release(std::vector<VolumeChunk>& chunks);
  /// Copies one box that contains all changes. A cut or a carving has hundreds of neighboring
  /// changes, and separate copies would usually take longer.
  void Write(
    const cl::CommandQueue& queue, VolumeChunk& chunk, const std::vector<Extent>& changes) const;

  Kind MaskKind;
  std::array<int, 3> Size{ { 0, 0, 0 } }; // vertices or cells on each axis, times GetWidth() on x
  bool WithBuffers = false;
  // Initial value of the buffers for distances, so that vertices at this distance do not count as
  // changed.
  float Farthest = 0.0F;
  std::vector<unsigned char> Last; // a copy of the mask on the device, if the host cannot map it
};

} // namespace deformvolume

#endif
