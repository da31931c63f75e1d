# SPDX-License-Identifier: BSD-3-Clause
# Plugins for another version of ParaView: three that load and check the version as the plugin does, and a library that
# does not load, because it needs a library of the other version.

function (deformvolume_add_other_version name version)
  paraview_add_plugin("${name}"
    VERSION "0"
    SOURCES "${PROJECT_SOURCE_DIR}/Plugin/VersionCheck.cxx"
    INITIALIZERS deformvolume::CheckParaViewVersion
    EXTRA_INCLUDES "${PROJECT_SOURCE_DIR}/Plugin/VersionCheck.h"
    XML_DOCUMENTATION OFF)
  target_link_libraries("${name}" PRIVATE ParaView::RemotingServerManager)
  target_compile_definitions("${name}" PRIVATE "DEFORMVOLUME_PARAVIEW_VERSION=${version}")
endfunction ()

# These plugins are not installed. The parent folder includes an install script of this folder nevertheless.
set(CMAKE_SKIP_INSTALL_RULES ON)
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/cmake_install.cmake" "# Nothing is installed from here.\n")
paraview_plugin_scan(
  PLUGIN_FILES
    "${CMAKE_CURRENT_LIST_DIR}/Major/paraview.plugin"
    "${CMAKE_CURRENT_LIST_DIR}/Minor/paraview.plugin"
    "${CMAKE_CURRENT_LIST_DIR}/Patch/paraview.plugin"
  PROVIDES_PLUGINS plugins
  ENABLE_BY_DEFAULT ON
  HIDE_PLUGINS_FROM_CACHE ON)
paraview_plugin_build(
  PLUGINS ${plugins}
  LIBRARY_SUBDIRECTORY "other-versions"
  PLUGINS_COMPONENT Testing
  TARGET_COMPONENT Testing
  INSTALL_HEADERS OFF)

file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/Missing.cxx" CONTENT "int GetMissing() { return 1; }\n")
file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/NotLoadable.cxx"
  CONTENT "int GetMissing(); int GetNothing() { return GetMissing(); }\n")
add_library(vtkRemotingCore-pv4.9 SHARED "${CMAKE_CURRENT_BINARY_DIR}/Missing.cxx")
add_library(DeformVolumeNotLoadable MODULE "${CMAKE_CURRENT_BINARY_DIR}/NotLoadable.cxx")
set_target_properties(vtkRemotingCore-pv4.9 PROPERTIES CXX_VISIBILITY_PRESET default)
target_link_libraries(DeformVolumeNotLoadable PRIVATE vtkRemotingCore-pv4.9)
# Without an RPATH, the loader does not find the library to which this one is linked.
set_target_properties(DeformVolumeNotLoadable PROPERTIES PREFIX "" SKIP_BUILD_RPATH ON)
