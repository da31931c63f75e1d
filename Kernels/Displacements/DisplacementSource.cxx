// SPDX-License-Identifier: BSD-3-Clause
#include "DisplacementSource.h"

#include "BoxBounds.h"
#include "BrickPoints.h"
#include "ChangeTracker.h"
#include "DeviceVolume.h"
#include "Error.h"
#include "FieldParameters.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "KernelText.h"
#include "MeshChecks.h"
#include "WorkDevice.h"

#include <algorithm>
#include <string>

namespace deformvolume
{
namespace
{

std::uint64_t GetBytes(const DisplacementField& field)
{
  return static_cast<std::uint64_t>(GetNumberOfPoints(field)) * 3 * sizeof(float);
}

bool HasSameDimensions(const FieldParameters& a, const FieldParameters& b)
{
  return std::equal(a.Dimensions, a.Dimensions + 3, b.Dimensions);
}

// Whether two fields have the same map from voxels to points.
bool IsSameMapping(const FieldParameters& a, const FieldParameters& b)
{
  return std::equal(a.IndexToField, a.IndexToField + 12, b.IndexToField) &&
    HasSameDimensions(a, b) && a.Extrapolate == b.Extrapolate &&
    std::equal(a.Fading, a.Fading + 3, b.Fading);
}

bool HasSameMatrix(const FieldParameters& a, const FieldParameters& b)
{
  return std::equal(a.ToDisplacement, a.ToDisplacement + 18, b.ToDisplacement);
}

// Returns the smallest range that contains ranges of points, of `count` points.
std::array<std::size_t, 2> GetHull(const PointRanges& ranges, std::size_t count)
{
  std::array<std::size_t, 2> hull{ { count, 0 } };
  for (const auto& range : ranges)
  {
    hull[0] = std::min(hull[0], range[0]);
    hull[1] = std::max(hull[1], std::min(range[1], count));
  }
  return hull;
}

} // namespace

DisplacementSource::DisplacementSource(
  WorkDevice& device, DeviceVolume& volume, ChangeTracker& tracker)
  : Device(device)
  , Volume(volume)
  , Tracker(tracker)
  , Nodes(device, tracker)
  , FieldVectors(device, tracker)
  , Converter(device)
{
}

void DisplacementSource::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexLink* links)
{
  this->Volume.SetLinks(links);
  this->SendTetrahedra(tetrahedra, numberOfTetrahedra, numberOfNodes);
}

void DisplacementSource::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexRuns& runs)
{
  this->Volume.SetRuns(runs);
  this->SendTetrahedra(tetrahedra, numberOfTetrahedra, numberOfNodes);
}

void DisplacementSource::SendTetrahedra(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  this->NumberOfTetrahedra = numberOfTetrahedra;
  this->Device.Send(this->Tetrahedra, GetNodeOffsets(tetrahedra, numberOfTetrahedra));
  this->NumberOfNodes = numberOfNodes;
  this->MaxNumberOfNodes = numberOfNodes;
  if (this->Nodes.GetNumberOfPoints() != numberOfNodes)
  {
    this->Nodes.Clear();
  }
  this->NodesSet = false;
  this->DeviceIsCurrent = false;
  this->ForgetField();
  this->Tracker.InvalidateMapping();
}

bool DisplacementSource::HasMesh() const
{
  return this->Volume.HasMesh();
}

void DisplacementSource::SetCoincidentNodes(const std::int32_t* numbers)
{
  if (numbers && !this->HasMesh())
  {
    throw Error("SetCoincidentNodes() needs a deformation mesh. Call SetMesh() first.");
  }
  std::vector<std::int32_t> all;
  if (numbers)
  {
    // Removed nodes have no common position with other nodes.
    all.assign(numbers, numbers + this->NumberOfNodes);
    all.resize(this->MaxNumberOfNodes, -1);
  }
  this->Volume.GetMasks().SetCoincidentNodes(all);
}

std::vector<Extent> DisplacementSource::UpdateResampledMask()
{
  return this->Volume.UpdateResampledMask(this->GetMappingKind(), this->Tetrahedra,
    [this](cl::Kernel& kernel, const VolumeChunk& chunk)
    { return this->SetMappingArguments(kernel, chunk); });
}

