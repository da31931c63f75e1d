// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronRecords_h
#define DeformVolumeTetrahedronRecords_h

#include "OpenCLContext.h"
#include "VertexRuns.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// The records of runs on the device (RunEvaluation.cl): the tetrahedra at rest, and their current
/// displacements.
class TetrahedronRecords
{
public:
  TetrahedronRecords(
    OpenCLContext& context, const cl::CommandQueue& queue, std::uint64_t allocationLimit);

  void Set(const std::vector<RestTetrahedron>& tetrahedra);
  void Clear();

  /// The displacements of each record as an affine function (TetrahedronRecord). Valid if
  /// AreCurrent().
  const cl::Buffer& Get() const { return this->Records; }
  /// Whether Evaluate() has been called since the last Set(), Clear() or Invalidate(). Call
  /// Invalidate() after nodes have moved.
  bool AreCurrent() const { return this->Current; }
  void Invalidate() { this->Current = false; }
  cl::Event Evaluate(
    const cl::Program& mapping, const cl::Buffer& tetrahedra, const cl::Buffer& nodes);

  /// The tetrahedron of each record.
  const cl::Buffer& GetOwners() const { return this->Owners; }
  /// Calls visit(numbers) with DEFORMVOLUME_REST_NUMBERS numbers for each record, which describe
  /// the tetrahedron at rest (RunEvaluation.cl). For CPU devices.
  void VisitRest(const std::function<void(const double*)>& visit) const;

  std::uint64_t GetMemory() const;

private:
  cl::Buffer MakeBuffer(std::uint64_t bytes) const;
  void WriteRest(std::size_t record, const RestTetrahedron& tetrahedron, void* rest) const;
  std::size_t GetRestSize() const;

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::uint64_t AllocationLimit;
  cl::Buffer Rest; // DEFORMVOLUME_REST_NUMBERS reals per record, see RunEvaluation.cl
  cl::Buffer Owners;
  cl::Buffer Records;
  std::size_t Count = 0;
  bool Current = false;
};

} // namespace deformvolume

#endif
