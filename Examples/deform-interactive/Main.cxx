// SPDX-License-Identifier: BSD-3-Clause
// deform-interactive: drags, cuts and carves a volume interactively, in a window.
#include "Arguments.h"
#include "Messages.h"
#include "Picture.h"
#include "Viewer.h"

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>

#include <iostream>

int main(int argc, char* argv[])
{
  Arguments arguments;
  if (const std::optional<int> code = ParseArguments(argc, argv, arguments))
  {
    return *code;
  }
  // Messages prints errors; VTK's logger would print them a second time.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  const vtkNew<Messages> messages;
  messages->SetProgram("deform-interactive");
  vtkOutputWindow::SetInstance(messages);
  int code = 0;
  try
  {
    CheckDisplay();
    Viewer viewer(arguments, *messages);
    viewer.Run();
    messages->Check("the program ended with an error");
  }
  catch (const std::exception& error)
  {
    std::cerr << "deform-interactive: " << error.what() << "\n";
    code = 1;
  }
  vtkOutputWindow::SetInstance(nullptr);
  return code;
}
