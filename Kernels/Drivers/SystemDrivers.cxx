// SPDX-License-Identifier: BSD-3-Clause
#include "SystemDrivers.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace deformvolume
{
namespace
{

const char* const Vendors = "/etc/OpenCL/vendors";

std::string GetVariable(const char* name)
{
  const char* const value = secure_getenv(name);
  return value ? value : "";
}

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void AddFromFile(const std::string& file, std::vector<std::string>& libraries)
{
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  const char* const blank = " \t\r";
  const std::size_t begin = line.find_first_not_of(blank);
  if (begin != std::string::npos)
  {
    libraries.push_back(line.substr(begin, line.find_last_not_of(blank) - begin + 1));
  }
}

void AddFromFolder(const std::string& folder, std::vector<std::string>& libraries)
{
  std::vector<std::string> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; entry != end;
       entry.increment(error))
  {
    if (EndsWith(entry->path().string(), ".icd"))
    {
      files.push_back(entry->path().string());
    }
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files)
  {
    AddFromFile(file, libraries);
  }
}

} // namespace

std::vector<std::string> FindSystemDrivers()
{
  std::vector<std::string> libraries;
  std::istringstream names(GetVariable("OCL_ICD_FILENAMES"));
  for (std::string name; std::getline(names, name, ':');)
  {
    if (!name.empty())
    {
      libraries.push_back(name);
    }
  }
  std::string vendors = GetVariable("OCL_ICD_VENDORS");
  if (vendors.empty())
  {
    const std::string folder = GetVariable("OPENCL_VENDOR_PATH");
    AddFromFolder(folder.empty() ? Vendors : folder, libraries);
    return libraries;
  }
  std::error_code error;
  if (std::filesystem::is_directory(vendors, error))
  {
    AddFromFolder(vendors, libraries);
  }
  else if (EndsWith(vendors, ".icd"))
  {
    if (vendors.find('/') == std::string::npos && !std::filesystem::exists(vendors, error))
    {
      vendors = std::string(Vendors) + "/" + vendors;
    }
    AddFromFile(vendors, libraries);
  }
  else
  {
    libraries.push_back(vendors);
  }
  return libraries;
}

} // namespace deformvolume
