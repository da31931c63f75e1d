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
#include "VolumeDeformer.h"
#include "WorkDevice.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The device of a VolumeDeformer, and what is on it.
class VolumeDeformer::Internals
{
public:
  /// A volume on the device with the deformation that is set, by the sampling mesh or by mesh
  /// rasterisation, and what makes outputs of both: what SetVoxelGrid forgets. Where cl::Error is
  /// thrown, what is on the device may be half done.
  struct Parts
  {
    Parts(WorkDevice& device, MemoryBudget& budget, const VoxelGrid& voxelGrid,
      std::size_t bytesPerVoxel, bool withLinks);

    /// tetrahedra: those of the mesh; null for a field.
    void SetBoundary(const MeshBoundary& boundary, const Tetrahedron* tetrahedra);
    /// Finds the boundary of a field, where its mapping is another one than before.
    void UpdateFieldBoundary(const DisplacementField& field);
    /// A mesh that was checked (CheckMesh). Mapping: links or runs.
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
    /// Throws an Error where there is no deformation mesh.
    void CheckMesh() const;
    void SetNodeDisplacements(
      const float* displacements, const PointRanges* changes, bool areChecked);

    /// Throws an Error where something is not set that a request needs.
    void CheckRequest(const DeformRequest& request) const;
    DeformationSize GetSize(const DeformRequest& request) const;
    DeformReport Deform(const DeformRequest& request);
    /// Brings to the host what can still be read of the last output and is on the device. Throws
    /// nothing.
    void BringOutput() { this->Unread.Bring(); }

    /// Bytes on the device.
    std::uint64_t GetMemory() const;

    WorkDevice& Device;
    MemoryBudget& Budget;
    DeviceVolume Volume;
    IncrementalOutput Incremental;
    DisplacementSource Source;
    ExactResampler Exact;
    MeshRasterizer Rasterizer;
    UnreadOutputs Unread;
    DisplacementField BoundaryField; // the one that the boundary was found of, without its vectors

  private:
    DeformReport Resample(const DeformRequest& request, std::uint64_t spare);
    DeformReport Rasterize(const DeformRequest& request, std::uint64_t spare);
  };

  Internals()
    : Budget(this->Device, [this] { return this->GetMemory(); })
  {
  }

  /// As CallGuarded does. After an error of OpenCL the volume is forgotten.
  template <typename Function>
  auto Guard(Function&& function)
  {
    return CallGuarded(function, [this] { this->Forget(); });
  }

  /// Like Guard, for functions that send data to the parts: their time belongs to the next
  /// deformation.
  template <typename Function>
  void Send(Function&& function)
  {
    const auto begin = std::chrono::steady_clock::now();
    this->Guard([&] { function(this->GetParts()); });
    this->SendingTime +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  /// Throws an Error where no volume is set.
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
      this->All->BringOutput(); // or it would keep its memory of the device
      this->All.reset();
    }
  }

  /// Bytes allocated on the device.
  std::uint64_t GetMemory() const { return this->All ? this->All->GetMemory() : 0; }

  WorkDevice Device;
  MemoryBudget Budget;
  std::unique_ptr<Parts> All;
  double SendingTime = 0.0; // since the last deformation, in seconds
};

} // namespace deformvolume

#endif
