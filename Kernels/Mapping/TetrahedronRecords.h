// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronRecords_h
#define DeformVolumeTetrahedronRecords_h

#include "MeshOrder.h"
#include "OpenCLContext.h"
#include "VertexRuns.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// The records of runs on the device (RunEvaluation.cl): where tetrahedra lie at rest, and what
/// that comes to with the displacements of now.
class TetrahedronRecords
{
public:
  TetrahedronRecords(
    OpenCLContext& context, const cl::CommandQueue& queue, std::uint64_t allocationLimit);

  /// With numbers of the mesh, which become those of the device.
  void Set(const std::vector<RestTetrahedron>& tetrahedra, const MeshOrder& order);
  /// Finds a record for each of some tetrahedra, or adds one. removed: tetrahedra of the device
  /// whose records are of no use any more. Returns their numbers.
  std::vector<std::int32_t> Add(const std::vector<RestTetrahedron>& tetrahedra,
    const MeshOrder& order, const std::vector<std::int32_t>& removed);
  void Clear();

  /// For each record the displacements as an affine function (TetrahedronRecord), after Evaluate,
  /// which is due after the nodes have moved.
  const cl::Buffer& Get() const { return this->Records; }
  bool AreCurrent() const { return this->Current; }
  void Forget() { this->Current = false; }
  cl::Event Evaluate(
    const cl::Program& mapping, const cl::Buffer& tetrahedra, const cl::Buffer& nodes);

  /// The tetrahedron of each, -1 where a record is of no use.
  const cl::Buffer& GetOwners() const { return this->Owners; }
  /// Calls a function with the 15 numbers of each (RunEvaluation.cl). On a processor.
  void VisitRest(const std::function<void(const double*)>& visit) const;

  std::uint64_t GetMemory() const;

private:
  /// Gives the buffers room for so many records; those that there are stay.
  void MakeRoom(std::size_t count);
  /// Makes a buffer of so many bytes, and copies as many of it as are used.
  void Grow(cl::Buffer& buffer, std::uint64_t bytes, std::uint64_t used) const;
  void WriteRest(std::size_t record, const RestTetrahedron& tetrahedron, void* rest) const;
  std::size_t GetRestSize() const;

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::uint64_t AllocationLimit;
  cl::Buffer Rest; // of each record 15 reals, see RunMapping.cl
  cl::Buffer Owners;
  cl::Buffer Records;
  std::size_t Count = 0;
  bool Current = false;
};

} // namespace deformvolume

#endif
