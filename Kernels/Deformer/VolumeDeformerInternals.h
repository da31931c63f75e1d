// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformerInternals_h
#define DeformVolumeVolumeDeformerInternals_h

#include "DeviceOutputInternals.h"
#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "ExactResampler.h"
#include "GuardedCall.h"
#include "IncrementalOutput.h"
#include "MemoryBudget.h"
#include "MemoryNeeds.h"
#include "MeshRasterizer.h"
#include "Stopwatch.h"
#include "VolumeDeformer.h"
#include "WorkDevice.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The device of a VolumeDeformer, and the data on it.
class VolumeDeformer::Internals
{
public:
  /// A volume on the device, its deformation, and both resamplers: all that SetVoxelGrid discards.
  /// After a cl::Error the data on the device may be incomplete.
  struct Parts
  {
    Parts(WorkDevice& device, MemoryBudget& budget, const VoxelGrid& voxelGrid,
      std::size_t bytesPerVoxel, bool withLinks);

    /// Sets the boundary. tetrahedra: the tetrahedra of the mesh; null for a field.
    void SetBoundary(const MeshBoundary& boundary, const Tetrahedron* tetrahedra);
    /// Finds the boundary of a field, if the mapping of the field changed.
    void UpdateFieldBoundary(const DisplacementField& field);
    /// Sets a mesh. CheckMesh() and CheckLinks() or CheckRuns() must have accepted it. Mapping:
    /// links or runs.
    template <typename Mapping>
    void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
      std::size_t numberOfNodes, const Mapping& mapping, const MeshBoundary* boundary)
    {
      this->SetBoundary({}, nullptr);
      this->Source.SetMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, mapping);
      if (boundary)
      {
        this->SetBoundary(*boundary, tetrahedra);
      }
      this->Rasterizer.Clear();
    }
    /// Throws an Error if there is no deformation mesh.
    void CheckMesh() const;
    void SetNodeDisplacements(
      const float* displacements, const PointRanges* changes, bool areChecked);

    /// Throws an Error if something that a request needs is not set.
    void CheckRequest(const DeformRequest& request) const;
    DeformationSize GetSize(const DeformRequest& request) const;
    DeformReport Deform(const DeformRequest& request);
    /// Copies the last output to the host, as far as it is on the device and can still be read.
    /// Does not throw.
    void BringOutput() { this->Unread.Download(); }

    /// The memory allocated on the device, in bytes.
    std::uint64_t GetMemory() const;

    WorkDevice& Device;
    MemoryBudget& Budget;
    DeviceVolume Volume;
    IncrementalOutput Incremental;
    DisplacementSource Source;
    ExactResampler Exact;
    MeshRasterizer Rasterizer;
    UnreadOutputs Unread;
    DisplacementField BoundaryField; // the field of the current boundary, without its vectors

  private:
    DeformReport Resample(const DeformRequest& request, std::uint64_t spare);
    DeformReport Rasterize(const DeformRequest& request, std::uint64_t spare);
  };

  Internals()
    : Budget(this->Device, [this] { return this->GetMemory(); })
  {
  }

  /// Calls a function as CallGuarded does. After an OpenCL error the volume is discarded.
  template <typename Function>
  auto Guard(Function&& function)
  {
    return CallGuarded(function, [this] { this->Forget(); });
  }

  /// Like Guard, for functions that send data. Their time is reported by the next deformation.
  template <typename Function>
  void Send(Function&& function)
  {
    const Stopwatch watch;
    this->Guard([&] { function(this->GetParts()); });
    this->SendingTime += watch.GetSeconds();
  }

  /// Throws an Error if no volume is set.
  Parts& GetParts() const
  {
    if (!this->All)
    {
      throw Error("No volume is set: call SetVoxelGrid first.");
    }
    return *this->All;
  }

  void Forget()
  {
    if (this->All)
    {
      this->All->BringOutput(); // otherwise it would keep device memory
      this->All.reset();
    }
  }

  std::uint64_t GetMemory() const { return this->All ? this->All->GetMemory() : 0; }

  WorkDevice Device;
  MemoryBudget Budget;
  std::unique_ptr<Parts> All;
  double SendingTime = 0.0; // since the last deformation, in seconds
};

} // namespace deformvolume

#endif
