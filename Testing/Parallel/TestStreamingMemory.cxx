// SPDX-License-Identifier: BSD-3-Clause
// Deforms a volume of 864 MB and writes it to a file in 16 pieces. The process must never need more
// than 1.5 GB. Argument: the folder for the file.
#include "FilterTesting.h"
#include "RunTests.h"

#include <vtkInformation.h>
#include <vtkRTAnalyticSource.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>

#include <cstdio>
#include <fstream>

using namespace filterTesting;

namespace
{

/// Returns the highest resident memory of this process, in MB.
double GetPeakMemory()
{
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
  {
    if (word == "VmHWM:")
    {
      double kibibytes = 0.0;
      status >> kibibytes;
      return kibibytes * 1024.0 / 1e6;
    }
  }
  return -1.0;
}

/// Turns and bends a volume whose center is at the origin.
glm::dvec3 Bend(const glm::dvec3& p)
{
  const double angle = 0.1 * std::sin(0.004 * p.z);
  return glm::dvec3(p.x * std::cos(angle) - p.y * std::sin(angle) + 6.0 * std::sin(0.01 * p.y),
    p.x * std::sin(angle) + p.y * std::cos(angle) + 5.0 * std::cos(0.02 * p.z),
    p.z + 7.0 * std::sin(0.013 * p.x));
}

/// Requests an extent, and removes the piece number that the writer has requested.
void Request(vtkAlgorithm* algorithm, const Extent& extent)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkNew<vtkInformation> request;
  request->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  request->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  request->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  request->Set(Pipeline::UPDATE_EXTENT(), extent.data(), 6);
  algorithm->Update(request);
}

} // namespace

TEST(StreamingMemory, FileOfPieces)
{
  const std::string file = GetTestArgument("-T") + "/TestStreamingMemory.vti";
  constexpr double inputMegabytes = 600.0 * 600.0 * 600.0 * sizeof(float) / 1e6;

  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-300, 299, -300, 299, -300, 299);
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetNumberOfNodes(13, 13, 13);
  lattice->SetBounds(-301, 300, -301, 300, -301, 300);
  lattice->Update();
  SetDisplacements(lattice->GetOutput(), Bend);

  Deformed deformed;
  deformed.Filter->SetInputConnection(source->GetOutputPort());
  deformed.Filter->SetDeformationData(lattice->GetOutput());
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputConnection(deformed.Filter->GetOutputPort());
  writer->SetFileName(file.c_str());
  writer->SetNumberOfPieces(16);
  writer->SetCompressorTypeToNone();
  // ParaView 5.11 cannot read appended data with recent versions of libexpat.
  writer->SetDataModeToBinary();
  EXPECT_EQ(writer->Write(), 1);
  EXPECT_EQ(deformed.TakeErrors(), 0);
  const double peak = GetPeakMemory();
  std::cout << "peak memory: " << peak << " MB\n";
  EXPECT_TRUE(peak > 0.0 && peak < 1500.0);
  // Whole input and output would have needed more memory.
  EXPECT_GT(2.0 * inputMegabytes, 1500.0);

  // The file has the same values as the output for a few planes.
  Extent whole;
  deformed.Filter->GetOutputInformation(0)->Get(
    vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
  EXPECT_TRUE(whole[1] - whole[0] > 590 && whole[5] - whole[4] > 590);
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(file.c_str());
  for (const int z : { whole[4], -77, 123, whole[5] - 1 })
  {
    Extent part = whole;
    part[4] = z;
    part[5] = z + 1;
    Request(deformed.Filter, part);
    EXPECT_EQ(deformed.TakeErrors(), 0);
    Request(reader, part);
    vtkImageData* made = deformed.Filter->GetOutput();
    EXPECT_EQ(GetExtent(made), part);
    EXPECT_TRUE(HaveEqualBits(
      made->GetPointData()->GetScalars(), reader->GetOutput()->GetPointData()->GetScalars()));
  }
  EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), 0);
  std::remove(file.c_str());
}
