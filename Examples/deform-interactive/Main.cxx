// SPDX-License-Identifier: BSD-3-Clause
// deform-interactive: drags, cuts and carves a volume interactively, in a window.
#include "Arguments.h"
#include "Messages.h"
#include "Picture.h"
#include "Viewer.h"

int main(int argc, char* argv[])
{
  Arguments arguments;
  if (const std::optional<int> code = ParseArguments(argc, argv, arguments))
  {
    return *code;
  }
  return RunProgram("deform-interactive",
    [&arguments](Messages& messages)
    {
      CheckDisplay();
      Viewer viewer(arguments, messages);
      viewer.Run();
    });
}
