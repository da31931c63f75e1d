// SPDX-License-Identifier: BSD-3-Clause
#include "KernelProcessor.h"

#include "Error.h"
#include "InstructionSets.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <unistd.h>

namespace deformvolume
{
namespace
{

/// Returns the processor of the built-in functions that PoCL selects, by the rules of
/// getX86KernelLibName in PoCL's pocl_llvm_build.cc. Null for processors without AVX2, all of which
/// LLVM 14 recognizes.
const char* GetProcessor()
{
  const InstructionSets sets = FindInstructionSets();
  return sets.AVX512 ? "skylake-avx512" : sets.Haswell ? "haswell" : nullptr;
}

/// Whether kernels that are compiled for a processor can call built-in functions with AVX-512. If
/// they cannot, LLVM terminates the process. recognized: the name of the processor in LLVM 14.
bool HasAVX512(const std::string& recognized)
{
  const std::array<const char*, 9> names{ { "skylake-avx512", "cascadelake", "cooperlake",
    "cannonlake", "icelake-client", "icelake-server", "rocketlake", "tigerlake",
    "sapphirerapids" } };
  return std::find(names.begin(), names.end(), recognized) != names.end();
}

// PoCL 3.0-rc2 of pocl-binary-distribution 3.0, and the build ID of its library. The linker
// computed the build ID from the contents of the library.
const char* const KnownVersion =
  "OpenCL 3.0 PoCL 3.0-rc2  Linux, Release, RELOC, LLVM 14.0.6, SLEEF, DISTRO, POCL_DEBUG";
using BuildID = std::array<unsigned char, 20>;
const BuildID KnownBuild{ { 0x96, 0x68, 0xb5, 0xf6, 0xec, 0x1f, 0xe9, 0x49, 0xd5, 0x47, 0xa5, 0x49,
  0x02, 0x97, 0x89, 0x18, 0x83, 0x40, 0xbe, 0xb7 } };

struct BuildSearch
{
  std::uintptr_t Address; // in the library
  BuildID Found{};
};

/// Finds the build ID in the notes of a library. Returns false if there is none.
bool FindBuildID(const char* notes, std::size_t size, BuildID& found)
{
  const auto round = [](std::size_t bytes) { return (bytes + 3) / 4 * 4; };
  ElfW(Nhdr) note;
  for (std::size_t at = 0; at + sizeof(note) <= size;)
  {
    std::memcpy(&note, notes + at, sizeof(note));
    const std::size_t name = at + sizeof(note);
    const std::size_t value = name + round(note.n_namesz);
    at = value + round(note.n_descsz);
    if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == sizeof(ELF_NOTE_GNU) &&
      note.n_descsz == found.size() && at <= size &&
      std::memcmp(notes + name, ELF_NOTE_GNU, sizeof(ELF_NOTE_GNU)) == 0)
    {
      std::memcpy(found.data(), notes + value, found.size());
      return true;
    }
  }
  return false;
}

int SearchLibrary(dl_phdr_info* library, std::size_t /*size*/, void* data)
{
  auto& search = *static_cast<BuildSearch*>(data);
  const ElfW(Phdr)* const begin = library->dlpi_phdr;
  const ElfW(Phdr)* const end = begin + library->dlpi_phnum;
  const auto holdsAddress = [&](const ElfW(Phdr) & segment)
  {
    const std::uintptr_t first = library->dlpi_addr + segment.p_vaddr;
    return segment.p_type == PT_LOAD && search.Address >= first &&
      search.Address - first < segment.p_memsz;
  };
  if (std::none_of(begin, end, holdsAddress))
  {
    return 0;
  }
  for (const ElfW(Phdr)* segment = begin; segment != end; ++segment)
  {
    if (segment->p_type == PT_NOTE &&
      FindBuildID(reinterpret_cast<const char*>(library->dlpi_addr + segment->p_vaddr),
        segment->p_memsz, search.Found))
    {
      break;
    }
  }
  return 1;
}

bool IsKnownVersion(const cl::Device& device)
{
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const std::string version = platform.getInfo<CL_PLATFORM_VERSION>();
  return std::string(version.c_str()) == KnownVersion;
}

/// Whether the library that contains a function is the known build.
bool IsKnownBuild(const void* function)
{
  BuildSearch search{ reinterpret_cast<std::uintptr_t>(function) };
  dl_iterate_phdr(SearchLibrary, &search);
  return search.Found == KnownBuild;
}

/// Reads memory of this process at addresses that may be invalid.
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

/// Finds the member of a structure that points to a text, among the first 128 members. Null if
/// there is none, or more than one.
const char** FindText(void* structure, const std::string& text)
{
  const std::size_t members = 128; // in PoCL 3.0, the member is the 81st
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

bool MaySetKernelProcessor()
{
  const char* const variable = std::getenv("DEFORMVOLUME_KERNEL_PROCESSOR");
  const std::string choice = variable ? variable : "";
  if (!choice.empty() && choice != "auto" && choice != "driver")
  {
    throw Error("The environment variable DEFORMVOLUME_KERNEL_PROCESSOR is \"" + choice +
      "\". Set it to auto or driver.");
  }
  return choice != "driver";
}

KernelProcessor SetKernelProcessor(
  const std::string& library, const cl::Device& device, bool maySet)
{
  KernelProcessor kernels;
  const char* const processor = GetProcessor();
  if (!processor || !(device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) ||
    !IsKnownVersion(device))
  {
    return kernels;
  }
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  if (!handle)
  {
    return kernels;
  }
  void* const function = dlsym(handle, "pocl_get_llvm_cpu_name");
  dlclose(handle); // the driver stays loaded
  if (!function)
  {
    return kernels;
  }
  char* const name = reinterpret_cast<char* (*)()>(function)();
  const std::string recognized = name ? name : "";
  std::free(name);
  if (recognized == processor)
  {
    kernels.Name = processor;
    return kernels;
  }
  const char** const member = maySet && !recognized.empty() && IsKnownBuild(function)
    ? FindText(device(), recognized)
    : nullptr;
  if (member)
  {
    *member = processor;
    kernels.Name = processor;
    return kernels;
  }
  // For "generic", the driver reports an error and does not terminate the process.
  kernels.EndsProcess = std::strcmp(processor, "skylake-avx512") == 0 && recognized != "generic" &&
    !HasAVX512(recognized);
  return kernels;
}

} // namespace deformvolume
