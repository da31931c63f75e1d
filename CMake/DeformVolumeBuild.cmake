# SPDX-License-Identifier: BSD-3-Clause
# Builds the VTK modules, wraps them for Python, and installs both.

set(deformvolume_module_files "${CMAKE_CURRENT_SOURCE_DIR}/vtk.module")
set(deformvolume_requested_modules DeformVolume::Filters)
if (NOT DEFORMVOLUME_USE_PARAVIEW)
  # ParaView has its own views and interaction.
  list(APPEND deformvolume_module_files "${CMAKE_CURRENT_SOURCE_DIR}/Interaction/vtk.module")
  list(APPEND deformvolume_requested_modules DeformVolume::Interaction)
endif ()
vtk_module_scan(
  MODULE_FILES ${deformvolume_module_files}
  REQUEST_MODULES ${deformvolume_requested_modules}
  PROVIDES_MODULES deformvolume_modules
  ENABLE_TESTS OFF)

# vtk_module_build() adds the directory of a module by its path relative to CMAKE_SOURCE_DIR. For a
# module at the root that path would be empty. In this function, CMAKE_SOURCE_DIR is therefore a
# subfolder: the path is then "..", and the build directory of the module is <build>/Module.
function (deformvolume_build_module)
  string(APPEND CMAKE_SOURCE_DIR "/CMake")
  string(APPEND CMAKE_BINARY_DIR "/Module/CMake")
  vtk_module_build(
    MODULES ${deformvolume_modules}
    PACKAGE DeformVolume
    VERSION "${PROJECT_VERSION}"
    SOVERSION "${DEFORMVOLUME_SOVERSION}"
    INSTALL_EXPORT DeformVolume
    CMAKE_DESTINATION "${deformvolume_package_directory}"
    HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/deformvolume"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    TEST_DIRECTORY_NAME NONE)
endfunction ()
deformvolume_build_module()

if (DEFORMVOLUME_WRAP_PYTHON)
  vtk_module_wrap_python(
    MODULES ${deformvolume_modules}
    TARGET DeformVolume::PythonModule
    PYTHON_PACKAGE deformvolume_vtk
    MODULE_DESTINATION "${DEFORMVOLUME_PYTHON_DIRECTORY}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    CMAKE_DESTINATION "${deformvolume_package_directory}"
    INSTALL_HEADERS OFF
    BUILD_STATIC OFF)
  set(deformvolume_python_imports "from .vtkDeformVolume import *")
  if (TARGET DeformVolume::Interaction)
    string(APPEND deformvolume_python_imports "\nfrom .vtkDeformVolumeInteraction import *")
  endif ()
  set(deformvolume_python_package
    "${CMAKE_BINARY_DIR}/${DEFORMVOLUME_PYTHON_DIRECTORY}/deformvolume_vtk/__init__.py")
  configure_file(
    "${CMAKE_CURRENT_SOURCE_DIR}/Python/__init__.py.in" "${deformvolume_python_package}" @ONLY)
  install(
    FILES "${deformvolume_python_package}"
    DESTINATION "${DEFORMVOLUME_PYTHON_DIRECTORY}/deformvolume_vtk")
endif ()
