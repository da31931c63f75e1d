// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelLinker_h
#define DeformVolumeKernelLinker_h

#include <string>

namespace deformvolume
{

/// Versions of PoCL before 7.2 run the program "ld" for each kernel, with the libraries of a C
/// compiler, and end the process where that fails; later ones mostly link by themselves, and are
/// not asked. So this links once, with the same libraries and nothing else. Where that fails, and
/// the driver is one of AddDriver(), it links with the program of SetKernelLinker(). Throws Error
/// where none of them works. version: what a platform says of itself (CL_PLATFORM_VERSION). Returns
/// whether kernels are to be linked within a KernelLinkerScope.
bool CheckKernelLinker(const std::string& version, bool isAdded);

/// As long as there is one that is in use, PoCL finds the program of SetKernelLinker(): Clang,
/// which is a part of PoCL, looks for "ld" in the folders of the environment variable COMPILER_PATH
/// first. It is to end when what has been launched has run. The variable goes on and off without
/// moving any other one, as other threads may read them.
class KernelLinkerScope
{
public:
  explicit KernelLinkerScope(bool isUsed);
  ~KernelLinkerScope();
  KernelLinkerScope(const KernelLinkerScope&) = delete;
  KernelLinkerScope& operator=(const KernelLinkerScope&) = delete;

private:
  bool IsUsed;
};

} // namespace deformvolume

#endif
