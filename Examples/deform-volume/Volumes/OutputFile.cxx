// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "Failure.h"
#include "Files.h"
#include "Messages.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace
{
/// The temporary folders of files that are not complete, and the actions that signals had before.
struct UnfinishedFiles
{
  std::mutex Mutex;
  std::set<std::string> Folders;
  std::map<int, struct sigaction> Actions;
};

// The object is never destroyed, because the thread of EndBySignal() lives as long as the process.
UnfinishedFiles& GetUnfinishedFiles()
{
  static auto* const files = new UnfinishedFiles;
  return *files;
}

// A signal handler must not remove folders. It passes the signal to a thread by this pipe.
int SignalPipe[2];

extern "C" void PassSignal(int signal)
{
  const int error = errno;
  const auto number = static_cast<unsigned char>(signal);
  [[maybe_unused]] const auto written = write(SignalPipe[1], &number, 1);
  errno = error;
}

void EndBySignal()
{
  unsigned char signal = 0;
  while (read(SignalPipe[0], &signal, 1) != 1)
  {
  }
  UnfinishedFiles& files = GetUnfinishedFiles();
  files.Mutex.lock(); // never unlocked: no file is begun or completed from now on
  for (const std::string& folder : files.Folders)
  {
    // Another thread may be making files in the folder.
    constexpr int attempts = 100;
    std::error_code error;
    for (int i = 0; i < attempts && fs::exists(folder, error); ++i)
    {
      fs::remove_all(folder, error);
    }
  }
  sigaction(signal, &files.Actions[signal], nullptr);
  kill(getpid(), signal);
}

// Signals that are ignored, as by nohup, stay so. Compilers of kernels may have handlers, too.
bool HandleSignals()
{
  if (pipe(SignalPipe) != 0)
  {
    return false;
  }
  for (const int end : SignalPipe)
  {
    fcntl(end, F_SETFD, FD_CLOEXEC);
  }
  for (const int signal : { SIGINT, SIGTERM, SIGHUP })
  {
    struct sigaction& before = GetUnfinishedFiles().Actions[signal];
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN)
    {
      struct sigaction action = {};
      action.sa_handler = PassSignal;
      action.sa_flags = SA_RESTART;
      sigaction(signal, &action, nullptr);
    }
  }
  std::signal(SIGXFSZ, SIG_IGN); // a file that becomes too large is an error, as on a full disk
  std::thread(EndBySignal).detach();
  return true;
}

Failure MakeDiskFailure(const std::string& path)
{
  return Failure("cannot write " + path +
    ": there is no space left on the disk, or the file is too large for it");
}

// Returns the name of the file to replace: path or, if that is a symbolic link, where it leads.
// Empty: write the file directly.
fs::path FindPlace(const std::string& path)
{
  fs::path place = path;
  std::error_code error;
  constexpr int mostLinks = 40;
  for (int links = 0; fs::is_symlink(place, error); ++links)
  {
    if (links == mostLinks || HasSuffix(path, { ".mhd", ".nhdr" }))
    {
      return {};
    }
    place = place.parent_path() / fs::read_symlink(place, error);
  }
  const fs::file_status status = fs::status(place, error);
  return !fs::exists(status) || fs::is_regular_file(status) ? place : fs::path();
}

// Whether the disk has no space for a longer file. Then the end of the file may be missing: most
// writers do not notice that when they close the file. Makes the file longer for a moment, by more
// than the buffers of writers hold.
bool IsDiskFull(const fs::path& path)
{
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
  {
    return false;
  }
  const int file = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (file < 0)
  {
    return false;
  }
  constexpr long leastBuffer = 1L << 14;
  const std::vector<char> zeros(
    static_cast<std::size_t>(std::max(leastBuffer, static_cast<long>(status.st_blksize))));
  const ssize_t written = write(file, zeros.data(), zeros.size());
  const bool isFull = written < 0 ? errno == ENOSPC || errno == EDQUOT || errno == EFBIG
                                  : written < static_cast<ssize_t>(zeros.size());
  const bool isRestored = ftruncate(file, status.st_size) == 0;
  close(file);
  return isFull || !isRestored;
}
}

OutputFile::OutputFile(const std::string& path)
  : Path(path)
  , Written(path)
{
  [[maybe_unused]] static const bool handlesSignals = HandleSignals();
  const fs::path place = FindPlace(path);
  if (place.empty())
  {
    return;
  }
  std::string folder = (place.parent_path() / ".deform-volume-XXXXXX").string();
  UnfinishedFiles& files = GetUnfinishedFiles();
  const std::lock_guard<std::mutex> lock(files.Mutex);
  if (mkdtemp(folder.data()))
  {
    files.Folders.insert(folder);
    this->Place = place.string();
    this->Folder = folder;
    this->Written = (fs::path(folder) / fs::path(path).filename()).string();
  }
  else if (errno == ENOSPC || errno == EDQUOT)
  {
    throw MakeDiskFailure(path);
  }
}

OutputFile::~OutputFile()
{
  if (!this->Folder.empty())
  {
    UnfinishedFiles& files = GetUnfinishedFiles();
    const std::lock_guard<std::mutex> lock(files.Mutex);
    std::error_code error;
    fs::remove_all(this->Folder, error);
    files.Folders.erase(this->Folder);
  }
}

void OutputFile::Finish(Messages& messages, bool succeeded)
{
  const std::string fault = messages.TakeError();
  std::vector<fs::path> written{ this->Written };
  std::error_code error;
  for (fs::directory_iterator entry(this->Folder, error), end; !error && entry != end;
       entry.increment(error))
  {
    if (entry->path() != this->Written)
    {
      written.insert(written.begin(), entry->path());
    }
  }
  // Some writers report a full disk and remove the file, so that there is space again.
  if (fault.find("disk space") != std::string::npos ||
    std::any_of(written.begin(), written.end(), IsDiskFull))
  {
    throw MakeDiskFailure(this->Path);
  }
  if (!fault.empty())
  {
    throw Failure("cannot write " + this->Path + ": " + fault);
  }
  messages.Check("cannot write " + this->Path, succeeded);
  if (this->Folder.empty())
  {
    return;
  }
  const std::lock_guard<std::mutex> lock(GetUnfinishedFiles().Mutex);
  for (const fs::path& file : written)
  {
    fs::path place = this->Place;
    if (file != this->Written)
    {
      place.replace_filename(file.filename());
    }
    const fs::file_status old = fs::status(place, error);
    if (fs::exists(old))
    {
      fs::permissions(file, old.permissions(), error);
    }
    fs::rename(file, place, error);
    if (error) // some network file systems cannot rename files
    {
      fs::copy_file(file, place, fs::copy_options::overwrite_existing, error);
    }
    if (error)
    {
      throw Failure("cannot write " + this->Path + ": " + error.message());
    }
  }
}
