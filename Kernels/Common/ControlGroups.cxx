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

bool HasWord(const std::string& list, const std::string& word)
{
  return ("," + list + ",").find("," + word + ",") != std::string::npos;
}

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
// fields, "-", type, source, options of the file system.
bool ParseMount(const std::string& line, std::string& type, std::string& options, Mount& mount)
{
  std::istringstream words(line);
  std::string skipped;
  if (!(words >> skipped >> skipped >> skipped >> mount.Group >> mount.Folder))
  {
    return false;
  }
  while (words >> skipped && skipped != "-")
  {
  }
  if (!(words >> type >> skipped >> options) || type.rfind("cgroup", 0) != 0)
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

ControlGroups FindControlGroups(const std::string& controller, const std::string& root)
{
  // Lines "number:controllers:group"; version 2 is "0::group".
  std::string unifiedGroup;
  std::string legacyGroup;
  std::string line;
  std::ifstream own(root + "/proc/self/cgroup");
  while (std::getline(own, line))
  {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos)
    {
      continue;
    }
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (controllers.empty())
    {
      unifiedGroup = line.substr(second + 1);
    }
    else if (HasWord(controllers, controller))
    {
      legacyGroup = line.substr(second + 1);
    }
  }
  ControlGroups groups;
  std::ifstream mounts(root + "/proc/self/mountinfo");
  while (std::getline(mounts, line))
  {
    std::string type;
    std::string options;
    Mount mount;
    if (!ParseMount(line, type, options, mount))
    {
      continue;
    }
    if (type == "cgroup2" && !unifiedGroup.empty() && groups.Unified.empty())
    {
      groups.Unified = ListFolders(root, mount, unifiedGroup);
    }
    else if (type == "cgroup" && HasWord(options, controller) && !legacyGroup.empty() &&
      groups.Legacy.empty())
    {
      groups.Legacy = ListFolders(root, mount, legacyGroup);
    }
  }
  return groups;
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