void DisplacementSource::SetNodeDisplacements(
  const float* displacements, const PointRanges* changes, bool areChecked)
{
  this->Converter.Forget();
  this->SendNodes(displacements, changes, areChecked);
}

void DisplacementSource::SetNodeDisplacements(
  const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement)
{
  DisplacementField field;
  field.ToDisplacement = toDisplacement;
  const std::optional<PointRanges> changes =
    this->Converter.Begin(vectors, field, this->NumberOfNodes);
  if (!this->Converter.CanConvert(field))
  {
    this->SendNodes(
      this->Converter.GetDisplacements(changes), changes ? &*changes : nullptr, false);
    return;
  }
  if (this->NodesSet && this->DeviceIsCurrent && changes && changes->empty())
  {
    return;
  }
  this->NodesSet = false;
  this->Converter.Convert(this->Nodes.AllocateForKernel(this->MaxNumberOfNodes), "node");
  this->NodesSet = true;
  this->DeviceIsCurrent = true;
  this->Volume.GetRecords().Invalidate();
}

void DisplacementSource::SendNodes(
  const float* displacements, const PointRanges* changes, bool areChecked)
{
  const PointRanges* validChanges = this->NodesSet && this->DeviceIsCurrent ? changes : nullptr;
  this->DeviceIsCurrent = false;
  if (!areChecked)
  {
    CheckDisplacements(displacements, this->NumberOfNodes, "node", validChanges);
  }
  this->Nodes.Set(displacements, this->NumberOfNodes, this->MaxNumberOfNodes, validChanges,
    [this] { return this->MakeBrickPoints(); });
  this->NodesSet = true;
  this->DeviceIsCurrent = true;
  this->Volume.GetRecords().Invalidate();
}

void DisplacementSource::SetField(const DisplacementField& field, const PointRanges* changes)
{
  if (static_cast<std::size_t>(GetNumberOfPoints(field)) < VectorConverter::MinPoints ||
    !this->Converter.CanConvert(field))
  {
    this->Converter.Forget();
    this->SetFieldOnHost(field, changes);
    return;
  }
  const PointRanges* validChanges = this->DeviceIsCurrent ? changes : nullptr;
  this->ConvertFieldOnDevice(field, validChanges,
    [&](const cl::Buffer& displacements, bool partly)
    {
      const std::array<std::size_t, 2> range = partly
        ? GetHull(*validChanges, this->NumberOfNodes)
        : std::array<std::size_t, 2>{ { 0, this->NumberOfNodes } };
      this->Converter.Convert(field, range, displacements, "point");
    });
  this->DeviceIsCurrent = true;
}

void DisplacementSource::SetField(
  const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors)
{
  const auto points = static_cast<std::size_t>(GetNumberOfPoints(field));
  const std::optional<PointRanges> changes = this->Converter.Begin(vectors, field, points);
  if (!this->Converter.CanConvert(field))
  {
    this->Converter.Check(changes, "point"); // vectors that are read in place are not checked later
    DisplacementField read = field;
    read.Vectors = vectors->Read();
    read.Owner = vectors;
    this->SetFieldOnHost(read, changes ? &*changes : nullptr);
    return;
  }
  this->ConvertFieldOnDevice(field, changes ? &*changes : nullptr,
    [this](const cl::Buffer& displacements, bool)
    { this->Converter.Convert(displacements, "point"); });
}

void DisplacementSource::ConvertFieldOnDevice(const DisplacementField& field,
  const PointRanges* changes, const std::function<void(const cl::Buffer&, bool)>& convert)
{
  const FieldParameters parameters = this->PrepareForField(field);
  this->CheckFieldSize();
  const bool hasRoom = this->FieldVectors.GetNumberOfPoints() == this->NumberOfNodes;
  const bool isSame = this->IsConverted && hasRoom && IsSameMapping(parameters, this->Field) &&
    HasSameMatrix(parameters, this->Field);
  if (this->FieldInPlace.Owner || !hasRoom)
  {
    this->ForgetField();
  }
  this->Field = parameters;
  this->DeviceIsCurrent = false;
  this->WrittenInPart = isSame && changes;
  this->BoundsOfSubBricks.clear();
  try
  {
    if (!this->WrittenInPart)
    {
      convert(this->FieldVectors.AllocateForKernel(this->NumberOfNodes), false);
      this->IsConverted = true;
      return;
    }
    convert(this->FieldVectors.Get(), true);
    if (!this->NotifyOfChanges(*changes, [this] { return Join(this->FindBoundsOfSubBricks()); }))
    {
      this->Tracker.MoveAll({});
    }
  }
  catch (...)
  {
    this->ForgetField();
    this->Tracker.MoveAll({});
    throw;
  }
}

