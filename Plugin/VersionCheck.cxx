// SPDX-License-Identifier: BSD-3-Clause
#include "VersionCheck.h"

#include "vtkPVVersion.h"
#include "vtkSMProxyManager.h"
#include "vtkSetGet.h"

#include <string>

// Tests define other versions.
#ifndef DEFORMVOLUME_PARAVIEW_VERSION
#define DEFORMVOLUME_PARAVIEW_VERSION                                                              \
  PARAVIEW_VERSION_MAJOR, PARAVIEW_VERSION_MINOR, PARAVIEW_VERSION_PATCH
#endif

namespace deformvolume
{

void CheckParaViewVersion()
{
  const int built[3] = { DEFORMVOLUME_PARAVIEW_VERSION };
  const int running[3] = { vtkSMProxyManager::GetVersionMajor(),
    vtkSMProxyManager::GetVersionMinor(), vtkSMProxyManager::GetVersionPatch() };
  const auto text = [](const int version[3])
  {
    return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
      std::to_string(version[2]);
  };
  if (built[0] != running[0] || built[1] != running[1])
  {
    vtkErrorWithObjectMacro(
      nullptr, << "The plugin DeformVolume was built for ParaView " << text(built)
               << ", but this is ParaView " << text(running)
               << ". The plugin may fail or crash ParaView. Build the plugin for ParaView "
               << text(running) << ", or load it into ParaView " << text(built) << ".");
  }
  else if (built[2] != running[2])
  {
    vtkGenericWarningMacro("The plugin DeformVolume was built for ParaView "
      << text(built) << ", but this is ParaView " << text(running)
      << ". If the plugin fails, build it for ParaView " << text(running) << ".");
  }
}

} // namespace deformvolume
