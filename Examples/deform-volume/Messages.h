// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMessages_h
#define DeformVolumeMessages_h

#include <vtkOutputWindow.h>

#include <mutex>
#include <string>
#include <vector>

/// Takes the place of VTK's output window: prints warnings in one line each, and keeps the first
/// error, without the places in the source code, until it is asked for.
class Messages : public vtkOutputWindow
{
public:
  static Messages* New();
  vtkTypeMacro(Messages, vtkOutputWindow);

  /// What warnings begin with.
  void SetProgram(const std::string& name) { this->Program = name; }

  void DisplayText(const char* text) override;
  void DisplayErrorText(const char* text) override;
  void DisplayWarningText(const char* text) override;
  void DisplayGenericWarningText(const char* text) override;
  void DisplayDebugText(const char* text) override;

  /// Throws a Failure with the first error since the last call, if there was one. doing: what was
  /// being done, for an algorithm that gave nothing without saying why.
  void Check(const std::string& doing, bool succeeded = true);

  /// While a file is read, warnings that no object of VTK gives are errors, as readers give them of
  /// damaged data; the others wait, and are words of an error that follows.
  void BeginReading();
  void EndReading();

  /// The first error since the last call, "" where there was none, for a caller that has words of
  /// its own.
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

/// Whether a text names classes or addresses, which users of a program do not know.
bool NamesCode(const std::string& text);

#endif
