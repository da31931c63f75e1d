// SPDX-License-Identifier: BSD-3-Clause
#include "ProgramCache.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <dirent.h>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr char Suffix[] = ".program";
constexpr char TemporarySuffix[] = ".unfinished";
constexpr mode_t AccessOfOthers = S_IWGRP | S_IWOTH;
constexpr std::time_t LongestWrite = 3600; // seconds

/// What a file begins with; the key and the program follow. Of this machine: a file that was
/// written in another byte order does not have these magic bytes.
struct Header
{
  std::uint64_t Magic = 0x31474f5250564644; // "DFVPROG1"
  std::uint64_t KeySize = 0;
  std::uint64_t ProgramSize = 0;
  std::uint64_t Checksum = 0; // of the key and the program

  bool operator==(const Header& other) const
  {
    return this->Magic == other.Magic && this->KeySize == other.KeySize &&
      this->ProgramSize == other.ProgramSize && this->Checksum == other.Checksum;
  }
};

/// FNV-1a of 64 bits.
std::uint64_t GetChecksum(
  const void* data, std::size_t size, std::uint64_t checksum = 0xcbf29ce484222325)
{
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i)
  {
    checksum = (checksum ^ bytes[i]) * 0x100000001b3;
  }
  return checksum;
}

Header MakeHeader(const std::string& key, const std::vector<unsigned char>& program)
{
  Header header;
  header.KeySize = key.size();
  header.ProgramSize = program.size();
  header.Checksum =
    GetChecksum(program.data(), program.size(), GetChecksum(key.data(), key.size()));
  return header;
}

/// An open file; closed at the end.
class File
{
public:
  explicit File(int descriptor)
    : Descriptor(descriptor)
  {
  }
  ~File()
  {
    if (this->Descriptor >= 0)
    {
      close(this->Descriptor);
    }
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  /// A file of this user that nobody else can write, of exactly this size.
  bool IsOwn(std::uint64_t size) const
  {
    struct stat info;
    return this->Descriptor >= 0 && fstat(this->Descriptor, &info) == 0 && S_ISREG(info.st_mode) &&
      info.st_uid == geteuid() && !(info.st_mode & AccessOfOthers) &&
      static_cast<std::uint64_t>(info.st_size) == size;
  }
  bool Read(void* data, std::size_t size) const
  {
    auto* place = static_cast<char*>(data);
    for (ssize_t got = 0; size > 0; place += got, size -= static_cast<std::size_t>(got))
    {
      got = read(this->Descriptor, place, size);
      if (got <= 0)
      {
        return false;
      }
    }
    return true;
  }
  bool Write(const void* data, std::size_t size) const
  {
    const auto* place = static_cast<const char*>(data);
    for (ssize_t put = 0; size > 0; place += put, size -= static_cast<std::size_t>(put))
    {
      put = write(this->Descriptor, place, size);
      if (put <= 0)
      {
        return false;
      }
    }
    return true;
  }
  /// Marks it as used now.
  void Touch() const { futimens(this->Descriptor, nullptr); }
  bool IsOpen() const { return this->Descriptor >= 0; }

private:
  int Descriptor;
};

std::string GetEnvironment(const char* name)
{
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool EndsWith(const std::string& text, const char* end)
{
  const std::size_t size = std::strlen(end);
  return text.size() >= size && text.compare(text.size() - size, size, end) == 0;
}

/// What lies in a directory and ends so.
struct Entry
{
  std::string Path;
  std::uint64_t Size;
  timespec Time; // of the last use

  bool operator<(const Entry& other) const
  {
    return std::make_pair(this->Time.tv_sec, this->Time.tv_nsec) <
      std::make_pair(other.Time.tv_sec, other.Time.tv_nsec);
  }
};

std::vector<Entry> ListFiles(const std::string& directory, const char* suffix)
{
  std::vector<Entry> entries;
  DIR* stream = opendir(directory.c_str());
  if (!stream)
  {
    return entries;
  }
  while (const dirent* entry = readdir(stream))
  {
    const std::string path = directory + "/" + entry->d_name;
    struct stat info;
    if (EndsWith(path, suffix) && lstat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode))
    {
      entries.push_back({ path, static_cast<std::uint64_t>(info.st_size), info.st_mtim });
    }
  }
  closedir(stream);
  return entries;
}

/// Whether only this user can put files there.
bool IsOwnDirectory(const std::string& directory)
{
  struct stat info;
  return !directory.empty() && stat(directory.c_str(), &info) == 0 && S_ISDIR(info.st_mode) &&
    info.st_uid == geteuid() && !(info.st_mode & AccessOfOthers);
}

} // namespace

