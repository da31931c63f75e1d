// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveArguments_h
#define DeformInteractiveArguments_h

#include "VolumeReading.h"

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
  int Size[2] = { 1000, 750 };
  bool WantsHelp = false;
};

/// Throws a UsageError if the command line is not valid.
Arguments ParseArguments(int argc, char* argv[]);

extern const char* const UsageText;

#endif
