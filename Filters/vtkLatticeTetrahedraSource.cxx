// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLatticeTetrahedraSource.h"

#include "Error.h"
#include "FiveTetrahedra.h"
#include "IsAborted.h"
#include "PieceRequest.h"
#include "PipelineExecution.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnstructuredGrid.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <sstream>
#include <string>

using deformvolume::Error;
using deformvolume::FiveTetrahedra;

vtkStandardNewMacro(vtkLatticeTetrahedraSource);

namespace
{

// Corner and edge vectors from node to node, in world coordinates.
struct Lattice
{
  std::array<int, 3> Nodes{}; // their number on each axis
  glm::dvec3 Corner = glm::dvec3(0.0);
  glm::dmat3 Steps = glm::dmat3(0.0);

  void SetBounds(const double bounds[6], double margin)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double low = bounds[2 * axis] - margin;
      const double high = bounds[2 * axis + 1] + margin;
      if (!std::isfinite(low) || !std::isfinite(high) || !std::isfinite(high - low))
      {
        throw Error("Bounds are not finite. Set Bounds to a finite box or connect a volume.");
      }
      if (bounds[2 * axis + 1] <= bounds[2 * axis])
      {
        throw Error(
          "Bounds are empty: the maximum has to be greater than the minimum on every axis.");
      }
      this->Corner[axis] = low;
      this->Steps[axis][axis] = (high - low) / (this->Nodes[axis] - 1);
    }
  }

  void SetVolume(vtkImageData* volume, const std::array<int, 6>& extent, double margin)
  {
    const double* spacing = volume->GetSpacing();
    const double* origin = volume->GetOrigin();
    vtkMatrix3x3* direction = volume->GetDirectionMatrix();
    this->Corner = glm::dvec3(origin[0], origin[1], origin[2]);
    for (int axis = 0; axis < 3; ++axis)
    {
      const int first = extent[2 * axis];
      const int last = extent[2 * axis + 1];
      if (last <= first)
      {
        throw Error("The volume has fewer than two voxels on axis " + std::to_string(axis) +
          ". A lattice of a volume needs two on every axis; set Bounds and disconnect the volume "
          "(in ParaView, take the source Tetrahedral Lattice) to mesh a box of your own.");
      }
      const glm::dvec3 unit(direction->GetElement(0, axis), direction->GetElement(1, axis),
        direction->GetElement(2, axis));
      const glm::dvec3 voxel = unit * spacing[axis];
      const double length = glm::length(voxel);
      if (!(length > 0.0) || !std::isfinite(length))
      {
        throw Error("The volume's spacing or direction matrix is not valid on axis " +
          std::to_string(axis) + ".");
      }
      const double border = margin / length;
      this->Corner += voxel * (first - border);
      this->Steps[axis] = voxel * ((last - first + 2.0 * border) / (this->Nodes[axis] - 1));
    }
  }

  // Makes the cells cubes, which changes the number of nodes.
  void MakeCubes()
  {
    // Rounding errors must not add a cell.
    constexpr double tolerance = 1e-9;
    double edge = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      edge = std::max(edge, glm::length(this->Steps[axis]));
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      glm::dvec3& step = this->Steps[axis];
      const double length = glm::length(step);
      if (length < edge * (1.0 - tolerance))
      {
        const double needed = (this->Nodes[axis] - 1) * length / edge;
        const double cells = std::max(1.0, std::ceil(needed * (1.0 - tolerance)));
        step *= edge / length;
        this->Corner -= step * (0.5 * std::max(0.0, cells - needed));
        this->Nodes[axis] = static_cast<int>(cells) + 1;
      }
    }
  }
};

// Whether the memory of the output can be allocated. If the arrays failed to allocate, their
// message would not say what to do.
bool CanAllocate(double bytes)
{
  if (bytes > static_cast<double>(std::numeric_limits<std::ptrdiff_t>::max()))
  {
    return false;
  }
  void* memory = ::operator new(static_cast<std::size_t>(bytes), std::nothrow);
  ::operator delete(memory);
  return memory != nullptr;
}

