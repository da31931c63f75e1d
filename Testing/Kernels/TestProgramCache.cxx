// SPDX-License-Identifier: BSD-3-Clause
// Compiled programs on disk: what is damaged, foreign or half written counts as not there, and what
// cannot be kept is no error.
#include "ProgramCache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

using deformvolume::ProgramCache;
using Program = std::vector<unsigned char>;

namespace
{

constexpr uid_t Nobody = 65534;

class Cache : public testing::Test
{
protected:
  Cache()
  {
    std::string name = testing::TempDir() + "program-cache-XXXXXX";
    this->Root = mkdtemp(name.data()) ? name : "";
    this->Directory = this->Root + "/a/b";
  }
  ~Cache() override
  {
    std::error_code error;
    std::filesystem::remove_all(this->Root, error);
  }

  ProgramCache Make(std::uint64_t limit = ProgramCache::DefaultLimit) const
  {
    return ProgramCache(this->Directory, limit);
  }
  static Program MakeProgram(std::size_t size, unsigned char first = 0)
  {
    Program program(size);
    for (std::size_t i = 0; i < size; ++i)
    {
      program[i] = static_cast<unsigned char>(first + 31 * i);
    }
    return program;
  }
  static std::string GetBytes(const std::string& path)
  {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  static void SetBytes(const std::string& path, const std::string& bytes)
  {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  }
  static mode_t GetMode(const std::string& path)
  {
    struct stat info = {};
    stat(path.c_str(), &info);
    return info.st_mode & 0777;
  }
  std::size_t CountFiles() const
  {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(this->Directory))
    {
      count += entry.is_regular_file();
    }
    return count;
  }

  std::string Root;
  std::string Directory;
  const std::string Key = "device\noptions\nsource";
  const Program Kept = MakeProgram(100);
};

} // namespace

TEST_F(Cache, NothingThere)
{
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  EXPECT_FALSE(std::filesystem::exists(this->Directory)) << "made to look into it";
}

TEST_F(Cache, WhatIsKeptIsFound)
{
  this->Make().Write(this->Key, this->Kept);
  EXPECT_EQ(this->Make().Read(this->Key), this->Kept);
  EXPECT_TRUE(this->Make().Read(this->Key + " ").empty());
  const Program other = MakeProgram(300, 7);
  this->Make().Write(this->Key, other);
  EXPECT_EQ(this->Make().Read(this->Key), other);
  EXPECT_EQ(this->CountFiles(), 1U);
}

TEST_F(Cache, EmptyProgramsAreNotKept)
{
  this->Make().Write(this->Key, {});
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
}

TEST_F(Cache, EveryDamagedByteIsSeen)
{
  this->Make().Write(this->Key, this->Kept);
  const std::string path = this->Make().GetPath(this->Key);
  const std::string bytes = GetBytes(path);
  ASSERT_GT(bytes.size(), this->Key.size() + this->Kept.size());
  for (std::size_t i = 0; i < bytes.size(); ++i)
  {
    for (const int bit : { 0, 7 })
    {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ 1 << bit);
      SetBytes(path, damaged);
      EXPECT_TRUE(this->Make().Read(this->Key).empty()) << "byte " << i << ", bit " << bit;
    }
  }
  this->Make().Write(this->Key, this->Kept);
  EXPECT_EQ(this->Make().Read(this->Key), this->Kept) << "not written anew";
}

TEST_F(Cache, EveryWrongLengthIsSeen)
{
  this->Make().Write(this->Key, this->Kept);
  const std::string path = this->Make().GetPath(this->Key);
  const std::string bytes = GetBytes(path);
  for (std::size_t size = 0; size < bytes.size(); ++size)
  {
    SetBytes(path, bytes.substr(0, size));
    EXPECT_TRUE(this->Make().Read(this->Key).empty()) << size << " bytes";
  }
  SetBytes(path, bytes + "x");
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  SetBytes(path, std::string(bytes.size(), '\xff'));
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
}

