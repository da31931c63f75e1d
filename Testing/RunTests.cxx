// SPDX-License-Identifier: BSD-3-Clause
#include "RunTests.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fnmatch.h>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace
{

std::map<std::string, std::string> Arguments;
std::string Program;

std::vector<std::string> Split(const std::string& text, char separator)
{
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);)
  {
    parts.push_back(part);
  }
  return parts;
}

bool MatchesAny(const std::string& name, const std::string& patterns)
{
  const std::vector<std::string> all = Split(patterns, ':');
  return std::any_of(all.begin(), all.end(),
    [&](const std::string& pattern) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
}

/// Restricts the tests to some sources, in addition to GoogleTest's filter. Returns the name of a
/// source without tests, or an empty text.
std::string SelectFiles(const std::vector<std::string>& files)
{
  const std::string filter = GTEST_FLAG_GET(filter);
  const std::size_t minus = filter.find('-');
  const std::string wanted = minus == 0 ? "*" : filter.substr(0, minus);
  const std::string unwanted = minus == std::string::npos ? "" : filter.substr(minus + 1);
  std::vector<std::string> found;
  std::string selected;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i)
  {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j)
    {
      const testing::TestInfo& test = *suite.GetTestInfo(j);
      const std::string file = std::filesystem::path(test.file()).stem();
      if (std::find(files.begin(), files.end(), file) == files.end())
      {
        continue;
      }
      found.push_back(file);
      const std::string name = std::string(suite.name()) + "." + test.name();
      if (MatchesAny(name, wanted) && !MatchesAny(name, unwanted))
      {
        selected += name + ":";
      }
    }
  }
  GTEST_FLAG_SET(filter, selected);
  const auto missing = std::find_if(files.begin(), files.end(),
    [&](const std::string& file)
    { return std::find(found.begin(), found.end(), file) == found.end(); });
  return missing != files.end() ? *missing : "";
}

int Fail(const std::string& message)
{
  std::cerr << Program << ": " << message << "\n";
  return 2;
}

int Run(int argc, char* argv[])
{
  std::vector<std::string> files;
  std::vector<char*> others{ argv[0] };
  for (int i = 1; i < argc; ++i)
  {
    const std::string argument = argv[i];
    if (argument.rfind("--files=", 0) == 0)
    {
      files = Split(argument.substr(argument.find('=') + 1), ',');
      if (files.empty())
      {
        return Fail("--files names no source");
      }
    }
    else if ((argument == "-T" || argument == "-D" || argument == "-V") && i + 1 < argc)
    {
      Arguments[argument] = argv[++i];
    }
    else
    {
      others.push_back(argv[i]);
    }
  }
  int count = static_cast<int>(others.size());
  others.push_back(nullptr);
  testing::InitGoogleTest(&count, others.data());
  if (count > 1)
  {
    return Fail(std::string("unknown argument ") + others[1]);
  }
  std::filesystem::create_directories(GetTestArgument("-T"));
  if (!files.empty())
  {
    const std::string missing = SelectFiles(files);
    if (!missing.empty())
    {
      return Fail("no tests come from a source " + missing);
    }
  }
  const int result = RUN_ALL_TESTS();
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  if (all.test_to_run_count() == 0)
  {
    return Fail("no test was selected");
  }
  return result == 0 && all.skipped_test_count() == all.test_to_run_count() ? 125 : result;
}

} // namespace

int RunTests(int argc, char* argv[])
{
  Program = std::filesystem::path(argv[0]).filename();
  try
  {
    return Run(argc, argv);
  }
  catch (const std::exception& error)
  {
    return Fail(error.what());
  }
}

std::string GetTestArgument(const std::string& option)
{
  const auto found = Arguments.find(option);
  return found == Arguments.end() ? "." : found->second;
}
