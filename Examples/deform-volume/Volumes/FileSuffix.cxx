// SPDX-License-Identifier: BSD-3-Clause
#include "FileSuffix.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>

bool HasSuffix(const std::string& path, std::initializer_list<const char*> suffixes)
{
  const std::string name = vtksys::SystemTools::LowerCase(path);
  return std::any_of(suffixes.begin(), suffixes.end(),
    [&name](const char* suffix) { return vtksys::SystemTools::StringEndsWith(name, suffix); });
}
