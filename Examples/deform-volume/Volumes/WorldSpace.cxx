// SPDX-License-Identifier: BSD-3-Clause
#include "WorldSpace.h"

#include "Failure.h"
#include "Messages.h"

WorldAxes HeedSpace(const std::string& option, const std::string& ofOption, const std::string& path,
  WorldAxes ofFile, Messages& messages)
{
  if (ofOption.empty())
  {
    return ofFile;
  }
  const WorldAxes axes =
    ofOption == "ras" ? WorldAxes::RightAnteriorSuperior : WorldAxes::LeftPosteriorSuperior;
  if (ofFile != WorldAxes::Unknown && ofFile != axes)
  {
    messages.Warn(option + " " + ofOption + " is not used: " + path + " states that it is " +
      (ofOption == "ras" ? "lps." : "ras."));
    return ofFile;
  }
  return axes;
}

WorldAxes ChooseSpace(const std::string& option, const std::string& ofOption,
  const std::string& path, WorldAxes ofFile, WorldAxes ofVolume, Messages& messages)
{
  if (!ofOption.empty() && ofVolume == WorldAxes::Unknown)
  {
    throw Failure(option + " " + ofOption +
      ": the file of the volume does not state whether its world coordinates are lps or ras, so " +
      path + " cannot be converted to them. Give --volume-space");
  }
  const WorldAxes axes = HeedSpace(option, ofOption, path, ofFile, messages);
  return axes != WorldAxes::Unknown ? axes : ofVolume;
}
