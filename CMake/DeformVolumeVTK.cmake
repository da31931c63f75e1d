# SPDX-License-Identifier: BSD-3-Clause
# Finds VTK or ParaView, and the Python for which VTK is wrapped.

# Without COMPONENTS, VTK and ParaView would require the development files of all their modules,
# including Qt.
set(deformvolume_vtk_components
  CommonCore
  CommonDataModel
  CommonExecutionModel
  CommonMath
  CommonSystem
  FiltersCore
  FiltersGeneral
  FiltersGeometry
  FiltersModeling
  ImagingCore
  ImagingGeneral
  ParallelCore
  vtksys)
if (NOT DEFORMVOLUME_USE_PARAVIEW)
  # For the module Interaction.
  list(APPEND deformvolume_vtk_components InteractionStyle IOXML IOXMLParser RenderingCore)
endif ()
# The components that an installed DeformVolume needs.
set(deformvolume_package_components ${deformvolume_vtk_components})
if (DEFORMVOLUME_WRAP_PYTHON)
  # Another python3 that comes first in PATH would not find the modules of the system's VTK.
  if (NOT Python3_EXECUTABLE AND EXISTS "/usr/bin/python3")
    set(Python3_EXECUTABLE "/usr/bin/python3" CACHE FILEPATH "The Python that VTK is wrapped for")
  endif ()
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
  list(APPEND deformvolume_vtk_components Python WrappingPythonCore WrappingTools)
endif ()
if (DEFORMVOLUME_BUILD_EXAMPLES OR BUILD_TESTING)
  list(APPEND deformvolume_vtk_components
    FiltersSources
    ImagingMath
    ImagingSources
    InteractionStyle
    IOGeometry
    IOImage
    IOLegacy
    IOMovie
    IOPLY
    IOXML
    IOXMLParser
    RenderingContextOpenGL2
    RenderingCore
    RenderingFreeType
    RenderingOpenGL2
    RenderingVolume
    RenderingVolumeOpenGL2
    zlib)
  if (NOT DEFORMVOLUME_USE_PARAVIEW)
    list(APPEND deformvolume_vtk_components RenderingImage) # for deform-interactive
  endif ()
elseif (DEFORMVOLUME_USE_PARAVIEW)
  # ParaView brings all targets of its VTK. Some link to X11, GLEW and FreeType, which only these
  # components find.
  list(APPEND deformvolume_vtk_components RenderingFreeType RenderingOpenGL2)
endif ()
if (BUILD_TESTING)
  list(APPEND deformvolume_vtk_components
    FiltersExtraction FiltersHybrid IOExodus TestingCore)
endif ()

# Functions of VTK 9.6 pass empty arguments, of which CMake 3.31 and later warn.
set(CMAKE_POLICY_DEFAULT_CMP0174 OLD)

if (DEFORMVOLUME_USE_PARAVIEW)
  find_package(ParaView 5.11 REQUIRED COMPONENTS RemotingCore RemotingServerManager)
endif ()
set(deformvolume_optional_vtk_components "")
if (DEFORMVOLUME_BUILD_EXAMPLES)
  # ParaView's VTK has no ImagingMorphological.
  list(APPEND deformvolume_optional_vtk_components
    ImagingMorphological hdf5 IOExodus IOHDF IOOggTheora jsoncpp)
endif ()
if (BUILD_TESTING AND NOT DEFORMVOLUME_SANITIZE)
  list(APPEND deformvolume_optional_vtk_components ParallelMPI)
endif ()
# CMake refuses optional components that are also required.
list(REMOVE_ITEM deformvolume_optional_vtk_components ${deformvolume_vtk_components})
if (deformvolume_optional_vtk_components)
  list(PREPEND deformvolume_optional_vtk_components OPTIONAL_COMPONENTS)
endif ()
find_package(VTK 9.1 REQUIRED
  COMPONENTS ${deformvolume_vtk_components}
  ${deformvolume_optional_vtk_components})
