// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveArguments_h
#define DeformInteractiveArguments_h

#include "VolumeReading.h"

#include <string>
#include <vector>

/// What deform-interactive was called with.
struct Arguments
{
  std::string Volume; // "": the MRI of a head
  ReadingOptions Reading;
  std::string Session; // the rest: "" where it was not given
  std::string Record;
  std::string Replay;
  std::string Screenshot;
  std::string Frames;
  std::vector<std::string> Outputs;
  int Size[2] = { 1000, 750 };
  bool WantsHelp = false;
};

/// Throws a UsageError.
Arguments ParseArguments(int argc, char* argv[]);

extern const char* const UsageText;

#endif
