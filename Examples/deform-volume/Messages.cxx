// SPDX-License-Identifier: BSD-3-Clause
#include "Messages.h"

#include "Failure.h"

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>

#include <iostream>
#include <regex>

namespace
{
// "ERROR: In file.cxx, line 12\nvtkClass (0x1234): text" -> "text"
std::string StripLocation(const std::string& text)
{
  static const std::regex location(
    "^\\s*(ERROR|Warning|Generic Warning|Debug):? In .*, line [0-9]+\\n"
    "([A-Za-z0-9_]+ \\(0x[0-9a-f]+\\): )?");
  std::string message =
    std::regex_replace(text, location, "", std::regex_constants::format_first_only);
  message.erase(message.find_last_not_of(" \n") + 1);
  return message;
}
}

vtkStandardNewMacro(Messages);

void Messages::DisplayText(const char* text)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::cerr << text;
}

void Messages::DisplayErrorText(const char* text)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (this->FirstError.empty())
  {
    this->FirstError = StripLocation(text);
  }
}

void Messages::DisplayWarningText(const char* text)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (this->Reads)
  {
    this->WaitingWarnings.push_back(StripLocation(text));
  }
  else
  {
    this->PrintWarning(StripLocation(text));
  }
}

void Messages::DisplayGenericWarningText(const char* text)
{
  this->Reads ? this->DisplayErrorText(text) : this->DisplayWarningText(text);
}

void Messages::DisplayDebugText(const char* text)
{
  this->DisplayText(text);
}

void Messages::PrintWarning(const std::string& text)
{
  std::cerr << this->Program << ": warning: " << text << "\n";
}

void Messages::BeginReading()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Reads = true;
}

void Messages::EndReading()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Reads = false;
  for (const std::string& warning : this->WaitingWarnings)
  {
    this->PrintWarning(warning);
  }
  this->WaitingWarnings.clear();
}

std::string Messages::TakeError()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::string error;
  error.swap(this->FirstError);
  if (!error.empty() && !this->WaitingWarnings.empty())
  {
    error = NamesCode(error) ? this->WaitingWarnings.front() : error;
    this->WaitingWarnings.clear();
  }
  return error;
}

bool NamesCode(const std::string& text)
{
  static const std::regex code("vtk[A-Z]|0x[0-9a-f]|::");
  return std::regex_search(text, code);
}

void Messages::Check(const std::string& doing, bool succeeded)
{
  const std::string error = this->TakeError();
  if (!error.empty())
  {
    throw Failure(doing + ": " + error);
  }
  if (!succeeded)
  {
    throw Failure(doing + ": no reason was reported. Is there enough free disk space?");
  }
}

int RunProgram(const std::string& program, const std::function<void(Messages&)>& body)
{
  // Messages keeps errors for the catch block; VTK's logger would print them a second time.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  const vtkNew<Messages> messages;
  messages->Program = program;
  vtkOutputWindow::SetInstance(messages);
  int code = 0;
  try
  {
    body(*messages);
    messages->Check("the program ended with an error");
  }
  catch (const std::exception& error)
  {
    std::cerr << program << ": " << error.what() << "\n";
    code = 1;
  }
  vtkOutputWindow::SetInstance(nullptr);
  return code;
}
