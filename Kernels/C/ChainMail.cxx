// SPDX-License-Identifier: BSD-3-Clause
// dv_chainmail: a ChainMailModel of a volume in world coordinates, and its displacements.
#include "Call.h"
#include "ChainMailModel.h"
#include "Conversions.h"
#include "CrossedTetrahedra.h"
#include "Deformer.h"
#include "ParallelFor.h"
#include "VoxelMaterials.h"
#include "WorldHandles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

using namespace deformvolume;

struct dv_chainmail
{
  ChainMailModel Model;
  ImageGeometry Volume;
  std::shared_ptr<DeviceVectors> Displacements;
  std::string Device;
};

namespace
{

constexpr std::size_t MostMaterials = 256;

ChainMailModel& GetModel(dv_chainmail* chainmail)
{
  CheckPointer(chainmail, "The ChainMail");
  return chainmail->Model;
}

// Values of voxels in memory.
template <typename T>
struct Values
{
  const T* First;
  const T* Last;
  const T* begin() const { return this->First; }
  const T* end() const { return this->Last; }
};

// Throws an Error if a voxel has no material.
std::vector<unsigned char> ReadMaterials(
  const VolumeArray& array, std::int64_t voxels, const MaterialRule& rule)
{
  std::vector<unsigned char> materials(static_cast<std::size_t>(voxels));
  std::atomic<std::int64_t> without{ std::numeric_limits<std::int64_t>::max() };
  ParallelFor(0, voxels, 0,
    [&](std::int64_t first, std::int64_t last)
    {
      std::int64_t found = -1;
      DispatchElementType(array.Type,
        [&](auto zero)
        {
          using T = decltype(zero);
          const auto* data = static_cast<const T*>(array.Data);
          found = WriteMaterials(Values<T>{ data + first, data + last }, rule, &materials[first]);
        });
      if (found >= 0)
      {
        Lower(without, first + found);
      }
    });
  if (without != std::numeric_limits<std::int64_t>::max())
  {
    throw Error("Voxel " + std::to_string(without.load()) +
      " has a value for which there is no material. Give a table with that material, or the voxel "
      "another value.");
  }
  return materials;
}

void CheckMaterial(double index, const std::vector<ChainMailMaterial>& table, const char* who)
{
  if (!(index >= 0.0 && index < static_cast<double>(table.size()) && index == std::floor(index)))
  {
    throw Error(std::string(who) + " is " + FormatNumber(index) + ", but there are " +
      std::to_string(table.size()) + " materials, from 0 on. Give the number of one.");
  }
}

void SetMaterials(dv_chainmail& chainmail, const dv_chainmail_materials& given)
{
  std::vector<ChainMailMaterial> table(
    DefaultChainMailMaterials.begin(), DefaultChainMailMaterials.end());
  if (given.table)
  {
    const std::size_t count =
      GetProduct(given.number_of_materials, 3 * sizeof(double), "materials");
    if (count < 1 || count > MostMaterials)
    {
      throw Error("The table has " + std::to_string(count) + " materials. Give 1 to 256.");
    }
    table.clear();
    for (std::size_t i = 0; i < count; ++i)
    {
      const double* limits = given.table + 3 * i;
      table.push_back({ limits[0], limits[1], limits[2] });
    }
  }
  ChainMailModel::CheckMaterials(table);
  MaterialRule rule;
  std::fill_n(rule.Exists.begin(), table.size(), true);
  CheckMaterial(given.default_material, table, "The default material");
  rule.Fallback = given.default_material;
  const std::size_t ranges =
    GetProduct(given.number_of_ranges, 3 * sizeof(double), "ranges of values");
  if (ranges > 0)
  {
    CheckPointer(given.ranges, "The list of ranges");
    CheckPointer(given.values, "The array of values that the ranges are for");
  }
  for (std::size_t i = 0; i < ranges; ++i)
  {
    const double* range = given.ranges + 3 * i;
    CheckMaterial(range[2], table, ("The material of range " + std::to_string(i)).c_str());
    rule.Ranges.push_back({ range[0], range[1], static_cast<int>(range[2]) });
  }
  const std::int64_t voxels = GetNumberOfPoints(chainmail.Volume.PointExtent);
  if (!given.values)
  {
    const std::vector<unsigned char> materials(
      static_cast<std::size_t>(voxels), static_cast<unsigned char>(rule.Fallback));
    chainmail.Model.SetMaterials(table, materials.data());
    return;
  }
  const VolumeArray array = MakeScalars(given.values, "values");
  chainmail.Model.SetMaterials(table, ReadMaterials(array, voxels, rule).data());
}

} // namespace

