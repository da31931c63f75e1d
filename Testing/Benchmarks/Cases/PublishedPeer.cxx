// SPDX-License-Identifier: BSD-3-Clause
// Runs the published method (PublishedKernels.cl) on the device of the filter.
#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include "Device.h"
#include "FiveTetrahedra.h"
#include "Peers.h"
#include "PublishedTexts.h"
#include "StaticMapping.h"

#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#define TEXT_OF(...) #__VA_ARGS__
#define EXPANDED_TEXT_OF(MACRO) TEXT_OF(MACRO)

namespace
{

cl::Device FindDevice(const std::string& name)
{
  std::vector<cl::Platform> platforms;
  cl::Platform::get(&platforms);
  for (const cl::Platform& platform : platforms)
  {
    std::vector<cl::Device> devices;
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    for (const cl::Device& device : devices)
    {
      // Drivers may pad names with blanks, or end them with zeros.
      std::string first = device.getInfo<CL_DEVICE_NAME>().c_str();
      first.erase(first.find_last_not_of(' ') + 1);
      if (!first.empty() && name.rfind(first + " (", 0) == 0)
      {
        return device;
      }
    }
  }
  throw std::runtime_error("there is no device " + name);
}

class PublishedPeer : public Peer
{
public:
  PublishedPeer(vtkImageData* volume, int nodesPerAxis)
  {
    volume->GetDimensions(this->Dimensions.data());
    vtkNew<vtkLatticeTetrahedraSource> lattice;
    lattice->SetInputData(volume);
    lattice->SetNumberOfNodes(nodesPerAxis, nodesPerAxis, nodesPerAxis);
    lattice->EqualSpacingOff();
    lattice->Update();
    vtkUnstructuredGrid* mesh = lattice->GetOutput();
    for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
    {
      const double* point = mesh->GetPoint(node);
      this->Rest.emplace_back(point[0], point[1], point[2]);
    }
    std::vector<deformvolume::Tetrahedron> tetrahedra;
    vtkNew<vtkIdList> nodes;
    for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
    {
      mesh->GetCellPoints(cell, nodes);
      std::copy_n(nodes->begin(), 4, tetrahedra.emplace_back().begin());
    }
    deformvolume::Extent extent;
    volume->GetExtent(extent.data());
    const std::vector<deformvolume::VertexLink> links = deformvolume::BuildStaticMapping(extent,
      { 1.0, 1.0, 1.0 }, this->Rest, tetrahedra, false, deformvolume::StaticMappingForm::Links)
                                                          .Links;
    if (std::any_of(
          links.begin(), links.end(), [](const auto& link) { return link.Tetrahedron < 0; }))
    {
      throw std::runtime_error("the mesh does not hold all voxels");
    }
    const std::size_t voxels = links.size();
    this->Positions = cl::Buffer(this->Context, CL_MEM_READ_WRITE, voxels * 3 * sizeof(float));
    this->Displacements =
      cl::Buffer(this->Context, CL_MEM_READ_ONLY, this->Rest.size() * 3 * sizeof(float));
    const auto* values = static_cast<const cl_ushort*>(volume->GetScalarPointer());
    this->Map.setArg(0, this->Send(links.data(), voxels));
    this->Map.setArg(1, this->Send(tetrahedra.data(), tetrahedra.size()));
    this->Map.setArg(2, this->Displacements);
    this->Map.setArg(3, this->Positions);
    this->Map.setArg(4, this->GetSize());
    this->Resample.setArg(0, this->Positions);
    this->Resample.setArg(1, this->Send(values, voxels));
    this->Resample.setArg(4, this->GetSize());
  }

