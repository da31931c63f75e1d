// SPDX-License-Identifier: BSD-3-Clause
#include "KernelProcessor.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#endif
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

namespace deformvolume
{
namespace
{

#if defined(__x86_64__) && defined(__GNUC__)
struct Registers
{
  unsigned int A = 0;
  unsigned int B = 0;
  unsigned int C = 0;
  unsigned int D = 0;
};

Registers Ask(unsigned int leaf)
{
  Registers registers;
  __get_cpuid_count(leaf, 0, &registers.A, &registers.B, &registers.C, &registers.D);
  return registers;
}

bool HasBits(unsigned int value, std::initializer_list<int> bits)
{
  return std::all_of(bits.begin(), bits.end(), [&](int bit) { return value >> bit & 1U; });
}

/// Which registers the system saves; all others cannot be used.
unsigned int GetSavedRegisters()
{
  unsigned int low = 0;
  unsigned int high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

/// For which processor the built-in functions were compiled that PoCL takes (getX86KernelLibName in
/// its pocl_llvm_build.cc, and its build for distributions). Null for processors without AVX2: LLVM
/// recognizes all of these.
const char* GetProcessor()
{
  const unsigned int first = Ask(1).C;
  const unsigned int seventh = Ask(7).B;
  if (!HasBits(first, { 27 })) // the system saves registers
  {
    return nullptr;
  }
  const unsigned int saved = GetSavedRegisters();
  const bool hasAVX = HasBits(first, { 28 }) && HasBits(saved, { 1, 2 });
  if (hasAVX && HasBits(seventh, { 16 }) && HasBits(saved, { 5, 6, 7 }))
  {
    return "skylake-avx512";
  }
  // Of leaf 1: FMA, 16-byte compare and exchange, popcnt, F16C. Of leaf 7: BMI, AVX2, BMI2. Of the
  // last one: lzcnt.
  if (hasAVX && HasBits(first, { 12, 13, 23, 29 }) && HasBits(seventh, { 3, 5, 8 }) &&
    HasBits(Ask(0x80000001).C, { 5 }))
  {
    return "haswell";
  }
  return nullptr;
}
#else
const char* GetProcessor()
{
  return nullptr;
}
#endif

bool IsThatDriver(const cl::Device& device)
{
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const std::string version = platform.getInfo<CL_PLATFORM_VERSION>();
  return version.find("PoCL 3.0") != std::string::npos &&
    version.find(", DISTRO") != std::string::npos;
}

/// Memory of this process that need not be there.
class Memory
{
public:
  Memory()
    : File(open("/proc/self/mem", O_RDONLY | O_CLOEXEC))
  {
  }
  ~Memory()
  {
    if (this->File >= 0)
    {
      close(this->File);
    }
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  bool Read(std::uintptr_t address, void* target, std::size_t bytes) const
  {
    return this->File >= 0 && address < (std::uintptr_t{ 1 } << 47) &&
      pread(this->File, target, bytes, static_cast<off_t>(address)) == static_cast<ssize_t>(bytes);
  }

private:
  int File;
};

/// The only member among the first of a structure that points to a text; null where there is none,
/// or more than one.
const char** FindText(void* structure, const std::string& text)
{
  const std::size_t members = 128; // it is the 81st
  const Memory memory;
  const char** found = nullptr;
  for (std::size_t i = 0; i < members; ++i)
  {
    const char** const member = static_cast<const char**>(structure) + i;
    std::uintptr_t address = 0;
    std::array<char, 64> read{};
    if (!memory.Read(reinterpret_cast<std::uintptr_t>(member), &address, sizeof(address)))
    {
      return nullptr;
    }
    if (text.size() < read.size() && memory.Read(address, read.data(), text.size() + 1) &&
      std::memcmp(read.data(), text.c_str(), text.size() + 1) == 0)
    {
      if (found)
      {
        return nullptr;
      }
      found = member;
    }
  }
  return found;
}

} // namespace

std::string SetKernelProcessor(const std::string& library, const cl::Device& device)
{
  const char* const processor = GetProcessor();
  if (!processor || !(device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) ||
    !IsThatDriver(device))
  {
    return "";
  }
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  if (!handle)
  {
    return "";
  }
  void* const function = dlsym(handle, "pocl_get_llvm_cpu_name");
  dlclose(handle); // it stays loaded
  if (!function)
  {
    return "";
  }
  char* const name = reinterpret_cast<char* (*)()>(function)();
  const std::string recognized = name ? name : "";
  std::free(name);
  if (recognized.empty())
  {
    return "";
  }
  if (recognized != processor)
  {
    const char** const member = FindText(device(), recognized);
    if (!member)
    {
      return "";
    }
    *member = processor;
  }
  return processor;
}

} // namespace deformvolume
