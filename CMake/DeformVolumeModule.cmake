# SPDX-License-Identifier: BSD-3-Clause
# The VTK module: what it is made of.

# Wrapped for Python and installed.
set(classes
  vtkDeformVolumeFilter
  vtkLatticeTetrahedraSource
  vtkTetGenMesher)

# Helpers of the classes: neither wrapped nor installed.
set(helpers
  BodySurface
  CellSplit
  ClosedSurface
  Deformation
  DeformationMesh
  DeformedBounds
  DeviceSession
  ImageGeometry
  InputUpdate
  LinkExtrapolation
  MappingCache
  OutputExtent
  StaticMapping
  TetGenProcess
  TetrahedronClipping
  VectorArray
  VolumeArrays
  vtkDeformVolumeFilterInternals)

foreach (list IN ITEMS classes helpers)
  list(TRANSFORM ${list} PREPEND "Filters/")
  foreach (class IN LISTS ${list})
    if (NOT EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${class}.cxx")
      message(WARNING "skipped: ${class}.cxx")
      list(REMOVE_ITEM ${list} ${class})
    endif ()
  endforeach ()
endforeach ()

vtk_module_add_module(DeformVolume::Filters
  CLASSES ${classes}
  PRIVATE_CLASSES ${helpers})
vtk_module_include(DeformVolume::Filters
  PUBLIC "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/Filters>"
  PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}/Kernels")
vtk_module_link(DeformVolume::Filters PRIVATE DeformVolumeKernels glm::glm)
vtk_module_compile_options(DeformVolume::Filters PRIVATE
  $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-Wall;-Wextra;-ffp-contract=off>)

# TetGen is a program that runs as a process of its own; it need not be there at build time.
if (DEFORMVOLUME_TETGEN_EXECUTABLE)
  set_source_files_properties(Filters/vtkTetGenMesher.cxx PROPERTIES
    COMPILE_DEFINITIONS "DEFORMVOLUME_TETGEN_EXECUTABLE=\"${DEFORMVOLUME_TETGEN_EXECUTABLE}\"")
endif ()
