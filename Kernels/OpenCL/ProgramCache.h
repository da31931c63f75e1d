// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgramCache_h
#define DeformVolumeProgramCache_h

#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{

/// Compiled programs, a file each in a directory of the user, for later processes.
///
/// A program is found by a key: a text with everything that decides what the compiler makes. A file
/// holds its whole key and a checksum. What is damaged, incomplete, has another key, belongs to
/// another user or can be written by others counts as not there. Files are written whole under
/// another name and then renamed, so that any number of processes may use one directory. A
/// directory that cannot be used is no error: nothing is found and nothing is kept.
class ProgramCache
{
public:
  /// Bytes of all files together, before the ones that were not used for the longest time go.
  static constexpr std::uint64_t DefaultLimit = std::uint64_t{ 256 } << 20;

  /// directory: made at the first Write, for this user alone; "": nothing is kept.
  explicit ProgramCache(const std::string& directory, std::uint64_t limit = DefaultLimit);

  /// The directory of this user: the environment variable DEFORMVOLUME_CACHE_DIR, or else
  /// deformvolume in XDG_CACHE_HOME or in .cache of HOME. "" where DEFORMVOLUME_CACHE_DIR is "off",
  /// or where none of them is set.
  static std::string GetDefaultDirectory();

  /// The program of this key; empty where there is none.
  std::vector<unsigned char> Read(const std::string& key) const;

  /// Keeps a program. What goes wrong is not reported: the program is compiled again.
  void Write(const std::string& key, const std::vector<unsigned char>& program) const;

  /// Where the program of this key is kept.
  std::string GetPath(const std::string& key) const;

private:
  bool MakeDirectory() const;
  void RemoveOldest() const;

  std::string Directory;
  std::uint64_t Limit;
};

} // namespace deformvolume

#endif