// Names are hashes, which may be the same for two keys.
TEST_F(Cache, ProgramOfAnotherKey)
{
  const std::string other = "device\noptions\nsOurce";
  this->Make().Write(other, this->Kept);
  std::filesystem::rename(this->Make().GetPath(other), this->Make().GetPath(this->Key));
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
}

TEST_F(Cache, OnlyTheUserMayRead)
{
  const mode_t mask = umask(0);
  this->Make().Write(this->Key, this->Kept);
  umask(mask);
  EXPECT_EQ(GetMode(this->Directory), 0700U);
  EXPECT_EQ(GetMode(this->Make().GetPath(this->Key)), 0600U);
}

TEST_F(Cache, WhatOthersMayWriteIsNotTrusted)
{
  this->Make().Write(this->Key, this->Kept);
  const std::string path = this->Make().GetPath(this->Key);
  chmod(path.c_str(), 0620);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  chmod(path.c_str(), 0602);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  chmod(path.c_str(), 0600);
  EXPECT_EQ(this->Make().Read(this->Key), this->Kept);
  chmod(this->Directory.c_str(), 0777);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  this->Make().Write("another", this->Kept);
  EXPECT_EQ(this->CountFiles(), 1U);
}

TEST_F(Cache, LinksAreNotFollowed)
{
  this->Make().Write(this->Key, this->Kept);
  const std::string path = this->Make().GetPath(this->Key);
  std::filesystem::rename(path, this->Root + "/elsewhere");
  std::filesystem::create_symlink(this->Root + "/elsewhere", path);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  // The link gives way, and what it leads to stays as it is.
  const std::string bytes = GetBytes(this->Root + "/elsewhere");
  this->Make().Write(this->Key, MakeProgram(50));
  EXPECT_EQ(this->Make().Read(this->Key), MakeProgram(50));
  EXPECT_EQ(GetBytes(this->Root + "/elsewhere"), bytes);
}

TEST_F(Cache, ADirectoryInTheWay)
{
  std::filesystem::create_directories(this->Make().GetPath(this->Key) + "/full");
  chmod(this->Directory.c_str(), 0700);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  this->Make().Write(this->Key, this->Kept);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  EXPECT_EQ(this->CountFiles(), 0U) << "something unfinished is left";
}

TEST_F(Cache, FilesOfOtherUsers)
{
  this->Make().Write(this->Key, this->Kept);
  const std::string path = this->Make().GetPath(this->Key);
  if (chown(path.c_str(), Nobody, Nobody) != 0)
  {
    GTEST_SKIP() << "only root can give files away";
  }
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
  ASSERT_EQ(chown(path.c_str(), geteuid(), getegid()), 0);
  ASSERT_EQ(chown(this->Directory.c_str(), Nobody, Nobody), 0);
  EXPECT_TRUE(this->Make().Read(this->Key).empty());
}

TEST_F(Cache, ReadOnlyDirectory)
{
  this->Make().Write(this->Key, this->Kept);
  chmod(this->Directory.c_str(), 0500);
  const bool isRoot = geteuid() == 0;
  if (isRoot) // who may write everywhere
  {
    chmod(this->Root.c_str(), 0755);
    for (const std::string& path :
      { this->Root + "/a", this->Directory, this->Make().GetPath(this->Key) })
    {
      ASSERT_EQ(chown(path.c_str(), Nobody, Nobody), 0);
    }
    ASSERT_EQ(seteuid(Nobody), 0);
  }
  const bool readable = access((this->Root + "/a").c_str(), X_OK) == 0;
  EXPECT_EQ(this->Make().Read(this->Key), readable ? this->Kept : Program());
  this->Make().Write(this->Key, MakeProgram(50));
  this->Make().Write("another", this->Kept);
  EXPECT_EQ(this->Make().Read(this->Key), readable ? this->Kept : Program());
  EXPECT_TRUE(this->Make().Read("another").empty());
  if (isRoot)
  {
    ASSERT_EQ(seteuid(0), 0);
  }
  chmod(this->Directory.c_str(), 0700);
  EXPECT_EQ(this->CountFiles(), 1U);
}

