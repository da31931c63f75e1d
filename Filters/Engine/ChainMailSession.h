// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailSession_h
#define DeformVolumeChainMailSession_h

#include "ChainMailModel.h"
#include "ImageGeometry.h"
#include "MaterialTable.h"
#include "Stamp.h"
#include "VectorOutput.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

class vtkImageData;
class vtkPointSet;

namespace deformvolume
{

/// Settings of vtkChainMailDeformation.
struct ChainMailSettings
{
  MaterialTable<ChainMailMaterial> Table;
  std::string ArrayName;
  int DefaultMaterial = 1;
  double HandleRadius = 0.0;
  std::string Device;
  std::int64_t MemoryLimit = 0;
};

/// A ChainMailModel with its output array, and with stamps of the VTK data that it was given.
class ChainMailSession
{
public:
  /// Executes a step, unless neither source nor the data that are used have changed since the last
  /// one, as when another piece is requested. source: stamps of the settings and of the pipeline
  /// upstream of the volume. written: stamp of the volume, see GetWrittenStamp(). handles: null if
  /// there are none. Returns the report of the last step. Throws Error and Aborted. The
  /// displacements do not change then, unless the device has failed.
  const ChainMailReport& Step(const Stamp& source, vtkImageData* volume,
    const Stamp::value_type& written, vtkPointSet* handles, const ChainMailSettings& settings,
    ChainMailRequest request);

  /// Sets the geometry and the displacements of the last step in an image.
  void GiveOutput(vtkImageData* output) const;

  /// Lets the next step begin with all voxels at rest.
  void Reset()
  {
    this->IsToReset = true;
    this->ToRestore = nullptr;
  }

  ///@{
  /// Save the displacements as a state and return its number; let the next step begin with the
  /// displacements of a state; remove a state. RestoreState() and RemoveState() return false if
  /// there is no such state. RestoreState() also returns false for a state of another volume.
  std::int64_t SaveState();
  bool RestoreState(std::int64_t number);
  bool RemoveState(std::int64_t number);
  std::size_t GetNumberOfStates() const { return this->States.size(); }
  /// Memory of all states, in bytes.
  std::uint64_t GetStateMemory() const { return this->StateMemory; }
  ///@}

  const std::string& GetDevice() const { return this->Device; }

private:
  /// Identifies the array and the settings that the materials were read from.
  using MaterialsKey = std::pair<Stamp, std::vector<double>>;
  /// What a step was made from, in addition to Geometry: the source, the time of the arrays of the
  /// volume if any are used, and the handles. Stamps of arrays would also differ if the source of
  /// the volume has made a piece in between.
  using StepKey =
    std::tuple<Stamp, std::optional<double>, std::vector<glm::dvec3>, std::vector<glm::dvec3>>;

  void SetVolume(const ImageGeometry& geometry, const ChainMailSettings& settings);
  void Forget();
  void MakeOutput(vtkIdType voxels);
  /// Adds the displacements that a step has written to the log of the output array.
  void LogChanges(const ChainMailReport& report);

  ChainMailModel Model;
  std::string Device;
  bool HasVolume = false;
  bool IsToReset = false;
  std::shared_ptr<const ChainMailSnapshot> ToRestore; // null: no state
  std::map<std::int64_t, std::shared_ptr<const ChainMailSnapshot>> States;
  std::int64_t LastState = -1;
  // Number of states that share each block.
  std::unordered_map<const ChainMailSnapshot::Block*, std::size_t> Owners;
  std::uint64_t StateMemory = 0;
  ImageGeometry Geometry;
  MaterialsKey KeyOfMaterials;
  Stamp StampOfMasks;
  Stamp StampOfPins;
  StepKey KeyOfStep;
  ChainMailReport Report;
  VectorOutput Output;
};

} // namespace deformvolume

#endif