std::int32_t dv_chainmail_create(
  const dv_grid* grid, const char* device, std::uint64_t memory_limit, dv_chainmail** chainmail)
{
  return Call(
    [&]
    {
      CheckPointer(chainmail, "The place for the ChainMail");
      *chainmail = nullptr;
      auto made = std::make_unique<dv_chainmail>();
      made->Volume = MakeGeometry(grid, "the volume");
      CheckVolume(made->Volume);
      made->Device = made->Model.SetDevice(device ? device : "");
      made->Model.SetMemoryLimit(memory_limit);
      made->Model.SetVoxelGrid(made->Volume.PointExtent, GetVoxelMatrix(made->Volume));
      made->Displacements = std::make_shared<DeviceVectors>(
        made->Device, static_cast<std::size_t>(GetNumberOfPoints(made->Volume.PointExtent)));
      made->Model.SetOutput(made->Displacements);
      dv_chainmail_materials materials = {};
      materials.default_material = DefaultChainMailMaterial;
      SetMaterials(*made, materials);
      *chainmail = made.release();
    });
}

void dv_chainmail_destroy(dv_chainmail* chainmail)
{
  Call([&] { delete chainmail; });
}

std::int32_t dv_chainmail_set_materials(
  dv_chainmail* chainmail, const dv_chainmail_materials* materials)
{
  return Call(
    [&]
    {
      GetModel(chainmail);
      SetMaterials(*chainmail, ReadStruct(materials, "the materials"));
    });
}

std::int32_t dv_chainmail_set_pinned(dv_chainmail* chainmail, const std::uint8_t* pinned)
{
  return Call([&] { GetModel(chainmail).SetPinned(pinned); });
}

std::int32_t dv_chainmail_set_active_tetrahedra(
  dv_chainmail* chainmail, const std::uint8_t* active, const std::uint8_t* crossed)
{
  return Call(
    [&]
    {
      ChainMailModel& model = GetModel(chainmail);
      if (!crossed)
      {
        model.SetActiveTetrahedra(active);
        return;
      }
      const auto cells = static_cast<std::size_t>(GetNumberOfCells(chainmail->Volume.PointExtent));
      model.SetActiveTetrahedra(SwitchOffCrossed(active, crossed, cells).data());
    });
}

std::int32_t dv_chainmail_step(
  dv_chainmail* chainmail, const dv_chainmail_request* given, dv_chainmail_report* report)
{
  return Call(
    [&]
    {
      ChainMailModel& model = GetModel(chainmail);
      const dv_chainmail_request wanted = ReadStruct(given, "the request");
      if (report)
      {
        CheckStruct(report, "the report");
      }
      if (wanted.relaxation_sweeps < 0)
      {
        throw Error("There are " + std::to_string(wanted.relaxation_sweeps) +
          " sweeps of relaxation. Set 0 or more.");
      }
      ChainMailRequest request;
      request.Handles = MakeHandles(chainmail->Volume,
        ReadPoints(
          wanted.rest_positions, DV_FLOAT64, wanted.number_of_handles, "rest positions of handles"),
        ReadPoints(wanted.positions, DV_FLOAT64, wanted.number_of_handles, "positions of handles"),
        wanted.handle_radius);
      request.RelaxationSweeps = wanted.relaxation_sweeps;
      request.Elasticity = wanted.elasticity;
      request.PlasticityThreshold = wanted.plasticity_threshold;
      if (wanted.progress)
      {
        // The number of rounds is not known in advance.
        request.Progress = [progress = MakeProgress(wanted.progress, wanted.user)]
        { return progress(0.0); };
      }
      const ChainMailReport done = model.Step(request);
      if (report)
      {
        dv_chainmail_report made = {};
        made.number_of_sweeps = done.NumberOfSweeps;
        made.number_of_moved_voxels = done.NumberOfMovedVoxels;
        made.largest_violation = done.LargestViolation;
        made.number_of_reduced_handles = done.CountReducedHandles();
        made.number_of_released_handles = done.CountReleasedHandles();
        made.was_reset = done.WasReset ? 1 : 0;
        std::copy_n(done.ChangedExtent.begin(), 6, made.changed_extent);
        WriteStruct(made, report, "the report");
      }
    });
}

std::int32_t dv_chainmail_reset(dv_chainmail* chainmail)
{
  return Call([&] { GetModel(chainmail).Reset(); });
}

std::int32_t dv_chainmail_displacements(dv_chainmail* chainmail, const float** displacements)
{
  return Call(
    [&]
    {
      GetModel(chainmail);
      CheckPointer(displacements, "The place for the displacements");
      *displacements = chainmail->Displacements->Read();
    });
}

std::int32_t dv_chainmail_device_memory(const dv_chainmail* chainmail, std::uint64_t* bytes)
{
  return Call(
    [&]
    {
      CheckPointer(chainmail, "The ChainMail");
      CheckPointer(bytes, "The place for the number of bytes");
      *bytes = chainmail->Model.GetDeviceMemory() + chainmail->Displacements->GetDeviceMemory();
    });
}

const char* dv_chainmail_device(const dv_chainmail* chainmail)
{
  const char* name = nullptr;
  Call(
    [&]
    {
      CheckPointer(chainmail, "The ChainMail");
      name = chainmail->Device.c_str();
    });
  return name;
}

std::int32_t dv_set_chainmail(dv_deformer* deformer, const dv_chainmail* chainmail)
{
  return Call(
    [&]
    {
      WorldDeformer& world = GetDeformer(deformer);
      CheckPointer(chainmail, "The ChainMail");
      world.SetField(chainmail->Volume, chainmail->Displacements);
    });
}
