// SPDX-License-Identifier: BSD-3-Clause
// Deforms a volume of unsigned char with 1000 voxels on each axis by a lattice with 13 nodes on
// each axis, near identity and then by whole voxels, after which each voxel is checked. Prints
// times and memory, and fails if the resident memory of the process ever exceeds 8 GB.
//
// Arguments: voxels on each axis, nodes on each axis. Only the default size has a limit.
#include "../Reported.h"

#include <vtkDataArray.h>
#include <vtkDeformVolumeFilter.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtksys/SystemInformation.hxx>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace
{

constexpr double MaximumResidentBytes = 8e9;
constexpr int DefaultSize = 1000;
constexpr int Skipped = 125;

// Returns the highest resident memory of the process in bytes; 0 if the system does not report it.
double GetPeakResidentBytes()
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
  {
    if (line.rfind("VmHWM:", 0) == 0)
    {
      return 1024.0 * std::stod(line.substr(6));
    }
  }
  return 0.0;
}

void Report(const std::string& what, double seconds)
{
  std::cout << what << ": " << seconds << " s, VmHWM " << GetPeakResidentBytes() * 1e-9 << " GB\n"
            << std::flush;
}

unsigned char GetValue(std::int64_t x, std::int64_t y, std::int64_t z)
{
  return static_cast<unsigned char>(7 * x + 13 * y + 29 * z + (x * y >> 4));
}

class Large
{
public:
  Large(int size, int nodes)
    : Size(size)
  {
    vtkNew<vtkUnsignedCharArray> values;
    values->SetName("value");
    values->SetNumberOfTuples(static_cast<vtkIdType>(size) * size * size);
    unsigned char* value = values->GetPointer(0);
    for (int z = 0; z < size; ++z)
    {
      for (int y = 0; y < size; ++y)
      {
        for (int x = 0; x < size; ++x)
        {
          *value++ = GetValue(x, y, z);
        }
      }
    }
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(size, size, size);
    volume->GetPointData()->SetScalars(values);
    vtkNew<vtkLatticeTetrahedraSource> lattice;
    lattice->SetInputData(volume);
    lattice->SetNumberOfNodes(nodes, nodes, nodes);
    lattice->EqualSpacingOff();
    lattice->Update();
    this->Mesh->ShallowCopy(lattice->GetOutput());
    this->Displacements->SetName("Displacement");
    this->Displacements->SetNumberOfComponents(3);
    this->Displacements->SetNumberOfTuples(this->Mesh->GetNumberOfPoints());
    this->Mesh->GetPointData()->SetVectors(this->Displacements);
    this->Filter->SetInputData(volume);
    this->Filter->SetDeformationData(this->Mesh);
    this->Filter->SetOutputBoundsModeToVolumeBounds();
  }

  template <typename Function>
  bool Update(const std::string& what, Function&& displacement)
  {
    for (vtkIdType node = 0; node < this->Mesh->GetNumberOfPoints(); ++node)
    {
      double rest[3];
      this->Mesh->GetPoint(node, rest);
      const auto [x, y, z] = displacement(rest);
      this->Displacements->SetTuple3(node, x, y, z);
    }
    this->Displacements->Modified();
    this->Mesh->Modified();
    const auto start = std::chrono::steady_clock::now();
    this->Filter->Update();
    Report(what, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    const double voxels = std::pow(this->Size, 3.0);
    std::cout << "  preprocessing "
              << GetReportedSeconds(this->Filter, "Seconds for the static mapping")
              << " s, transfer " << GetReportedSeconds(this->Filter, "Seconds for transfer")
              << " s, mapping " << GetReportedSeconds(this->Filter, "Seconds for mapping")
              << " s, resampling " << GetReportedSeconds(this->Filter, "Seconds for resampling")
              << " s; device memory "
              << static_cast<double>(this->Filter->GetDeviceMemory()) / voxels
              << " bytes a voxel; covered "
              << static_cast<double>(this->Filter->GetNumberOfCoveredVoxels()) / voxels
              << " of the voxels\n";
    return this->Filter->GetNumberOfCoveredVoxels() > 0;
  }

  // Whether all voxels have moved by a number of voxels on each axis.
  bool IsShifted(int dx, int dy, int dz)
  {
    auto* values =
      vtkUnsignedCharArray::SafeDownCast(this->Filter->GetOutput()->GetPointData()->GetScalars());
    const unsigned char* value = values->GetPointer(0);
    std::int64_t wrong = 0;
    for (int z = 0; z < this->Size; ++z)
    {
      for (int y = 0; y < this->Size; ++y)
      {
        for (int x = 0; x < this->Size; ++x, ++value)
        {
          const bool inside = x >= dx && y >= dy && z >= dz;
          wrong += *value != (inside ? GetValue(x - dx, y - dy, z - dz) : 0) ? 1 : 0;
        }
      }
    }
    std::cout << "  wrong voxels: " << wrong << "\n";
    return wrong == 0;
  }

private:
  int Size;
  vtkNew<vtkUnstructuredGrid> Mesh;
  vtkNew<vtkFloatArray> Displacements;
  vtkNew<vtkDeformVolumeFilter> Filter;
};

struct Vector
{
  double X;
  double Y;
  double Z;
};

}

int main(int argc, char* argv[])
{
  const int size = argc > 1 ? std::atoi(argv[1]) : DefaultSize;
  const int nodes = argc > 2 ? std::atoi(argv[2]) : 13;
  if (size < 2 || nodes < 2)
  {
    std::cerr << "Usage: DeformVolumeLargeVolume [voxels an axis, default 1000] [nodes an axis, "
                 "default 13]\n";
    return EXIT_FAILURE;
  }
  vtksys::SystemInformation system;
  system.RunMemoryCheck();
  const double available = 1048576.0 * static_cast<double>(system.GetAvailablePhysicalMemory());
  const double needed = MaximumResidentBytes * std::pow(size / double(DefaultSize), 3.0);
  if (available < needed)
  {
    std::cout << "skipped: this needs " << needed * 1e-9 << " GB of free memory, and "
              << available * 1e-9 << " are there\n";
    return Skipped;
  }
  const auto start = std::chrono::steady_clock::now();
  Large large(size, nodes);
  Report("volume of " + std::to_string(size) + " voxels and lattice of " + std::to_string(nodes) +
      " nodes an axis",
    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  bool good = large.Update("near pose",
    [](const double* rest)
    {
      return Vector{ 12.0 * std::sin(0.02 * rest[1]), 12.0 * std::sin(0.02 * rest[2]),
        12.0 * std::sin(0.02 * rest[0]) };
    });
  good = large.Update("whole voxels",
           [](const double*) {
             return Vector{ 3.0, 1.0, 2.0 };
           }) &&
    good;
  good = large.IsShifted(3, 1, 2) && good;
  const double peak = GetPeakResidentBytes();
  std::cout << "VmHWM " << peak * 1e-9 << " GB, " << peak / std::pow(size, 3.0)
            << " bytes a voxel\n";
  if (size == DefaultSize && peak > MaximumResidentBytes)
  {
    std::cout << "NOT MET: at most " << MaximumResidentBytes * 1e-9 << " GB\n";
    good = false;
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
