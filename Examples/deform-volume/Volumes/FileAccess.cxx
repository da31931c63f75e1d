// SPDX-License-Identifier: BSD-3-Clause
#include "FileAccess.h"

#include <vtksys/SystemTools.hxx>

#include <cerrno>
#include <unistd.h>

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
