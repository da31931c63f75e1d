// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldSpace_h
#define DeformVolumeWorldSpace_h

#include "Volume.h"

#include <string>

class Messages;

/// Returns the world axes that a file states, or else those of an option. optionName: for
/// messages. optionValue: "lps", "ras", or "" if the option is not given. Warns if the file and the
/// option differ.
WorldAxes ResolveSpace(const std::string& optionName, const std::string& optionValue,
  const std::string& path, WorldAxes ofFile, Messages& messages);

/// The same for a file that is converted to the world coordinates of a volume. If neither the file
/// nor the option states the axes, they are those of the volume. Throws a Failure if the option is
/// given and the axes of the volume are not known, because the file cannot be converted.
WorldAxes ChooseSpace(const std::string& optionName, const std::string& optionValue,
  const std::string& path, WorldAxes ofFile, WorldAxes ofVolume, Messages& messages);

#endif
