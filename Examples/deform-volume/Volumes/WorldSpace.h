// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldSpace_h
#define DeformVolumeWorldSpace_h

#include "Volume.h"

#include <string>

class Messages;

/// The space of a file that says it itself, or else what the option says: "lps", "ras", or "" where
/// it is not given. A warning says so where they differ.
WorldAxes HeedSpace(const std::string& option, const std::string& said, const std::string& path,
  WorldAxes ofFile, Messages& messages);

/// The same for a file that is turned into the world of a volume, which is its space where nothing
/// else says it. Throws a Failure where the option is given and the volume's own space is not
/// known, so that there is nothing to turn the file into.
WorldAxes ChooseSpace(const std::string& option, const std::string& said, const std::string& path,
  WorldAxes ofFile, WorldAxes ofVolume, Messages& messages);

#endif
