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
  CoarseVolume
  Deformation
  DeformationMesh
  DeformedBounds
  DeviceSession
  FailureReport
  ImageGeometry
  InputUpdate
  LinkExtrapolation
  MappingCache
  MeshBounds
  MeshGathering
  OutputArrays
  OutputExtent
  Ranks
  ResamplerChoice
  RestRegions
  RunBuilder
  StaticMapping
  TetGenProcess
  TetrahedronClipping
  TetrahedronTiles
  VectorArray
  VolumeArrays
  VoxelLinker
  vtkDeformVolumeFilterInternals)

list(TRANSFORM classes PREPEND "Filters/")
list(TRANSFORM helpers PREPEND "Filters/")
vtk_module_add_module(DeformVolume::Filters
  CLASSES ${classes}
  PRIVATE_CLASSES ${helpers}
  SOURCES
    Filters/vtkDeformVolumeFilterParts.cxx
    Filters/vtkDeformVolumeFilterRequests.cxx)
vtk_module_include(DeformVolume::Filters
  PUBLIC "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/Filters>"
  PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}/Kernels")
vtk_module_link(DeformVolume::Filters PRIVATE DeformVolumeKernels glm::glm)
vtk_module_compile_options(DeformVolume::Filters PRIVATE
  ${DEFORMVOLUME_COMPILE_OPTIONS})
if (CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang" AND NOT APPLE AND NOT DEFORMVOLUME_SANITIZE)
  # A missing symbol shows when the library is linked rather than when it is loaded.
  vtk_module_link_options(DeformVolume::Filters PRIVATE "LINKER:--no-undefined")
endif ()

# TetGen is a program that runs as a process of its own; it need not be there at build time.
if (DEFORMVOLUME_TETGEN_EXECUTABLE)
  set_source_files_properties(Filters/vtkTetGenMesher.cxx PROPERTIES
    COMPILE_DEFINITIONS "DEFORMVOLUME_TETGEN_EXECUTABLE=\"${DEFORMVOLUME_TETGEN_EXECUTABLE}\"")
endif ()
