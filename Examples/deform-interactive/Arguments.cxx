// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <CLI/CLI.hpp>

#include <iostream>
#include <limits>

std::optional<int> ParseArguments(int argc, char* argv[], Arguments& arguments)
{
  CLI::App program("Drags, cuts and carves a volume interactively. Press h in the window for a "
                   "list of keys.\n",
    "deform-interactive");
  const auto add = [&program](
                     const char* name, auto& value, const char* type, const std::string& help)
  { return program.add_option(name, value, help)->type_name(type); };
  add("VOLUME", arguments.Volume, "FILE",
    std::string("The volume: ") + ReadFormats +
      " [an MRI of a head, ch2 of the package mricron-data]");
  add("--frame", arguments.Reading.Frame, "NUMBER",
    "Index of the volume in a file with several time steps, counted from 0")
    ->check(CLI::Range(0, std::numeric_limits<int>::max(), "0 or more"));
  add("--session", arguments.Session, "FILE.xml", "Load a session after the volume");
  CLI::Option* record =
    add("--record", arguments.Record, "FILE.log", "Record the events of the window");
  CLI::Option* replay = add("--replay", arguments.Replay, "FILE.log",
    "Replay recorded events, write the files of the options below, and exit");
  record->excludes(replay);
  add("--screenshot", arguments.Screenshot, "FILE.png",
    "Write a picture of the window after the replay")
    ->needs(replay);
  add("--output", arguments.Outputs, "FILE",
    "Write the deformed volume (.vti), its mesh (.vtu) or the session (.xml) after the replay. May "
    "be given several times")
    ->take_all()
    ->expected(1)
    ->allow_extra_args(false)
    ->needs(replay);
  add("--frames", arguments.Frames, "FOLDER",
    "Write a picture of each frame of the replay: frame0000.png, ...")
    ->needs(replay);
  add("--size", arguments.Size, "WIDTH,HEIGHT", "Size of the window, in pixels [1000,750]")
    ->delimiter(',')
    ->check(CLI::Range(200, 8000, "200 to 8000"));
  program.set_version_flag("--version", "deform-interactive " DEFORMVOLUME_VERSION);
  try
  {
    program.parse(argc, argv);
  }
  catch (const CLI::Success& request) // --help or --version
  {
    return program.exit(request);
  }
  catch (const CLI::ParseError& error)
  {
    std::cerr << "deform-interactive: " << error.what() << "\n";
    return 2;
  }
  return std::nullopt;
}
