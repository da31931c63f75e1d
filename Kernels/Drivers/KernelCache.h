// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelCache_h
#define DeformVolumeKernelCache_h

namespace deformvolume
{

/// Checks the directory in which PoCL caches compiled kernels. If PoCL cannot create the directory,
/// write to it or execute from it, PoCL has no devices or terminates the process. In that case this
/// function sets POCL_CACHE_DIR to a private temporary directory. Call it before any function of
/// OpenCL. Later calls do nothing.
void PrepareKernelCache();

/// Throws Error if there is no usable cache directory.
void CheckKernelCache();

/// During the lifetime of the object, no other process that uses this library compiles into PoCL's
/// kernel cache: PoCL sometimes fails if two processes do so at the same time. The constructor
/// waits for the others, but not longer than a minute, so that a process that has been stopped does
/// not stop all of them. Threads of one process share the lock.
class KernelCacheLock
{
public:
  /// isUsed: false if the driver is not PoCL. Then the object does nothing.
  explicit KernelCacheLock(bool isUsed);
  ~KernelCacheLock();
  KernelCacheLock(const KernelCacheLock&) = delete;
  KernelCacheLock& operator=(const KernelCacheLock&) = delete;

private:
  bool IsUsed;
};

} // namespace deformvolume

#endif