  double Update(Pose pose, int step, const int extent[6]) override
  {
    const PoseMap map(pose, this->Dimensions, step);
    std::vector<float> displacements;
    for (const glm::dvec3& rest : this->Rest)
    {
      const auto moved = map({ { rest.x, rest.y, rest.z } });
      for (int axis = 0; axis < 3; ++axis)
      {
        displacements.push_back(static_cast<float>(moved[axis] - rest[axis]));
      }
    }
    cl::copy(this->Queue, displacements.begin(), displacements.end(), this->Displacements);
    this->SetExtent(extent);

    cl::Event events[4];
    this->Queue.enqueueFillBuffer(
      this->Values, cl_ushort{ 0 }, 0, this->GetBytes(2), nullptr, &events[0]);
    this->Queue.enqueueFillBuffer(
      this->Coverage, cl_uchar{ 0 }, 0, this->GetBytes(1), nullptr, &events[1]);
    this->Launch(this->Map, 0, events[2]);
    this->Launch(this->Resample, 1, events[3]);
    this->Queue.enqueueReadBuffer(
      this->Values, CL_TRUE, 0, this->GetBytes(2), this->Output->GetScalarPointer());
    double nanoseconds = 0.0;
    for (const cl::Event& event : events)
    {
      nanoseconds += static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
        event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
    }
    return 1e-9 * nanoseconds;
  }

  vtkImageData* GetOutput() override { return this->Output; }

private:
  template <typename T>
  const cl::Buffer& Send(const T* values, std::size_t count)
  {
    return this->Sent.emplace_back(this->Context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
      count * sizeof(T), const_cast<T*>(values));
  }

  cl::Kernel MakeKernel(const char* name)
  {
    cl::Program program(this->Context,
      std::string("#define FIVE_TETRAHEDRA ") + EXPANDED_TEXT_OF(DEFORMVOLUME_FIVE_TETRAHEDRA) +
        "\n" + deformvolume::PublishedKernels_cl);
    program.build("-cl-std=CL1.2");
    return cl::Kernel(program, name);
  }

  cl_int4 GetSize() const
  {
    return { { this->Dimensions[0], this->Dimensions[1], this->Dimensions[2], 0 } };
  }

  std::size_t GetBytes(std::size_t each) const
  {
    return each * static_cast<std::size_t>(this->Output->GetNumberOfPoints());
  }

  void SetExtent(const int extent[6])
  {
    if (!std::equal(extent, extent + 6, this->Output->GetExtent()))
    {
      this->Output->SetExtent(const_cast<int*>(extent));
      this->Output->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
      this->Values = cl::Buffer(this->Context, CL_MEM_READ_WRITE, this->GetBytes(2));
      this->Coverage = cl::Buffer(this->Context, CL_MEM_READ_WRITE, this->GetBytes(1));
    }
    int size[3];
    this->Output->GetDimensions(size);
    this->Resample.setArg(2, this->Values);
    this->Resample.setArg(3, this->Coverage);
    this->Resample.setArg(5, cl_int4{ { extent[0], extent[2], extent[4], 0 } });
    this->Resample.setArg(6, cl_int4{ { size[0], size[1], size[2], 0 } });
  }

  // Launches a kernel for all vertices (less: 0) or for all cells (less: 1, because an axis has one
  // cell less than vertices).
  void Launch(const cl::Kernel& kernel, int less, cl::Event& event)
  {
    constexpr std::size_t group = 64;
    const auto items = [&](int axis)
    { return static_cast<std::size_t>(this->Dimensions[axis] - less); };
    this->Queue.enqueueNDRangeKernel(kernel, cl::NullRange,
      cl::NDRange((items(0) + group - 1) / group * group, items(1), items(2)),
      cl::NDRange(group, 1, 1), nullptr, &event);
  }

  cl::Device Device = FindDevice(deformvolume::ResolveDevice(""));
  cl::Context Context{ Device };
  cl::CommandQueue Queue{ Context, Device, CL_QUEUE_PROFILING_ENABLE };
  cl::Kernel Map = MakeKernel("MapVertices");
  cl::Kernel Resample = MakeKernel("Resample");
  std::array<int, 3> Dimensions;
  std::vector<glm::dvec3> Rest;
  std::vector<cl::Buffer> Sent; // keeps these buffers while kernels refer to them
  cl::Buffer Displacements;
  cl::Buffer Positions;
  cl::Buffer Values;
  cl::Buffer Coverage;
  vtkNew<vtkImageData> Output;
};

} // namespace

std::unique_ptr<Peer> MakePublished(vtkImageData* volume, int nodesPerAxis)
{
  return std::make_unique<PublishedPeer>(volume, nodesPerAxis);
}
