// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldSpace_h
#define DeformVolumeWorldSpace_h

#include "Volume.h"

#include <string>

class Messages;

/// The space of a file: what the file says itself, else what the option says ("lps", "ras", or ""
/// where it is not given), else that of the volume. A warning says so where file and option differ.
/// Throws a Failure where the option is given and the volume's own space is not known, so that
/// there is nothing to turn the file into.
WorldAxes ChooseSpace(const std::string& option, const std::string& said, const std::string& path,
  WorldAxes ofFile, WorldAxes ofVolume, Messages& messages);

#endif