ProgramCache::ProgramCache(const std::string& directory, std::uint64_t limit)
  : Directory(directory)
  , Limit(limit)
{
}

std::string ProgramCache::GetDefaultDirectory()
{
  const std::string own = GetEnvironment("DEFORMVOLUME_CACHE_DIR");
  if (!own.empty())
  {
    return own == "off" ? "" : own;
  }
  const std::string cache = GetEnvironment("XDG_CACHE_HOME");
  if (!cache.empty())
  {
    return cache + "/deformvolume";
  }
  const std::string home = GetEnvironment("HOME");
  return home.empty() ? "" : home + "/.cache/deformvolume";
}

std::string ProgramCache::GetPath(const std::string& key) const
{
  char name[17];
  std::snprintf(name, sizeof(name), "%016llx",
    static_cast<unsigned long long>(GetChecksum(key.data(), key.size())));
  return this->Directory + "/" + name + Suffix;
}

bool ProgramCache::MakeDirectory() const
{
  if (this->Directory.empty())
  {
    return false;
  }
  std::error_code error;
  std::filesystem::create_directories(
    std::filesystem::path(this->Directory + "/").parent_path().parent_path(), error);
  mkdir(this->Directory.c_str(), S_IRWXU); // which fails where it is there
  return IsOwnDirectory(this->Directory);
}

std::vector<unsigned char> ProgramCache::Read(const std::string& key) const
{
  if (!IsOwnDirectory(this->Directory))
  {
    return {};
  }
  const File file(open(this->GetPath(key).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  Header header;
  if (!file.IsOpen() || !file.Read(&header, sizeof(header)) || header.KeySize != key.size() ||
    header.ProgramSize > this->Limit ||
    !file.IsOwn(sizeof(header) + header.KeySize + header.ProgramSize))
  {
    return {};
  }
  std::string itsKey(key.size(), '\0');
  std::vector<unsigned char> program(header.ProgramSize);
  if (!file.Read(itsKey.data(), itsKey.size()) || itsKey != key ||
    !file.Read(program.data(), program.size()) || !(header == MakeHeader(key, program)))
  {
    return {};
  }
  file.Touch();
  return program;
}

void ProgramCache::Write(const std::string& key, const std::vector<unsigned char>& program) const
{
  const Header header = MakeHeader(key, program);
  const std::uint64_t size = sizeof(header) + key.size() + program.size();
  if (program.empty() || size > this->Limit || !this->MakeDirectory())
  {
    return;
  }
  const std::string path = this->GetPath(key);
  std::string unfinished = path + ".XXXXXX" + TemporarySuffix;
  bool written = false;
  {
    const File file(
      mkostemps(unfinished.data(), static_cast<int>(sizeof(TemporarySuffix)) - 1, O_CLOEXEC));
    written = file.IsOpen() && file.Write(&header, sizeof(header)) &&
      file.Write(key.data(), key.size()) && file.Write(program.data(), program.size()) &&
      file.IsOwn(size);
  }
  if (!written || std::rename(unfinished.c_str(), path.c_str()) != 0)
  {
    unlink(unfinished.c_str());
  }
  this->RemoveOldest();
}

void ProgramCache::RemoveOldest() const
{
  const std::time_t now = std::time(nullptr);
  for (const Entry& entry : ListFiles(this->Directory, TemporarySuffix))
  {
    if (entry.Time.tv_sec < now - LongestWrite)
    {
      unlink(entry.Path.c_str());
    }
  }
  std::vector<Entry> entries = ListFiles(this->Directory, Suffix);
  std::sort(entries.begin(), entries.end());
  std::uint64_t size = 0;
  for (const Entry& entry : entries)
  {
    size += entry.Size;
  }
  for (std::size_t i = 0; i < entries.size() && size > this->Limit; ++i)
  {
    unlink(entries[i].Path.c_str());
    size -= entries[i].Size;
  }
}

} // namespace deformvolume
