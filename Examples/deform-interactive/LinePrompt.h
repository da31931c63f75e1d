// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveLinePrompt_h
#define DeformInteractiveLinePrompt_h

#include <functional>
#include <string>

/// A line that is typed in the window: the name of a file. Tab completes it, Enter takes it, Escape
/// ends without it.
class LinePrompt
{
public:
  void Begin(const std::string& question, const std::string& text,
    const std::function<void(const std::string&)>& take);
  bool IsActive() const { return this->Active; }
  void Type(char key);
  /// "" where nothing is typed.
  std::string GetLine() const;

private:
  void Complete();

  bool Active = false;
  std::string Question;
  std::string Text;
  std::function<void(const std::string&)> Take;
};

#endif
