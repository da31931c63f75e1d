// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMessages_h
#define DeformVolumeMessages_h

#include <vtkOutputWindow.h>

#include <mutex>
#include <string>

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

protected:
  Messages() = default;
  ~Messages() override = default;

private:
  Messages(const Messages&) = delete;
  void operator=(const Messages&) = delete;

  std::mutex Mutex;
  std::string FirstError;
  std::string Program = "deform-volume";
};

#endif
