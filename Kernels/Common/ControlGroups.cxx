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

// A mounted cgroup hierarchy: the mount point, and the control group at its root.
struct Mount
{
  std::string Folder;
  std::string Group;
};

// mountinfo escapes blanks and backslashes as a backslash and three octal digits.
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

// Parses a line of mountinfo: id, parent, device, root, mount point, options, any number of
// optional fields, "-", type, source, options of the file system. Returns false unless the type is
// cgroup2.
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

// Returns the content of a small system file, or "" if it cannot be read. System calls are faster
// than a stream, and each update reads these files.
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

// Parses the number at the start of a text, after blanks.
std::optional<std::int64_t> ParseNumber(std::string_view text)
{
  text.remove_prefix(std::min(text.find_first_not_of(Blanks), text.size()));
  std::int64_t number = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() ? std::optional<std::int64_t>(number) : std::nullopt;
}

// Lists the folders of a control group and of its parents, up to the mount point. If the mounted
// group is not a parent of this group, as in some containers, only the mount point is listed.
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
  // A line "0::group" names the group of cgroup version 2.
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
