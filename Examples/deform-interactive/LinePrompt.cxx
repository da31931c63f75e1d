// SPDX-License-Identifier: BSD-3-Clause
#include "LinePrompt.h"

#include <vtksys/Directory.hxx>
#include <vtksys/SystemTools.hxx>

#include <algorithm>

void LinePrompt::Begin(const std::string& question, const std::string& text,
  const std::function<void(const std::string&)>& take)
{
  this->Active = true;
  this->Question = question;
  this->Text = text;
  this->Take = take;
}

std::string LinePrompt::GetLine() const
{
  return this->Active ? this->Question + ": " + this->Text + "_  (Enter, Tab, Escape)" : "";
}

void LinePrompt::Type(char key)
{
  constexpr char backspace = 8;
  constexpr char tab = 9;
  constexpr char enter = 13;
  constexpr char escape = 27;
  constexpr char remove = 127;
  switch (key)
  {
    case backspace:
    case remove:
      if (!this->Text.empty())
      {
        this->Text.pop_back();
      }
      break;
    case tab:
      this->Complete();
      break;
    case escape:
      this->Active = false;
      break;
    case enter:
    {
      this->Active = false;
      const std::string text = this->Text;
      if (!text.empty())
      {
        this->Take(text);
      }
      break;
    }
    default:
      if (static_cast<unsigned char>(key) >= ' ')
      {
        this->Text += key;
      }
  }
}

// Extends the text to the longest common prefix of all file names that begin with it.
void LinePrompt::Complete()
{
  using vtksys::SystemTools;
  const std::size_t slash = this->Text.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : this->Text.substr(0, slash + 1);
  const std::string begin = this->Text.substr(folder.size());
  vtksys::Directory directory;
  if (!directory.Load(folder.empty() ? "." : folder))
  {
    return;
  }
  std::string common;
  int found = 0;
  for (unsigned long i = 0; i < directory.GetNumberOfFiles(); ++i)
  {
    const std::string name = directory.GetFile(i);
    if (name == "." || name == ".." || !SystemTools::StringStartsWith(name, begin.c_str()))
    {
      continue;
    }
    const auto end = std::mismatch(common.begin(), common.end(), name.begin(), name.end()).first;
    common = found == 0 ? name : std::string(common.begin(), end);
    ++found;
  }
  if (found > 0)
  {
    this->Text = folder + common;
    this->Text += found == 1 && SystemTools::FileIsDirectory(this->Text) ? "/" : "";
  }
}
