// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveArguments_h
#define DeformInteractiveArguments_h

#include "VolumeReading.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

/// The command line of deform-interactive.
struct Arguments
{
  std::string Volume; // "": the MRI of a head
  ReadingOptions Reading;
  std::string Session; // this option and the following ones: "" if they are not given
  std::string Record;
  std::string Replay;
  std::string Screenshot;
  std::string Frames;
  std::vector<std::string> Outputs;
  std::array<int, 2> Size{ { 1000, 750 } };
};

/// Parses the command line. Returns an exit code if the program must exit: 0 after --help, 2 after
/// an error message about the command line.
std::optional<int> ParseArguments(int argc, char* argv[], Arguments& arguments);

#endif