// Returns the number of tetrahedra. Throws an Error if they cannot be stored.
vtkIdType CountTetrahedra(const std::array<int, 3>& nodes)
{
  const double nodeCount = 1.0 * nodes[0] * nodes[1] * nodes[2];
  const double count = 5.0 * (nodes[0] - 1.0) * (nodes[1] - 1.0) * (nodes[2] - 1.0);
  const double bytes = nodeCount * 3 * sizeof(double) + count * (5 * sizeof(vtkIdType) + 1);
  if (nodeCount > VTK_INT_MAX || 4 * count > static_cast<double>(VTK_ID_MAX) || !CanAllocate(bytes))
  {
    std::ostringstream text;
    text << "A lattice of " << nodes[0] << " x " << nodes[1] << " x " << nodes[2] << " nodes takes "
         << bytes / (1024.0 * 1024.0 * 1024.0)
         << " GiB, which is more than can be stored. Use fewer nodes.";
    throw Error(text.str());
  }
  return static_cast<vtkIdType>(count);
}

// Writes the vertices of the tetrahedra of a cell. Returns the position after them.
vtkIdType* WriteCell(
  int x, int y, int z, const std::array<int, 3>& nodes, bool isMirrored, vtkIdType* vertex)
{
  const vtkIdType rowLength = nodes[0];
  const vtkIdType slabLength = rowLength * nodes[1];
  vtkIdType corners[8];
  for (int v = 0; v < 8; ++v)
  {
    const int offset = v ^ DEFORMVOLUME_MIRROR(x, y, z);
    corners[v] =
      x + (offset & 1) + rowLength * (y + (offset >> 2)) + slabLength * (z + (offset >> 1 & 1));
  }
  // Corner tetrahedra are upright in cells of even parity, the central one in the others.
  const bool cornersUpright = (((x + y + z) & 1) == 0) != isMirrored;
  for (int t = 0; t < 5; ++t)
  {
    const bool upright = (t < 4) == cornersUpright;
    *vertex++ = corners[FiveTetrahedra[t][0]];
    *vertex++ = corners[FiveTetrahedra[t][1]];
    *vertex++ = corners[FiveTetrahedra[t][upright ? 2 : 3]];
    *vertex++ = corners[FiveTetrahedra[t][upright ? 3 : 2]];
  }
  return vertex;
}

void CheckNodes(const std::array<int, 3>& nodes)
{
  if (*std::min_element(nodes.begin(), nodes.end()) < 2)
  {
    std::ostringstream text;
    text << "NumberOfNodes is " << nodes[0] << ", " << nodes[1] << ", " << nodes[2]
         << ". A lattice needs at least 2 nodes on every axis.";
    throw Error(text.str());
  }
}

// The whole extent of a volume, so that a piece of the volume gets the same lattice as all of it.
std::array<int, 6> FindWholeExtent(vtkImageData* volume, vtkInformation* info)
{
  std::array<int, 6> extent;
  volume->GetExtent(extent.data());
  if (info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
  }
  return extent;
}

