// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChildOutput_h
#define DeformVolumeChildOutput_h

#include <string>

#include <spawn.h>

namespace deformvolume
{

/// What a child process prints. It is read from a pseudo terminal, since a program that ends by
/// abort(), as TetGen does on every error, leaves what it printed into a pipe or a file in a buffer
/// that is lost. Where there are no pseudo terminals, as in containers without /dev/pts, a pipe has
/// to do. Throws Error where there is neither.
class ChildOutput
{
public:
  ChildOutput();
  ~ChildOutput();
  ChildOutput(const ChildOutput&) = delete;
  ChildOutput& operator=(const ChildOutput&) = delete;

  /// Makes it the standard output and the standard error of a child that is about to be started.
  void AddTo(posix_spawn_file_actions_t& actions) const;

  /// Reads what there is.
  void Read();

  bool IsTerminal() const { return !this->Name.empty(); }
  const std::string& GetText() const { return this->Text; }

private:
  bool OpenTerminal();

  int Reading = -1;
  int Writing = -1; // of a pipe
  std::string Name; // of the child's side of a terminal
  std::string Text;
};

} // namespace deformvolume

#endif
