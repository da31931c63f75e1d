// SPDX-License-Identifier: BSD-3-Clause
#include "KernelCache.h"

#include "Error.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace deformvolume
{
namespace
{

std::once_flag Prepared;
std::string Problem;

/// The file that is locked, its descriptor, and the number of locks in this process.
std::string LockedFile;
int Lock = -1;
int NumberOfLocks = 0;
std::mutex LockMutex;

std::string GetEnvironment(const char* name)
{
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Returns PoCL's default cache directory, or "" if the environment does not define one.
std::string GetDefaultDirectory()
{
  const std::string own = GetEnvironment("POCL_CACHE_DIR");
  if (!own.empty())
  {
    return own;
  }
  const std::string cache = GetEnvironment("XDG_CACHE_HOME");
  if (!cache.empty())
  {
    return cache + "/pocl/kcache";
  }
  const std::string home = GetEnvironment("HOME");
  return home.empty() ? "" : home + "/.cache/pocl/kcache";
}

/// PoCL terminates the process if the disk is full. The kernels of a process take a few MiB.
constexpr unsigned long LeastSpace = 16UL << 20;

bool IsUsable(const std::string& directory)
{
  if (directory.empty())
  {
    return false;
  }
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  struct statvfs info;
  return access(directory.c_str(), R_OK | W_OK | X_OK) == 0 &&
    statvfs(directory.c_str(), &info) == 0 && !(info.f_flag & (ST_NOEXEC | ST_RDONLY)) &&
    (info.f_blocks == 0 || info.f_bavail * info.f_frsize >= LeastSpace); // 0: not known
}

std::string MakeTemporaryDirectory(const std::string& parent)
{
  std::string name = parent + "/deformvolume-kernels-XXXXXX";
  std::vector<char> buffer(name.begin(), name.end());
  buffer.push_back('\0');
  if (!mkdtemp(buffer.data()))
  {
    return "";
  }
  return buffer.data();
}

/// The private directory, which is removed at the end of the process that made it. Processes forked
/// from it end by the same function.
std::string TemporaryDirectory;
pid_t TemporaryDirectoryOwner = 0;
void RemoveTemporaryDirectory()
{
  if (getpid() == TemporaryDirectoryOwner)
  {
    std::error_code error;
    std::filesystem::remove_all(TemporaryDirectory, error);
  }
}

void Prepare()
{
  const char* const lockedFile = "/deformvolume.lock";
  std::string directory = GetDefaultDirectory();
  if (IsUsable(directory))
  {
    if (directory.front() != '/') // the current directory may change
    {
      directory = std::filesystem::absolute(directory).string();
      setenv("POCL_CACHE_DIR", directory.c_str(), 1);
    }
    LockedFile = directory + lockedFile;
    return;
  }
  const std::string temporary = GetEnvironment("TMPDIR");
  const std::string parent =
    temporary.empty() ? "/tmp" : std::filesystem::absolute(temporary).string();
  TemporaryDirectory = MakeTemporaryDirectory(parent);
  if (TemporaryDirectory.empty() || !IsUsable(TemporaryDirectory))
  {
    std::error_code error;
    std::filesystem::remove(TemporaryDirectory, error);
    Problem = "The kernels cannot be compiled: neither the kernel cache \"" + directory +
      "\" nor \"" + parent +
      "\" is a directory that can be written to and executed from, with 16 MiB of free space. Set "
      "POCL_CACHE_DIR to one.";
    return;
  }
  LockedFile = TemporaryDirectory + lockedFile;
  setenv("POCL_CACHE_DIR", TemporaryDirectory.c_str(), 1);
  TemporaryDirectoryOwner = getpid();
  std::atexit(RemoveTemporaryDirectory);
}

} // namespace

void PrepareKernelCache()
{
  std::call_once(Prepared, Prepare);
}

void CheckKernelCache()
{
  PrepareKernelCache();
  if (!Problem.empty())
  {
    throw Error(Problem);
  }
}

KernelCacheLock::KernelCacheLock(bool isUsed)
  : IsUsed(isUsed)
{
  if (!isUsed)
  {
    return;
  }
  const std::lock_guard<std::mutex> guard(LockMutex);
  if (++NumberOfLocks > 1)
  {
    return;
  }
  const auto openFile = [] { return open(LockedFile.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666); };
  Lock = openFile();
  if (Lock < 0 && errno == ENOENT)
  {
    // Somebody has removed the directory, and PoCL does not make it again.
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(LockedFile).parent_path(), error);
    Lock = openFile();
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  // On a file system without locks, flock() fails with another error.
  while (Lock >= 0 && flock(Lock, LOCK_EX | LOCK_NB) != 0 &&
    (errno == EWOULDBLOCK || errno == EINTR) && std::chrono::steady_clock::now() < end)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

KernelCacheLock::~KernelCacheLock()
{
  if (!this->IsUsed)
  {
    return;
  }
  const std::lock_guard<std::mutex> guard(LockMutex);
  if (--NumberOfLocks == 0 && Lock >= 0)
  {
    close(Lock); // unlocks the file
  }
}

} // namespace deformvolume