const std::vector<DisplacementBounds>& DisplacementSource::FindBoundsOfSubBricks() const
{
  if (this->BoundsOfSubBricks.empty())
  {
    const std::array<int, 3> size{ { this->Field.Dimensions[0], this->Field.Dimensions[1],
      this->Field.Dimensions[2] } };
    this->BoundsOfSubBricks = FindBoxBounds(
      this->Device, this->FieldVectors.Get(), size, this->MakeBrickPoints().GetBoxes());
  }
  return this->BoundsOfSubBricks;
}

FieldParameters DisplacementSource::PrepareForField(const DisplacementField& field)
{
  const FieldParameters parameters = MakeFieldParameters(field, this->Volume.GetVoxelGrid());
  if (this->Volume.HasMesh())
  {
    this->Volume.ForgetMesh();
  }
  this->ForgetNodes();
  this->NumberOfNodes = static_cast<std::size_t>(GetNumberOfPoints(field));
  if (!this->HasField() || !IsSameMapping(parameters, this->Field))
  {
    this->Tracker.InvalidateMapping();
    this->Volume.InvalidateState();
  }
  return parameters;
}

void DisplacementSource::SetFieldOnHost(const DisplacementField& field, const PointRanges* changes)
{
  this->IsConverted = false;
  const FieldParameters parameters = this->PrepareForField(field);
  if (this->CanReadInPlace(field, parameters))
  {
    const DisplacementField& last = this->FieldInPlace;
    const bool isSame = last.Owner && last.Vectors == field.Vectors &&
      last.ToDisplacement == field.ToDisplacement && IsSameMapping(parameters, this->Field);
    this->Field = parameters;
    this->WrittenInPart = isSame && changes;
    if (!this->WrittenInPart || !this->UpdateFieldInPlace(field, *changes))
    {
      this->SetFieldInPlace(field);
    }
    return;
  }
  if (this->FieldInPlace.Owner)
  {
    this->ForgetField();
  }
  this->UploadField(field, parameters, changes);
}

void DisplacementSource::CheckFieldSize() const
{
  CheckAllocation(4 * this->NumberOfNodes * sizeof(float), this->Device.GetAllocationLimit(),
    "The vectors of the displacement field", "Use a coarser field");
}

void DisplacementSource::UploadField(
  const DisplacementField& field, const FieldParameters& parameters, const PointRanges* changes)
{
  const std::size_t points = this->NumberOfNodes;
  const PointRanges* validChanges = this->DeviceIsCurrent &&
      this->FieldVectors.GetNumberOfPoints() == points &&
      HasSameDimensions(parameters, this->Field) && HasSameMatrix(parameters, this->Field)
    ? changes
    : nullptr;
  this->DeviceIsCurrent = false;
  const std::vector<float> displacements =
    parameters.IsMapped ? MapVectors(field) : std::vector<float>();
  const float* vectors = parameters.IsMapped ? displacements.data() : field.Vectors;
  CheckDisplacements(vectors, points, "point", validChanges);
  this->CheckFieldSize();
  if (this->FieldVectors.GetNumberOfPoints() != points)
  {
    this->FieldVectors.Clear();
  }
  this->Field = parameters;
  this->FieldVectors.Set(
    vectors, points, points, validChanges, [this] { return this->MakeBrickPoints(); });
  this->DeviceIsCurrent = true;
}