TEST_F(Cache, NoDirectoryAtAll)
{
  for (const char* directory : { "", "/dev/null/nothing", "/dev/null", "/proc/nothing" })
  {
    const ProgramCache cache(directory);
    cache.Write(this->Key, this->Kept);
    EXPECT_TRUE(cache.Read(this->Key).empty()) << directory;
  }
}

TEST_F(Cache, TheOldestGo)
{
  const std::uint64_t size = 10000;
  const ProgramCache cache = this->Make(4 * size + 1000);
  const auto key = [](int i) { return "key " + std::to_string(i); };
  for (int i = 0; i < 4; ++i)
  {
    cache.Write(key(i), MakeProgram(size));
    usleep(20000); // times of files are as coarse as the system's clock
  }
  EXPECT_EQ(this->CountFiles(), 4U);
  EXPECT_FALSE(cache.Read(key(0)).empty()); // so it is not the oldest
  usleep(20000);
  cache.Write(key(4), MakeProgram(size));
  EXPECT_EQ(this->CountFiles(), 4U);
  EXPECT_FALSE(cache.Read(key(0)).empty());
  EXPECT_TRUE(cache.Read(key(1)).empty());
  EXPECT_FALSE(cache.Read(key(4)).empty());
  cache.Write("too large", MakeProgram(5 * size));
  EXPECT_TRUE(cache.Read("too large").empty());
  EXPECT_EQ(this->CountFiles(), 4U);
}

TEST_F(Cache, UnfinishedFilesGo)
{
  this->Make().Write(this->Key, this->Kept);
  const std::string old = this->Make().GetPath("a") + ".123456.unfinished";
  const std::string fresh = this->Make().GetPath("b") + ".123456.unfinished";
  const std::string foreign = this->Directory + "/letter.txt";
  for (const std::string& path : { old, fresh, foreign })
  {
    SetBytes(path, "text");
  }
  const timespec times[2] = { { time(nullptr) - 10000, 0 }, { time(nullptr) - 10000, 0 } };
  utimensat(AT_FDCWD, old.c_str(), times, 0);
  utimensat(AT_FDCWD, foreign.c_str(), times, 0);
  this->Make().Write(this->Key, this->Kept);
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(fresh)) << "another process is writing it";
  EXPECT_TRUE(std::filesystem::exists(foreign)) << "not ours";
}

// Each process writes other programs of the same keys: what is read is whole, whoever wrote it.
TEST_F(Cache, SeveralProcessesAtOnce)
{
  constexpr int processes = 4;
  constexpr int rounds = 200;
  std::vector<pid_t> children;
  for (int child = 0; child < processes; ++child)
  {
    const pid_t process = fork();
    if (process == 0)
    {
      int bad = 0;
      for (int round = 0; round < rounds; ++round)
      {
        const std::string key = "key " + std::to_string(round % 3);
        const auto first = static_cast<unsigned char>(processes * (round % 3) + child);
        this->Make().Write(key, MakeProgram(50000 + first, first));
        const Program found = this->Make().Read(key);
        const bool whole = !found.empty() && found[0] / processes == round % 3 &&
          found == MakeProgram(50000 + found[0], found[0]);
        bad += !whole;
      }
      _exit(bad > 0);
    }
    ASSERT_GT(process, 0);
    children.push_back(process);
  }
  for (const pid_t child : children)
  {
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0) << "something was missing or not whole";
  }
  EXPECT_EQ(this->CountFiles(), 3U);
}

TEST_F(Cache, DefaultDirectory)
{
  const auto get = [](const char* own, const char* cache, const char* home)
  {
    setenv("DEFORMVOLUME_CACHE_DIR", own, 1);
    setenv("XDG_CACHE_HOME", cache, 1);
    setenv("HOME", home, 1);
    return ProgramCache::GetDefaultDirectory();
  };
  EXPECT_EQ(get("", "", ""), "");
  EXPECT_EQ(get("", "", "/home/me"), "/home/me/.cache/deformvolume");
  EXPECT_EQ(get("", "/cache", "/home/me"), "/cache/deformvolume");
  EXPECT_EQ(get("/own", "/cache", "/home/me"), "/own");
  EXPECT_EQ(get("off", "/cache", "/home/me"), "");
}
