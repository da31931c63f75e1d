// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMessages_h
#define DeformVolumeMessages_h

#include <vtkOutputWindow.h>

#include <functional>
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
  std::string Program; // with whose name warnings begin

  friend int RunProgram(const std::string&, const std::function<void(Messages&)>&);
};

/// The main function of a program: calls body with messages that replace VTK's output window.
/// Prints the exception or the error with which body ends, after the name of the program. Returns
/// the exit code: 0 or 1.
int RunProgram(const std::string& program, const std::function<void(Messages&)>& body);

/// Whether a text names classes or addresses, which mean nothing to users of a program.
bool NamesCode(const std::string& text);

#endif
