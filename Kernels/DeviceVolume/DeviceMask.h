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

/// A mask of a volume on the device: of its vertices, which of them are blanked, or how far they
/// are from the boundary; or of its cells, which tetrahedra of them are active. Only what differs
/// from what the device has is sent.
class DeviceMask
{
public:
  enum class Kind
  {
    BlankedVertices,
    ActiveTetrahedra,
    BoundaryDistances // a float a vertex
  };

  explicit DeviceMask(Kind kind)
    : MaskKind(kind)
  {
  }

  /// Whether the chunks have a buffer of it. Else no vertex is blanked, all tetrahedra are active,
  /// or no distance is negative.
  bool HasBuffers() const { return this->WithBuffers; }

  /// next: one byte for each vertex, of so many on each axis, or cell, or one float; null: all are
  /// as usual. bits: those of a byte that count. written: vertices or cells elsewhere have been
  /// left alone since the last call; null: any may have been written. Returns where the mask is not
  /// as it was: boxes of local indices that do not overlap.
  std::vector<Extent> Set(const OpenCLContext& context, const cl::CommandQueue& queue,
    const std::array<int, 3>& vertices, std::vector<VolumeChunk>& chunks, const unsigned char* next,
    unsigned char bits, const PointRanges* written);

private:
  cl::Buffer& GetBuffer(VolumeChunk& chunk) const;
  /// Bytes of a vertex or a cell.
  int GetWidth() const;
  std::size_t CountBytes() const
  {
    return static_cast<std::size_t>(this->Size[0]) * static_cast<std::size_t>(this->Size[1]) *
      static_cast<std::size_t>(this->Size[2]);
  }
  MaskValues MakeValues(const unsigned char* bytes, unsigned char bits) const;
  /// Whether something of a mask is not as usual. Notes the farthest of distances.
  bool IsAny(const MaskValues& values);
  /// First and last plane of a chunk in the mask.
  std::array<int, 2> GetPlanes(const VolumeChunk& chunk) const;
  void Allocate(
    const OpenCLContext& context, const cl::CommandQueue& queue, std::vector<VolumeChunk>& chunks);
  void Release(std::vector<VolumeChunk>& chunks);
  /// Sends one box that holds all changes. A call for each of them mostly takes longer than what
  /// lies between them: a cut or a carving has hundreds beside each other.
  void Write(
    const cl::CommandQueue& queue, VolumeChunk& chunk, const std::vector<Extent>& changes) const;

  Kind MaskKind;
  std::array<int, 3> Size{ { 0, 0, 0 } }; // on x in bytes
  bool WithBuffers = false;
  // What buffers hold before distances are there: those that are as far count as unchanged then.
  float Farthest = 0.0F;
  std::vector<unsigned char> Last; // what the device has, where the host cannot look into that
};

} // namespace deformvolume

#endif
