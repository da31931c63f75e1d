// SPDX-License-Identifier: BSD-3-Clause
// The part of DisplacementSource that applies changes of the nodes of tetrahedra.
#include "DisplacementSource.h"

#include "ChangeTracker.h"
#include "DeviceVolume.h"
#include "Error.h"
#include "HostMemory.h"
#include "MeshChecks.h"
#include "WorkDevice.h"

#include <algorithm>
#include <optional>
#include <string>

namespace deformvolume
{

std::vector<TetrahedronChange> DisplacementSource::FindChanges(const Tetrahedron* tetrahedra) const
{
  const MappedBuffer<const Tetrahedron> offsets(
    this->Device.GetQueue(), this->Tetrahedra, CL_MAP_READ);
  std::vector<TetrahedronChange> changes;
  for (std::size_t t = 0; t < this->NumberOfTetrahedra; ++t)
  {
    TetrahedronChange change;
    change.Number = static_cast<std::int32_t>(t);
    const Tetrahedron& last = offsets.Get()[t];
    std::transform(last.begin(), last.end(), change.Before.begin(),
      [](std::int32_t offset) { return offset / DEFORMVOLUME_NODE_STRIDE; });
    change.After = tetrahedra[t];
    if (change.After != change.Before)
    {
      changes.push_back(change);
    }
  }
  return changes;
}

void DisplacementSource::CheckChanges(
  const std::vector<TetrahedronChange>& changes, std::size_t numberOfNodes) const
{
  const auto areNodes = [](const Tetrahedron& tetrahedron, std::size_t count)
  {
    return std::all_of(tetrahedron.begin(), tetrahedron.end(),
      [=](std::int32_t node) { return node >= 0 && static_cast<std::size_t>(node) < count; });
  };
  for (const TetrahedronChange& change : changes)
  {
    const std::string name = "tetrahedron " + std::to_string(change.Number);
    if (change.Number < 0 || static_cast<std::size_t>(change.Number) >= this->NumberOfTetrahedra)
    {
      throw Error("The nodes of " + name + " cannot be changed: the mesh has only " +
        std::to_string(this->NumberOfTetrahedra) + " tetrahedra.");
    }
    if (!areNodes(change.After, numberOfNodes) || !areNodes(change.Before, this->MaxNumberOfNodes))
    {
      throw Error("The change of the nodes of " + name +
        " refers to a node that does not exist: the mesh has " + std::to_string(numberOfNodes) +
        " nodes, and had at most " + std::to_string(this->MaxNumberOfNodes) + " before.");
    }
  }
}

void DisplacementSource::SendChanges(const std::vector<TetrahedronChange>& changes)
{
  const cl::CommandQueue& queue = this->Device.GetQueue();
  if (this->Device.GetDevice().IsProcessor)
  {
    const MappedBuffer<Tetrahedron> sent(queue, this->Tetrahedra, CL_MAP_READ | CL_MAP_WRITE);
    for (const TetrahedronChange& change : changes)
    {
      sent.Get()[change.Number] = GetNodeOffsets(change.After);
    }
    return;
  }
  std::vector<Tetrahedron> offsets;
  offsets.reserve(changes.size()); // the copies in progress use the addresses of elements
  PendingCopies writes;
  for (const TetrahedronChange& change : changes)
  {
    offsets.push_back(GetNodeOffsets(change.After));
    writes.Add(BeginToWrite(queue, this->Tetrahedra,
      static_cast<std::size_t>(change.Number) * sizeof(Tetrahedron), sizeof(Tetrahedron),
      &offsets.back()));
  }
  writes.Check();
}

void DisplacementSource::ChangeConnectivity(const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes,
  const std::vector<TetrahedronChange>* changes)
{
  if (!this->HasMesh() || numberOfTetrahedra != this->NumberOfTetrahedra || numberOfNodes == 0)
  {
    throw Error("The connectivity cannot be changed to that of a mesh with " +
      std::to_string(numberOfTetrahedra) + " tetrahedra and " + std::to_string(numberOfNodes) +
      " nodes: the mesh that is set has " + std::to_string(this->NumberOfTetrahedra) +
      " tetrahedra. Call SetMesh() instead.");
  }
  std::vector<TetrahedronChange> found;
  if (!changes)
  {
    found = this->FindChanges(tetrahedra);
    changes = &found;
  }
  this->CheckChanges(*changes, numberOfNodes);
  this->SetNumberOfNodes(numberOfNodes);
  std::optional<std::vector<Extent>> boxes;
  if (this->Tracker.HasPoints())
  {
    this->Nodes.WithDisplacements(
      [&](const float* last) { boxes = this->Tracker.ChangeTetrahedra(*changes, last); });
  }
  this->SendChanges(*changes);
  if (boxes)
  {
    this->Volume.GetMasks().GetResampledMask().ChangeVertices(*boxes);
  }
  else
  {
    this->Volume.GetMasks().GetResampledMask().Invalidate();
  }
  this->Volume.GetRecords().Invalidate();
}

void DisplacementSource::SetNumberOfNodes(std::size_t numberOfNodes)
{
  this->MaxNumberOfNodes = std::max(this->MaxNumberOfNodes, numberOfNodes);
  this->Nodes.Grow(numberOfNodes);
  if (this->Tracker.IsTracking())
  {
    if (!this->Tracker.HasPoints())
    {
      this->Tracker.SetPoints(this->MakeBrickPoints());
    }
    // Add the bounds of new nodes here. If the displacement of a new node equals the value in the
    // buffer, the node does not count as changed later.
    DisplacementBounds bounds;
    this->Nodes.WithDisplacements(
      [&](const float* last)
      {
        if (this->NumberOfNodes < numberOfNodes)
        {
          bounds.Add(last, this->NumberOfNodes, numberOfNodes);
        }
      });
    this->Tracker.AddMoved(bounds);
  }
  this->NumberOfNodes = numberOfNodes;
}

} // namespace deformvolume
