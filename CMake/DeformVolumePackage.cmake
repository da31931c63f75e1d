# SPDX-License-Identifier: BSD-3-Clause
# Installs the CMake package, with or without the VTK modules.

include(CMakePackageConfigHelpers)
configure_package_config_file(
  CMake/DeformVolumeConfig.cmake.in "${CMAKE_BINARY_DIR}/CMake/DeformVolumeConfig.cmake"
  INSTALL_DESTINATION "${deformvolume_package_directory}"
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${CMAKE_BINARY_DIR}/CMake/DeformVolumeConfigVersion.cmake"
  COMPATIBILITY "${DEFORMVOLUME_COMPATIBILITY}")
install(
  FILES
    "${CMAKE_BINARY_DIR}/CMake/DeformVolumeConfig.cmake"
    "${CMAKE_BINARY_DIR}/CMake/DeformVolumeConfigVersion.cmake"
  DESTINATION "${deformvolume_package_directory}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/licenses/DeformVolume")