bool DisplacementSource::CanReadInPlace(
  const DisplacementField& field, const FieldParameters& parameters) const
{
  const OpenCLContext& context = this->Device.GetContext();
  if (!field.Owner || !parameters.SameGrid || !HasDouble(context) ||
    !CanWorkInPlace(context, field.Vectors, sizeof(float)) ||
    GetBytes(field) > this->Device.GetAllocationLimit())
  {
    return false;
  }
  // The field may also be an array of the volume. The buffer of the array can be shared if the
  // volume is one chunk.
  const BufferInPlace array =
    this->Volume.GetArrays().FindOverlapping(field.Vectors, GetBytes(field));
  return array.Bytes == 0 ||
    (array.IsOver(field.Vectors, GetBytes(field)) && this->Volume.GetChunks().size() == 1);
}

bool DisplacementSource::UpdateFieldInPlace(
  const DisplacementField& field, const PointRanges& changes)
{
  const auto after = [&]
  {
    DisplacementBounds bounds;
    for (const auto& range : changes)
    {
      const std::size_t end = std::min(range[1], this->NumberOfNodes);
      if (range[0] < end)
      {
        bounds.Add({ nullptr, &field, nullptr }, range[0], end);
      }
    }
    return bounds;
  };
  if (!this->NotifyOfChanges(changes, after))
  {
    return false;
  }
  this->FieldInPlace = field;
  return true;
}

bool DisplacementSource::NotifyOfChanges(
  const PointRanges& changes, const std::function<DisplacementBounds()>& after)
{
  std::size_t count = 0;
  for (const auto& range : changes)
  {
    count += std::min(range[1], this->NumberOfNodes) - std::min(range[0], this->NumberOfNodes);
  }
  if (count > this->Tracker.GetMaxMoved(this->NumberOfNodes))
  {
    this->WrittenInPart = false;
    return false;
  }
  if (!this->Tracker.IsTracking() || !this->Tracker.HasAllBoxes())
  {
    return false;
  }
  if (count > 0)
  {
    PointSet changed;
    changed.Clear(this->NumberOfNodes);
    for (const auto& range : changes)
    {
      changed.AddRange(range[0], std::min(range[1], this->NumberOfNodes));
    }
    this->Tracker.MovePoints(changed, nullptr);
    this->Tracker.AddMoved(after());
  }
  return true;
}

void DisplacementSource::SetFieldInPlace(const DisplacementField& field)
{
  this->Tracker.MoveAll({});
  this->DeviceIsCurrent = false;
  this->FieldVectors.Clear();
  const BufferInPlace array =
    this->Volume.GetArrays().FindOverlapping(field.Vectors, GetBytes(field));
  this->VectorsInPlace = array.Buffer; // release the last buffer, which may use the same memory
  if (!array.Buffer())
  {
    // The kernels only read the vectors.
    this->VectorsInPlace = MakeBufferOver(this->Device.GetContext(), CL_MEM_READ_ONLY,
      const_cast<float*>(field.Vectors), GetBytes(field));
  }
  this->FieldInPlace = field; // release the last owner after the buffer that used its memory
}

BufferInPlace DisplacementSource::GetFieldInPlace() const
{
  return this->FieldInPlace.Owner ? BufferInPlace{ this->FieldInPlace.Vectors,
    GetBytes(this->FieldInPlace), this->VectorsInPlace }
                                  : BufferInPlace();
}

void DisplacementSource::RereadField() const
{
  UpdateFromHost(this->Device.GetContext(), this->Device.GetQueue(), this->GetFieldInPlace());
}

void DisplacementSource::ForgetNodes()
{
  this->Tetrahedra = cl::Buffer();
  this->Nodes.Clear();
  this->NumberOfTetrahedra = 0;
  this->NumberOfNodes = 0;
  this->MaxNumberOfNodes = 0;
  this->NodesSet = false;
}

void DisplacementSource::ForgetField()
{
  this->FieldVectors.Clear();
  this->IsConverted = false;
  this->BoundsOfSubBricks.clear();
  this->VectorsInPlace = cl::Buffer();
  this->FieldInPlace = DisplacementField();
}

void DisplacementSource::Forget()
{
  this->Volume.ForgetMesh();
  this->ForgetNodes();
  this->ForgetField();
  this->Converter.Forget();
  this->Tracker.InvalidateMapping();
}