// Makes the nodes and the tetrahedra of a lattice. Throws Error and Aborted.
void FillGrid(
  const Lattice& lattice, bool isMirrored, vtkAlgorithm* algorithm, vtkUnstructuredGrid* output)
{
  const std::array<int, 3>& nodes = lattice.Nodes;
  const vtkIdType numberOfTetrahedra = CountTetrahedra(nodes);
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  coordinates->SetNumberOfTuples(vtkIdType{ nodes[0] } * nodes[1] * nodes[2]);
  double* coordinate = coordinates->GetPointer(0);

  vtkNew<vtkIdTypeArray> offsets;
  offsets->SetNumberOfValues(numberOfTetrahedra + 1);
  for (vtkIdType i = 0; i <= numberOfTetrahedra; ++i)
  {
    offsets->SetValue(i, 4 * i);
  }
  vtkNew<vtkIdTypeArray> connectivity;
  connectivity->SetNumberOfValues(4 * numberOfTetrahedra);
  vtkIdType* vertex = connectivity->GetPointer(0);

  for (int z = 0; z < nodes[2]; ++z)
  {
    algorithm->UpdateProgress(static_cast<double>(z) / nodes[2]);
    if (deformvolume::IsAborted(algorithm))
    {
      throw deformvolume::Aborted();
    }
    for (int y = 0; y < nodes[1]; ++y)
    {
      for (int x = 0; x < nodes[0]; ++x)
      {
        const glm::dvec3 node = lattice.Corner + lattice.Steps * glm::dvec3(x, y, z);
        *coordinate++ = node.x;
        *coordinate++ = node.y;
        *coordinate++ = node.z;
        if (x + 1 < nodes[0] && y + 1 < nodes[1] && z + 1 < nodes[2])
        {
          vertex = WriteCell(x, y, z, nodes, isMirrored, vertex);
        }
      }
    }
  }
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, connectivity);
  output->SetPoints(points);
  output->SetCells(VTK_TETRA, cells);
}

} // namespace

vtkLatticeTetrahedraSource::vtkLatticeTetrahedraSource()
  : Execution(new deformvolume::PipelineExecution)
{
  this->SetNumberOfInputPorts(1);
}

vtkLatticeTetrahedraSource::~vtkLatticeTetrahedraSource() = default;

int vtkLatticeTetrahedraSource::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkLatticeTetrahedraSource::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Execution->Renew(this);
  *mtime = this->GetMTime();
  return 1;
}

int vtkLatticeTetrahedraSource::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  // Request the whole volume, although the lattice depends on no voxel: consumers of one source
  // share its information, and a smaller request would replace that of another consumer. The source
  // would then read the volume twice.
  deformvolume::AskForAll(inputVector, 0, 1);
  return 1;
}

int vtkLatticeTetrahedraSource::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputVector);
  output->Initialize();
  std::fill_n(this->Dimensions, 3, 0);
  if (!deformvolume::IsFirstPiece(outputVector))
  {
    return 1;
  }
  const int done =
    this->Execution->Run(this, "There is not enough memory for the lattice. Use fewer nodes.",
      [&]
      {
        Lattice lattice;
        std::copy_n(this->NumberOfNodes, 3, lattice.Nodes.begin());
        CheckNodes(lattice.Nodes);
        if (vtkImageData* volume = vtkImageData::GetData(inputVector[0]))
        {
          lattice.SetVolume(
            volume, FindWholeExtent(volume, inputVector[0]->GetInformationObject(0)), this->Margin);
        }
        else
        {
          lattice.SetBounds(this->Bounds, this->Margin);
        }
        const double volumeOfCell = glm::determinant(lattice.Steps);
        if (volumeOfCell == 0.0 || !std::isfinite(volumeOfCell))
        {
          throw Error("The lattice has no volume: its axes lie in one plane, or it is too small or "
                      "too large for double precision.");
        }
        if (this->EqualSpacing)
        {
          lattice.MakeCubes();
        }
        FillGrid(lattice, volumeOfCell < 0.0, this, output);
        std::copy(lattice.Nodes.begin(), lattice.Nodes.end(), this->Dimensions);
      });
  return done ? 1 : deformvolume::GetResultOfError(outputVector);
}

void vtkLatticeTetrahedraSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "NumberOfNodes: " << this->NumberOfNodes[0] << " " << this->NumberOfNodes[1]
     << " " << this->NumberOfNodes[2] << "\n";
  os << indent << "Bounds:";
  for (double bound : this->Bounds)
  {
    os << " " << bound;
  }
  os << "\n" << indent << "Margin: " << this->Margin << "\n";
  os << indent << "EqualSpacing: " << (this->EqualSpacing ? "On\n" : "Off\n");
  os << indent << "Dimensions: " << this->Dimensions[0] << " " << this->Dimensions[1] << " "
     << this->Dimensions[2] << "\n";
}
