// SPDX-License-Identifier: BSD-3-Clause
#include "ControlGroups.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <utility>

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
  std::ifstream file(path);
  std::int64_t number = 0;
  return file >> number ? std::optional<std::int64_t>(number) : std::nullopt;
}

std::optional<std::int64_t> ReadSum(const std::string& path, const std::vector<std::string>& keys)
{
  std::ifstream file(path);
  std::optional<std::int64_t> sum;
  std::size_t missing = keys.size();
  std::string name;
  std::string line;
  while (missing > 0 && file >> name)
  {
    std::int64_t number = 0;
    if (std::find(keys.begin(), keys.end(), name) != keys.end() && file >> number)
    {
      sum = sum.value_or(0) + number;
      --missing;
    }
    file.clear();
    std::getline(file, line);
  }
  return sum;
}

} // namespace deformvolume