const cl::Buffer& DisplacementSource::GetFieldVectors() const
{
  return this->FieldInPlace.Owner ? this->VectorsInPlace : this->FieldVectors.Get();
}

bool DisplacementSource::IsReady() const
{
  return (this->Volume.HasMesh() && this->NodesSet) || this->HasField();
}

MappingKind DisplacementSource::GetMappingKind() const
{
  return this->Volume.HasRuns() ? MappingKind::Runs
    : this->Volume.HasMesh()    ? MappingKind::Links
    : this->FieldInPlace.Owner  ? MappingKind::FieldInPlace
                                : MappingKind::Field;
}

cl_uint DisplacementSource::SetMappingArguments(cl::Kernel& kernel, const VolumeChunk& chunk) const
{
  const cl::Buffer& rest = this->Volume.GetRestPositions();
  switch (this->GetMappingKind())
  {
    case MappingKind::Runs:
      return SetArguments(
        kernel, 0, chunk.Runs, chunk.RowRanges, this->Volume.GetRecords().Get(), rest);
    case MappingKind::Links:
      return SetArguments(kernel, 0, chunk.Links, this->Tetrahedra, this->Nodes.Get(), rest);
    default:
      return SetArguments(kernel, 0, this->GetFieldVectors(), this->Field, rest);
  }
}

cl_uint DisplacementSource::SetPointArguments(cl::Kernel& kernel, cl_uint argument) const
{
  const bool mesh = this->HasMesh();
  cl_int4 dimensions = { { 0, 0, 0, 0 } };
  for (int axis = 0; axis < 3 && !mesh; ++axis)
  {
    dimensions.s[axis] = this->Field.Dimensions[axis];
  }
  return SetArguments(kernel, argument, this->Tetrahedra,
    mesh ? this->Nodes.Get() : this->FieldVectors.Get(), dimensions);
}

cl::Event DisplacementSource::PrepareMapping(const std::vector<cl_uint>* bricks)
{
  const cl::Program mapping = GetMappingProgram(this->Device.GetContext(), this->GetMappingKind(),
    this->Volume.GetMasks().HasCut(), this->Volume.HasTurnedAxes());
  TetrahedronRecords& records = this->Volume.GetRecords();
  cl::Event launched;
  if (this->Volume.HasRuns() && !records.AreCurrent())
  {
    launched = records.Evaluate(mapping, this->Tetrahedra, this->Nodes.Get());
  }
  const auto set = [this](cl::Kernel& kernel, const VolumeChunk& chunk)
  { return this->SetMappingArguments(kernel, chunk); };
  this->Volume.UpdateState(mapping, this->Field.Extrapolate || this->Field.SameGrid, set);
  this->Volume.UpdateCut(mapping, bricks, set);
  return launched;
}

BrickPoints DisplacementSource::MakeBrickPoints() const
{
  return this->Volume.HasMesh()
    ? this->Volume.MakeBrickPoints(this->Tetrahedra, this->MaxNumberOfNodes)
    : this->Volume.MakeBrickPoints(this->Field);
}

void DisplacementSource::WithDisplacements(
  const std::function<void(const Displacements&, std::size_t)>& visit) const
{
  if (this->GetMappingKind() == MappingKind::FieldInPlace)
  {
    visit({ nullptr, &this->FieldInPlace, nullptr },
      static_cast<std::size_t>(GetNumberOfPoints(this->FieldInPlace)));
    return;
  }
  if (this->IsConverted)
  {
    visit({ nullptr, nullptr, &this->FindBoundsOfSubBricks() }, this->NumberOfNodes);
    return;
  }
  const DisplacementBuffer& buffer = this->Volume.HasMesh() ? this->Nodes : this->FieldVectors;
  buffer.WithDisplacements(
    [&](const float* vectors) {
      visit({ vectors, nullptr, nullptr }, buffer.GetNumberOfPoints());
    });
}

std::uint64_t DisplacementSource::GetMemory() const
{
  return this->Converter.GetMemory() +
    deformvolume::GetMemory(this->Tetrahedra, this->Nodes.Get(), this->FieldVectors.Get());
}

} // namespace deformvolume
