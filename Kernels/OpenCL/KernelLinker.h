// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelLinker_h
#define DeformVolumeKernelLinker_h

#include <string>

namespace deformvolume
{

/// Checks whether PoCL can link kernels. Versions before 7.2 run the program "ld" for each kernel,
/// with the libraries of a C compiler, and terminate the process if "ld" fails. Later versions
/// usually link without "ld" and are not checked. The check runs "ld" once, with the same libraries
/// and no object file. If "ld" fails and the driver was added with AddDriver(), the check tries the
/// linker of SetKernelLinker(). Returns true if kernels must be linked with that linker, within a
/// KernelLinkerScope. Throws Error if no linker works. version: CL_PLATFORM_VERSION of the
/// platform. isAdded: whether AddDriver() added the driver.
bool CheckKernelLinker(const std::string& version, bool isAdded);

/// Makes PoCL use the linker of SetKernelLinker() during the lifetime of the object, if isUsed.
/// PoCL contains Clang, which searches the folders of the environment variable COMPILER_PATH for
/// "ld" first. Keep the object until the launched kernels have ended. The variable is set and reset
/// without moving other entries of the environment, since other threads may read these entries.
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
