// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailSession_h
#define DeformVolumeChainMailSession_h

#include "ChainMailModel.h"
#include "ImageGeometry.h"
#include "MaterialTable.h"
#include "Stamp.h"
#include "VectorOutput.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

class vtkImageData;
class vtkPointSet;

namespace deformvolume
{

/// What vtkChainMailDeformation was told.
struct ChainMailSettings
{
  MaterialTable<ChainMailMaterial> Table;
  std::string ArrayName;
  int DefaultMaterial = 1;
  double HandleRadius = 0.0;
  std::string Device;
  std::int64_t MemoryLimit = 0;
};

/// A ChainMailModel with its output, and what it was given of VTK's data.
class ChainMailSession
{
public:
  /// handles: null where there are none. Throws Error and Aborted; the displacements are then as
  /// before, but for errors of the device.
  ChainMailReport Step(vtkImageData* volume, vtkPointSet* handles,
    const ChainMailSettings& settings, ChainMailRequest request);

  /// Gives an image the geometry and the array of the last step.
  void GiveOutput(vtkImageData* output) const;

  /// Puts all voxels to rest before the next step.
  void Reset()
  {
    this->IsToReset = true;
    this->ToRestore = nullptr;
  }

  ///@{
  /// The displacements as they are before the next step, under a number, and back to them before
  /// the next step. False where there is no such state, or it is one of another volume.
  std::int64_t SaveState();
  bool RestoreState(std::int64_t number);
  bool RemoveState(std::int64_t number);
  std::size_t GetNumberOfStates() const { return this->States.size(); }
  /// Bytes that they take.
  std::uint64_t GetStateMemory() const { return this->StateMemory; }
  ///@}

  const std::string& GetDevice() const { return this->Device; }

private:
  /// What the materials were made of.
  struct MaterialsKey
  {
    Stamp Array;
    std::vector<double> Numbers;
    bool operator==(const MaterialsKey& other) const
    {
      return this->Array == other.Array && this->Numbers == other.Numbers;
    }
  };

  void SetVolume(const ImageGeometry& geometry, const ChainMailSettings& settings);
  void Forget();
  void MakeOutput(vtkIdType voxels);
  /// Says which displacements a step has written.
  void LogChanges(const ChainMailReport& report);

  ChainMailModel Model;
  std::string Device;
  bool HasVolume = false;
  bool IsToReset = false;
  std::shared_ptr<const ChainMailSnapshot> ToRestore; // null: nothing
  std::map<std::int64_t, std::shared_ptr<const ChainMailSnapshot>> States;
  std::int64_t LastState = -1;
  // How many states have each of their blocks.
  std::unordered_map<const ChainMailSnapshot::Block*, std::size_t> Owners;
  std::uint64_t StateMemory = 0;
  ImageGeometry Geometry;
  MaterialsKey KeyOfMaterials;
  Stamp StampOfMasks;
  Stamp StampOfPins;
  VectorOutput Output;
};

} // namespace deformvolume

#endif
