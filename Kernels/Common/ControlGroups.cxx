// SPDX-License-Identifier: BSD-3-Clause
#include "ControlGroups.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace deformvolume
{

namespace
{

// Where a hierarchy of groups is mounted, and which of its groups is to be seen there.
struct Mount
{
  std::string Folder;
  std::string Group;
};

// Spaces and the like are written as a backslash and three octal digits.
std::string Unescape(const std::string& text)
{
  constexpr std::size_t length = 4;
  std::string plain;
  for (std::size_t at = 0; at < text.size(); ++at)
  {
    if (text[at] == '\\' && at + length <= text.size())
    {
      plain += static_cast<char>(std::stoi(text.substr(at + 1, length - 1), nullptr, 8));
      at += length - 1;
    }
    else
    {
      plain += text[at];
    }
  }
  return plain;
}

// A line of mountinfo: id, parent, device, root, mount point, options, any number of optional
// fields, "-", type, source, options of the file system. False where it is no mount of groups.
bool ParseMount(const std::string& line, Mount& mount)
{
  std::istringstream words(line);
  std::string skipped;
  std::string type;
  if (!(words >> skipped >> skipped >> skipped >> mount.Group >> mount.Folder))
  {
    return false;
  }
  while (words >> skipped && skipped != "-")
  {
  }
  if (!(words >> type) || type != "cgroup2")
  {
    return false;
  }
  mount.Group = Unescape(mount.Group);
  mount.Folder = Unescape(mount.Folder);
  return true;
}

constexpr const char* Blanks = " \t\n";

// The whole of a small file of the system; empty where it cannot be read. Without a stream: these
// files are read at each update.
std::string ReadFile(const std::string& path)
{
  std::string text;
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0)
  {
    return text;
  }
  std::array<char, 4096> part;
  for (ssize_t count = 0; (count = read(file, part.data(), part.size())) > 0;)
  {
    text.append(part.data(), static_cast<std::size_t>(count));
  }
  close(file);
  return text;
}

// The number that a text begins with, after blanks.
std::optional<std::int64_t> ParseNumber(std::string_view text)
{
  text.remove_prefix(std::min(text.find_first_not_of(Blanks), text.size()));
  std::int64_t number = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() ? std::optional<std::int64_t>(number) : std::nullopt;
}

// The folders from that of a group up to that of the mount. A group that is not below the group of
// the mount cannot be seen; its limits are then those of the mount itself, as in containers.
std::vector<std::string> ListFolders(
  const std::string& root, const Mount& mount, const std::string& group)
{
  const std::string top = mount.Group == "/" ? "" : mount.Group;
  std::string below;
  if (group.rfind(top + "/", 0) == 0 && group.find("/..") == std::string::npos)
  {
    below = group.substr(top.size());
  }
  std::vector<std::string> folders;
  while (below.size() > 1)
  {
    folders.push_back(root + mount.Folder + below);
    below.resize(below.rfind('/'));
  }
  folders.push_back(root + mount.Folder);
  return folders;
}

} // namespace

std::vector<std::string> FindControlGroups(const std::string& root)
{
  // The line "0::group"; others are of version 1.
  std::string group;
  std::string line;
  std::ifstream own(root + "/proc/self/cgroup");
  while (group.empty() && std::getline(own, line))
  {
    group = line.rfind("0::", 0) == 0 ? line.substr(3) : "";
  }
  std::ifstream mounts(root + "/proc/self/mountinfo");
  while (!group.empty() && std::getline(mounts, line))
  {
    Mount mount;
    if (ParseMount(line, mount))
    {
      return ListFolders(root, mount, group);
    }
  }
  return {};
}

std::optional<std::int64_t> ReadNumber(const std::string& path)
{
  return ParseNumber(ReadFile(path));
}

std::optional<std::int64_t> ReadSum(const std::string& path, const std::vector<std::string>& keys)
{
  const std::string text = ReadFile(path);
  std::optional<std::int64_t> sum;
  std::size_t missing = keys.size();
  for (std::string_view rest = text; missing > 0 && !rest.empty();)
  {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::size_t end = line.find_first_of(Blanks);
    if (end != std::string_view::npos &&
      std::find(keys.begin(), keys.end(), line.substr(0, end)) != keys.end())
    {
      if (const auto number = ParseNumber(line.substr(end)))
      {
        sum = sum.value_or(0) + *number;
        --missing;
      }
    }
  }
  return sum;
}

} // namespace deformvolume
