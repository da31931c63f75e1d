// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMessages_h
#define DeformVolumeMessages_h

#include <vtkOutputWindow.h>

#include <mutex>
#include <sstream>
#include <string>
#include <vector>

/// Joins texts, numbers and manipulators of streams such as std::setprecision(3).
template <typename... Parts>
std::string MakeText(const Parts&... parts)
{
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Replaces VTK's output window. Prints each warning in one line, and keeps the first error until
/// Check() or TakeError(). Removes file names and line numbers of source code from both.
class Messages : public vtkOutputWindow
{
public:
  static Messages* New();
  vtkTypeMacro(Messages, vtkOutputWindow);

  /// Set the name of the program, with which warnings begin. Default: deform-volume.
  void SetProgram(const std::string& name) { this->Program = name; }

  /// Prints a warning.
  void Warn(const std::string& text) { this->DisplayWarningText(text.c_str()); }

  void DisplayText(const char* text) override;
  void DisplayErrorText(const char* text) override;
  void DisplayWarningText(const char* text) override;
  void DisplayGenericWarningText(const char* text) override;
  void DisplayDebugText(const char* text) override;

  /// Throws a Failure with the first error since the last call, if there was one, or if `succeeded`
  /// is false. doing: the beginning of its message, such as "cannot write FILE".
  void Check(const std::string& doing, bool succeeded = true);

  /// While a file is read, generic warnings of VTK are errors, because readers report damaged data
  /// with them. All other warnings are kept until EndReading() prints them. If there is an error,
  /// TakeError() discards the kept warnings. If the text of the error names code, TakeError()
  /// returns the first kept warning instead.
  void BeginReading();
  void EndReading();

  /// Returns the first error since the last call, or "", for callers that write their own message.
  std::string TakeError();

protected:
  Messages() = default;
  ~Messages() override = default;

private:
  Messages(const Messages&) = delete;
  void operator=(const Messages&) = delete;

  void PrintWarning(const std::string& text);

  std::mutex Mutex;
  std::string FirstError;
  bool Reads = false;
  std::vector<std::string> WaitingWarnings;
  std::string Program = "deform-volume";
};

/// Whether a text names classes or addresses, which mean nothing to users of a program.
bool NamesCode(const std::string& text);

#endif
