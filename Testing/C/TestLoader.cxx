// SPDX-License-Identifier: BSD-3-Clause
// The engine's loader: the drivers that it finds, and calls of their functions.
#include "SystemDrivers.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace
{

using Names = std::vector<std::string>;

class Loader : public testing::Test
{
protected:
  void SetUp() override
  {
    for (const char* const name : { "OCL_ICD_FILENAMES", "OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH" })
    {
      unsetenv(name);
    }
    std::string path = testing::TempDir() + "/loader-XXXXXX";
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    this->Folder = path;
  }

  void TearDown() override { std::filesystem::remove_all(this->Folder); }

  std::string Write(const std::string& name, const std::string& text)
  {
    std::ofstream(this->Folder + "/" + name) << text;
    return this->Folder + "/" + name;
  }

  std::string Folder;
};

} // namespace

TEST_F(Loader, MissingPath)
{
  setenv("OCL_ICD_VENDORS", (this->Folder + "/none").c_str(), 1);
  EXPECT_EQ(
    deformvolume::FindSystemDrivers(), Names{ this->Folder + "/none" }); // the name of a library
  setenv("OCL_ICD_VENDORS", (this->Folder + "/none.icd").c_str(), 1);
  EXPECT_EQ(deformvolume::FindSystemDrivers(), Names());
  unsetenv("OCL_ICD_VENDORS");
  setenv("OPENCL_VENDOR_PATH", (this->Folder + "/none").c_str(), 1);
  EXPECT_EQ(deformvolume::FindSystemDrivers(), Names());
}

TEST_F(Loader, ReadsVendorFiles)
{
  this->Write("b.icd", "libb.so\n");
  this->Write("a.icd", " /opt/liba.so \r\nsecond line\n");
  this->Write("c.icd", "libc-without-end-of-line.so");
  this->Write("empty.icd", "");
  this->Write("blank.icd", "  \n");
  this->Write("other.txt", "libother.so\n");
  const Names all{ "/opt/liba.so", "libb.so", "libc-without-end-of-line.so" };
  setenv("OPENCL_VENDOR_PATH", this->Folder.c_str(), 1);
  EXPECT_EQ(deformvolume::FindSystemDrivers(), all);
  setenv("OCL_ICD_VENDORS", (this->Folder + "/b.icd").c_str(), 1);
  EXPECT_EQ(deformvolume::FindSystemDrivers(), Names{ "libb.so" });
  setenv("OCL_ICD_VENDORS", this->Folder.c_str(), 1);
  unsetenv("OPENCL_VENDOR_PATH");
  EXPECT_EQ(deformvolume::FindSystemDrivers(), all);
  setenv("OCL_ICD_VENDORS", "libpocl.so.2", 1);
  setenv("OCL_ICD_FILENAMES", "libx.so::/opt/liby.so", 1);
  EXPECT_EQ(
    deformvolume::FindSystemDrivers(), (Names{ "libx.so", "/opt/liby.so", "libpocl.so.2" }));
}

// Calls with null instead of an object return errors.
TEST_F(Loader, NullObjectsAreErrors)
{
  cl_int error = CL_SUCCESS;
  std::size_t size = 0;
  EXPECT_EQ(clGetPlatformIDs(0, nullptr, nullptr), CL_INVALID_VALUE);
  EXPECT_EQ(clGetDeviceInfo(nullptr, CL_DEVICE_NAME, 0, nullptr, &size), CL_INVALID_DEVICE);
  EXPECT_EQ(clReleaseContext(nullptr), CL_INVALID_CONTEXT);
  EXPECT_EQ(clFinish(nullptr), CL_INVALID_COMMAND_QUEUE);
  EXPECT_EQ(clReleaseMemObject(nullptr), CL_INVALID_MEM_OBJECT);
  EXPECT_EQ(clRetainKernel(nullptr), CL_INVALID_KERNEL);
  EXPECT_EQ(clCreateBuffer(nullptr, CL_MEM_READ_ONLY, 4, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_CONTEXT);
  EXPECT_EQ(clCreateContext(nullptr, 0, nullptr, nullptr, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_DEVICE);
  EXPECT_EQ(clWaitForEvents(0, nullptr), CL_INVALID_VALUE);
}

// A missing library, a library that is not a driver, and a driver, whose device executes a kernel.
// This must be the last test, since the loader searches for drivers only once.
TEST_F(Loader, ExecutesAKernel)
{
  cl_uint count = 0;
  setenv("OCL_ICD_FILENAMES", "/nowhere/lib.so:libm.so.6", 1);
  const cl_int result = clGetPlatformIDs(0, nullptr, &count);
  if (result == CL_PLATFORM_NOT_FOUND_KHR)
  {
    GTEST_SKIP() << "there is no driver";
  }
  ASSERT_EQ(result, CL_SUCCESS);
  ASSERT_GT(count, 0U);
  std::vector<cl_platform_id> platforms(count);
  ASSERT_EQ(clGetPlatformIDs(count, platforms.data(), nullptr), CL_SUCCESS);
  cl_device_id device = nullptr;
  ASSERT_EQ(clGetDeviceIDs(platforms[0], CL_DEVICE_TYPE_ALL, 1, &device, nullptr), CL_SUCCESS);
  cl_int error = CL_SUCCESS;
  cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &error);
  ASSERT_EQ(error, CL_SUCCESS);
  cl_command_queue queue = clCreateCommandQueue(context, device, 0, &error);
  ASSERT_EQ(error, CL_SUCCESS);
  const char* const text = "__kernel void twice(__global int* x)"
                           "{ x[get_global_id(0)] *= 2; }";
  cl_program program =
    clCreateProgramWithSource(context, 1, const_cast<const char**>(&text), nullptr, &error);
  ASSERT_EQ(clBuildProgram(program, 1, &device, "", nullptr, nullptr), CL_SUCCESS);
  cl_kernel kernel = clCreateKernel(program, "twice", &error);
  ASSERT_EQ(error, CL_SUCCESS);
  std::vector<cl_int> numbers{ 1, -2, 3, 40 };
  const std::size_t bytes = numbers.size() * sizeof(cl_int);
  cl_mem buffer = clCreateBuffer(
    context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, bytes, numbers.data(), &error);
  ASSERT_EQ(clSetKernelArg(kernel, 0, sizeof(buffer), &buffer), CL_SUCCESS);
  const std::size_t items = numbers.size();
  cl_event event = nullptr;
  ASSERT_EQ(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &items, nullptr, 0, nullptr, &event),
    CL_SUCCESS);
  EXPECT_EQ(clWaitForEvents(1, &event), CL_SUCCESS);
  ASSERT_EQ(
    clEnqueueReadBuffer(queue, buffer, CL_TRUE, 0, bytes, numbers.data(), 0, nullptr, nullptr),
    CL_SUCCESS);
  EXPECT_EQ(numbers, (std::vector<cl_int>{ 2, -4, 6, 80 }));
  clReleaseEvent(event);
  clReleaseMemObject(buffer);
  clReleaseKernel(kernel);
  clReleaseProgram(program);
  clReleaseCommandQueue(queue);
  clReleaseContext(context);
}
