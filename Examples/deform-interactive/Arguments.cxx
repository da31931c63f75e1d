// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include "Failure.h"

#include <cstdio>
#include <map>

const char* const UsageText =
  "deform-interactive [VOLUME] [OPTIONS]\n"
  "Drags, cuts and carves a volume interactively. VOLUME is a file that deform-volume reads. "
  "Default:\n"
  "an MRI of a head (ch2 of the package mricron-data). Press h in the window for a list of "
  "keys.\n\n"
  "  --frame NUMBER         index of the volume in a file with several time steps, counted from 0\n"
  "  --session FILE.xml     load a session after the volume\n"
  "  --record FILE.log      record the events of the window\n"
  "  --replay FILE.log      replay recorded events, write the files of the options below, and "
  "exit\n"
  "  --screenshot FILE.png  write a picture of the window after the replay\n"
  "  --output FILE          write the deformed volume (.vti), its mesh (.vtu) or the session "
  "(.xml)\n"
  "                         after the replay; can be given several times\n"
  "  --frames FOLDER        write a picture of each frame of the replay: frame0000.png, ...\n"
  "  --size WIDTH,HEIGHT    size of the window, in pixels (default: 1000,750)\n"
  "  --help                 print this text, and exit\n";

Arguments ParseArguments(int argc, char* argv[])
{
  Arguments arguments;
  const std::map<std::string, std::string Arguments::*> texts{ { "--session", &Arguments::Session },
    { "--record", &Arguments::Record }, { "--replay", &Arguments::Replay },
    { "--screenshot", &Arguments::Screenshot }, { "--frames", &Arguments::Frames } };
  for (int i = 1; i < argc; ++i)
  {
    const std::string name = argv[i];
    if (name == "--help")
    {
      arguments.WantsHelp = true;
      continue;
    }
    if (name.empty() || name[0] != '-')
    {
      if (!arguments.Volume.empty())
      {
        throw UsageError("there is more than one volume: " + arguments.Volume + " and " + name);
      }
      arguments.Volume = name;
      continue;
    }
    const auto text = texts.find(name);
    if (text == texts.end() && name != "--output" && name != "--size" && name != "--frame")
    {
      throw UsageError("there is no option " + name + ". See --help");
    }
    if (i + 1 == argc)
    {
      throw UsageError(name + " needs a value");
    }
    const std::string value = argv[++i];
    if (text != texts.end())
    {
      arguments.*(text->second) = value;
    }
    else if (name == "--output")
    {
      arguments.Outputs.push_back(value);
    }
    else if (name == "--frame")
    {
      char rest = 0;
      int frame = 0;
      if (std::sscanf(value.c_str(), "%d%c", &frame, &rest) != 1 || frame < 0)
      {
        throw UsageError("--frame " + value + ": expected an integer of 0 or more");
      }
      arguments.Reading.Frame = frame;
    }
    else
    {
      char rest = 0;
      int* size = arguments.Size;
      constexpr int least = 200;
      constexpr int most = 8000;
      if (std::sscanf(value.c_str(), "%d,%d%c", &size[0], &size[1], &rest) != 2 ||
        size[0] < least || size[1] < least || size[0] > most || size[1] > most)
      {
        throw UsageError("--size " + value +
          ": expected two integers from 200 to 8000, with a comma between them");
      }
    }
  }
  const bool needsReplay =
    !arguments.Screenshot.empty() || !arguments.Frames.empty() || !arguments.Outputs.empty();
  if (needsReplay && arguments.Replay.empty())
  {
    throw UsageError("--screenshot, --frames and --output need --replay");
  }
  if (!arguments.Record.empty() && !arguments.Replay.empty())
  {
    throw UsageError("--record and --replay cannot be used together");
  }
  return arguments;
}
