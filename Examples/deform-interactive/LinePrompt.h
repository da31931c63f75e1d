// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveLinePrompt_h
#define DeformInteractiveLinePrompt_h

#include <functional>
#include <string>

/// A prompt in the window, into which a file name is typed. Tab completes the name, Enter accepts
/// it, Escape cancels.
class LinePrompt
{
public:
  /// Activates the prompt. text: initial name. take: called with the name that Enter accepts.
  void Begin(const std::string& question, const std::string& text,
    const std::function<void(const std::string&)>& take);
  bool IsActive() const { return this->Active; }
  void Type(char key);
  /// The text to draw; "" if the prompt is not active.
  std::string GetLine() const;

private:
  void Complete();

  bool Active = false;
  std::string Question;
  std::string Text;
  std::function<void(const std::string&)> Take;
};

#endif
