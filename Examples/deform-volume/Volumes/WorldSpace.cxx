// SPDX-License-Identifier: BSD-3-Clause
#include "WorldSpace.h"

#include "Failure.h"
#include "Messages.h"

WorldAxes ResolveSpace(const std::string& optionName, const std::string& optionValue,
  const std::string& path, WorldAxes ofFile, Messages& messages)
{
  if (optionValue.empty())
  {
    return ofFile;
  }
  const WorldAxes axes =
    optionValue == "ras" ? WorldAxes::RightAnteriorSuperior : WorldAxes::LeftPosteriorSuperior;
  if (ofFile != WorldAxes::Unknown && ofFile != axes)
  {
    messages.Warn(optionName + " " + optionValue + " is not used: " + path + " states that it is " +
      (optionValue == "ras" ? "lps." : "ras."));
    return ofFile;
  }
  return axes;
}

WorldAxes ChooseSpace(const std::string& optionName, const std::string& optionValue,
  const std::string& path, WorldAxes ofFile, WorldAxes ofVolume, Messages& messages)
{
  if (!optionValue.empty() && ofVolume == WorldAxes::Unknown)
  {
    throw Failure(optionName + " " + optionValue +
      ": the file of the volume does not state whether its world coordinates are lps or ras, so " +
      path + " cannot be converted to them. Give --volume-space");
  }
  const WorldAxes axes = ResolveSpace(optionName, optionValue, path, ofFile, messages);
  return axes != WorldAxes::Unknown ? axes : ofVolume;
}
