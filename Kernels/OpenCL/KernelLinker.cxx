// SPDX-License-Identifier: BSD-3-Clause
#include "KernelLinker.h"

#include "Device.h"
#include "DeviceRank.h" // for ToLower
#include "Error.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace deformvolume
{
namespace
{

bool RunsLinker(const std::string& version)
{
  int major = 0;
  int minor = 0;
  const std::string words = ToLower(version); // versions before 3 spell their name "pocl"
  const std::size_t begin = words.find("pocl ");
  return begin != std::string::npos &&
    std::sscanf(words.c_str() + begin, "pocl %d.%d", &major, &minor) == 2 &&
    (major < 7 || (major == 7 && minor < 2));
}

// Lists the folders of the libraries of C compilers, which are not on the default path of "ld".
std::vector<std::string> FindLibraries()
{
  std::vector<std::string> found;
  std::error_code error;
  for (const char* const root : { "/usr/lib/gcc", "/usr/lib64/gcc" })
  {
    for (std::filesystem::directory_iterator target(root, error), end; target != end;
         target.increment(error))
    {
      for (std::filesystem::directory_iterator release(target->path(), error); release != end;
           release.increment(error))
      {
        found.push_back("-L" + release->path().string());
      }
    }
  }
  const char* const variable = std::getenv("LIBRARY_PATH");
  const std::string paths = variable ? variable : "";
  for (std::size_t begin = 0; begin < paths.size();)
  {
    const std::size_t end = std::min(paths.find(':', begin), paths.size());
    if (end > begin)
    {
      found.push_back("-L" + paths.substr(begin, end - begin));
    }
    begin = end + 1;
  }
  return found;
}

// Runs a program that is found on the PATH. Returns the error: the last line of its output, or the
// message of the system. Returns "" if the program succeeds or if its result is not known.
std::string Run(const std::vector<std::string>& command)
{
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
  {
    return ""; // the result is not known
  }
  std::vector<char*> arguments;
  for (const std::string& word : command)
  {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t process = 0;
  const int error =
    posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string words;
  std::array<char, 512> part;
  while (error == 0)
  {
    const ssize_t count = read(ends[0], part.data(), part.size());
    if (count > 0)
    {
      words.append(part.data(), static_cast<std::size_t>(count));
    }
    else if (count == 0 || errno != EINTR)
    {
      break;
    }
  }
  close(ends[0]);
  if (error == EAGAIN || error == ENOMEM)
  {
    return ""; // the system is out of resources: this is not an error of the linker
  }
  if (error != 0)
  {
    return "it cannot be run (" + std::generic_category().message(error) + ")";
  }
  int status = 0;
  pid_t ended = 0;
  do
  {
    ended = waitpid(process, &status, 0);
  } while (ended < 0 && errno == EINTR);
  // The exit status is not known if the process ignores SIGCHLD.
  if (ended != process || status == 0)
  {
    return "";
  }
  // The first lines may be about skipped libraries for other processors.
  words.erase(words.find_last_not_of('\n') + 1);
  return words.empty() ? "it fails without a message" : words.substr(words.rfind('\n') + 1);
}

/// Runs a linker without an object file. Returns the error, or "".
std::string Try(const std::string& program)
{
  std::vector<std::string> command{ program, "-shared", "-o", "/dev/null" };
  for (const std::string& path : FindLibraries())
  {
    command.push_back(path);
  }
  for (const char* const library :
    { "-lm", "-lgcc", "--as-needed", "-lgcc_s", "--no-as-needed", "-lc" })
  {
    command.emplace_back(library);
  }
  return Run(command);
}

/// The linker of SetKernelLinker(), and the entry of the environment that contains its folder.
struct OwnLinker
{
  std::mutex Mutex;
  std::string Folder;
  bool IsTried = false;
  std::string Problem;
  int Users = 0;
  char* Entry = nullptr;  // owned by the environment
  char* Before = nullptr; // the entry of the user; null if there was none
};

OwnLinker& GetOwnLinker()
{
  static auto* const linker = new OwnLinker; // lives as long as the process
  return *linker;
}

const char* const PathVariable = "COMPILER_PATH";

char* MakeEntry(const std::string& value)
{
  return strdup((std::string(PathVariable) + "=" + value).c_str());
}

} // namespace

void SetKernelLinker(const std::string& folder)
{
  if (folder.empty() || folder[0] != '/')
  {
    throw Error(
      "The path \"" + folder + "\" of a linker's folder is not absolute. Pass an absolute path.");
  }
  OwnLinker& own = GetOwnLinker();
  const std::lock_guard<std::mutex> lock(own.Mutex);
  if (!own.IsTried) // after the first try, kernels may have been linked with the linker of the
                    // folder
  {
    own.Folder = folder;
  }
}

bool CheckKernelLinker(const std::string& version, bool isAdded)
{
  if (!RunsLinker(version))
  {
    return false;
  }
  const char* const variable = std::getenv("DEFORMVOLUME_LINKER");
  const std::string choice = variable ? variable : "";
  if (!choice.empty() && choice != "auto" && choice != "system" && choice != "own")
  {
    throw Error("The environment variable DEFORMVOLUME_LINKER is \"" + choice +
      "\". Set it to auto, system or own.");
  }
  static std::once_flag isChecked;
  static auto* const problem = new std::string;
  // Without the variable, this library would search the default path of the system, and PoCL
  // nothing: it would terminate the process.
  std::call_once(isChecked,
    []
    { *problem = std::getenv("PATH") ? Try("ld") : "the environment variable PATH is not set"; });
  std::string words = *problem;
  if (words.empty() && choice != "own")
  {
    return false;
  }
  OwnLinker& own = GetOwnLinker();
  const std::lock_guard<std::mutex> lock(own.Mutex);
  if (isAdded && choice != "system" && !own.Folder.empty())
  {
    if (!own.IsTried)
    {
      own.IsTried = true;
      own.Problem = Try(own.Folder + "/ld");
    }
    if (own.Problem.empty())
    {
      return true;
    }
    words += (words.empty() ? "" : "; and of \"" + own.Folder + "/ld\": ") + own.Problem;
  }
  else if (words.empty())
  {
    return false;
  }
  throw Error("The kernels cannot be compiled: PoCL needs the linker \"ld\" on the PATH, with "
              "the libraries of a C compiler, but: " +
    words + ". Install a C compiler (on Debian the package gcc), or PoCL 7.2 or later.");
}

KernelLinkerScope::KernelLinkerScope(bool isUsed)
  : IsUsed(isUsed)
{
  if (!isUsed)
  {
    return;
  }
  OwnLinker& own = GetOwnLinker();
  const std::lock_guard<std::mutex> lock(own.Mutex);
  if (own.Users++ > 0)
  {
    return;
  }
  if (!own.Entry)
  {
    const char* const before = std::getenv(PathVariable);
    own.Before = before ? MakeEntry(before) : nullptr;
    own.Entry = MakeEntry(own.Folder + (before ? ":" + std::string(before) : ""));
    putenv(own.Entry);
  }
  else if (own.Before)
  {
    putenv(own.Entry); // replaces the entry of the user
  }
  else
  {
    // Undo the renaming in the destructor.
    __atomic_store_n(own.Entry, PathVariable[0], __ATOMIC_SEQ_CST);
  }
}

KernelLinkerScope::~KernelLinkerScope()
{
  if (!this->IsUsed)
  {
    return;
  }
  OwnLinker& own = GetOwnLinker();
  const std::lock_guard<std::mutex> lock(own.Mutex);
  if (--own.Users > 0)
  {
    return;
  }
  if (own.Before)
  {
    putenv(own.Before);
  }
  else
  {
    // Rename the variable: its removal would move all entries behind it.
    __atomic_store_n(own.Entry, '_', __ATOMIC_SEQ_CST);
  }
}

} // namespace deformvolume
