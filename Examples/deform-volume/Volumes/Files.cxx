// SPDX-License-Identifier: BSD-3-Clause
#include "Files.h"

#include "Failure.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cerrno>
#include <unistd.h>

bool HasSuffix(const std::string& path, const std::vector<const char*>& suffixes)
{
  const std::string name = vtksys::SystemTools::LowerCase(path);
  return std::any_of(suffixes.begin(), suffixes.end(),
    [&name](const char* suffix) { return vtksys::SystemTools::StringEndsWith(name, suffix); });
}

std::string Trim(const std::string& text)
{
  const char* const space = " \t\r\n";
  const std::size_t begin = std::min(text.find_first_not_of(space), text.size());
  return text.substr(begin, text.find_last_not_of(space) + 1 - begin);
}

std::string FindReadingFault(const std::string& path, bool canBeFolder)
{
  if (access(path.c_str(), R_OK) != 0)
  {
    return errno == EACCES ? "there is no permission to read it"
      : canBeFolder        ? "there is no such file or folder"
                           : "there is no such file";
  }
  return !canBeFolder && vtksys::SystemTools::FileIsDirectory(path) ? "it is a folder" : "";
}

void CheckReadable(const std::string& path, bool canBeFolder)
{
  const std::string fault = FindReadingFault(path, canBeFolder);
  if (!fault.empty())
  {
    throw Failure("cannot read " + path + ": " + fault);
  }
}
