# SPDX-License-Identifier: BSD-3-Clause
# Builds and installs the ParaView plugin. The name of its folder contains the version of ParaView,
# so that plugins for several versions can be installed together, and each ParaView finds its own.

set(deformvolume_plugin_directory
  "paraview-${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR}/plugins")

paraview_plugin_scan(
  PLUGIN_FILES "${CMAKE_CURRENT_SOURCE_DIR}/Plugin/paraview.plugin"
  PROVIDES_PLUGINS deformvolume_plugins
  REQUIRES_MODULES deformvolume_plugin_modules
  ENABLE_BY_DEFAULT ON
  HIDE_PLUGINS_FROM_CACHE ON)
paraview_plugin_build(
  PLUGINS ${deformvolume_plugins}
  AUTOLOAD ${deformvolume_plugins}
  LIBRARY_SUBDIRECTORY "${deformvolume_plugin_directory}"
  PLUGINS_COMPONENT Unspecified
  TARGET_COMPONENT Unspecified
  PLUGINS_FILE_NAME "deformvolume.plugins.xml"
  INSTALL_HEADERS OFF)
