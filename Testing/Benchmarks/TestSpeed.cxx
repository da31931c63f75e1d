// SPDX-License-Identifier: BSD-3-Clause
// The only test that checks time: an update of vtkDeformVolumeFilter relative to one of
// vtkImageReslice with an affine transform, which fills the same output. The two are updated in
// turn. The best of ten updates of each counts, so that other programs on the machine have little
// effect.
#include "BenchmarkCase.h"
#include "Peers.h"

#include <vtkImageData.h>

#include <CL/cl.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <limits>
#include <vector>

namespace
{

// Returns the number of floats in a vector register of the CPU that OpenCL uses; 0 without such a
// CPU.
unsigned int FindLanes()
{
  cl_uint count = 0;
  clGetPlatformIDs(0, nullptr, &count);
  std::vector<cl_platform_id> platforms(count);
  clGetPlatformIDs(count, platforms.data(), nullptr);
  for (const cl_platform_id platform : platforms)
  {
    cl_device_id device;
    cl_uint width = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_CPU, 1, &device, nullptr) == CL_SUCCESS &&
      clGetDeviceInfo(
        device, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof(width), &width, nullptr) == CL_SUCCESS)
    {
      return width;
    }
  }
  return 0;
}

// Returns the ratio that was measured with VTK 9.1 on two cores with this number of lanes; 0 if it
// was not measured.
double GetMeasuredRatio(unsigned int lanes)
{
  return lanes == 16 ? 0.47 : 0.0;
}

} // namespace

int main()
{
  constexpr int rounds = 10;
  constexpr double slack = 1.5;
  try
  {
    const auto volume = MakeVolume(BenchmarkVolume);
    BenchmarkCase deform(volume, CoarseNodes);
    deform.GetFilter()->SetDevice("cpu");
    const auto reslice = MakeAffineReslice(volume);
    double deformed = std::numeric_limits<double>::infinity();
    double resliced = deformed;
    // The first round compiles kernels and builds the static mapping.
    for (int round = 0; round <= rounds; ++round)
    {
      deform.Move(Pose::NearIdentity);
      const double update = deform.Update().Update;
      const double peer = reslice->Update(
        Pose::General, deform.GetStep(), deform.GetFilter()->GetOutput()->GetExtent());
      deformed = round > 0 ? std::min(deformed, update) : deformed;
      resliced = round > 0 ? std::min(resliced, peer) : resliced;
    }
    const double ratio = deformed / resliced;
    const unsigned int lanes = FindLanes();
    const double measured = GetMeasuredRatio(lanes);
    std::cout << "time of an update divided by that of vtkImageReslice: " << ratio << " with "
              << lanes << " lanes";
    if (measured == 0.0)
    {
      std::cout << ", for which there is no number to compare with\n";
      return EXIT_SUCCESS;
    }
    std::cout << ", must be at most " << slack * measured << "\n";
    return ratio <= slack * measured ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
