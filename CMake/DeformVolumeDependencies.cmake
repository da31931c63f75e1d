# SPDX-License-Identifier: BSD-3-Clause
# Everything that is found outside this project, once, here.

# Components are named throughout: without them, VTK and ParaView ask for the development files of
# all their modules, Qt included.
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
  ParallelCore
  vtksys)
if (NOT DEFORMVOLUME_USE_PARAVIEW)
  # Of the module in Interaction.
  list(APPEND deformvolume_vtk_components InteractionStyle IOXML IOXMLParser RenderingCore)
endif ()
# Those that an installed DeformVolume needs.
set(deformvolume_package_components ${deformvolume_vtk_components})
if (DEFORMVOLUME_WRAP_PYTHON)
  # Another python3 that comes first on PATH would not know the modules of the system's VTK.
  if (NOT Python3_EXECUTABLE AND EXISTS "/usr/bin/python3")
    set(Python3_EXECUTABLE "/usr/bin/python3" CACHE FILEPATH "The Python that VTK is wrapped for")
  endif ()
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
  list(APPEND deformvolume_vtk_components Python WrappingPythonCore WrappingTools)
endif ()
if (DEFORMVOLUME_BUILD_EXAMPLES OR BUILD_TESTING)
  list(APPEND deformvolume_vtk_components
    FiltersSources
    ImagingGeneral
    ImagingMath
    ImagingSources
    InteractionStyle
    IOImage
    IOMovie
    IOXML
    RenderingContextOpenGL2
    RenderingCore
    RenderingFreeType
    RenderingOpenGL2
    RenderingVolume
    RenderingVolumeOpenGL2
    zlib)
  if (NOT DEFORMVOLUME_USE_PARAVIEW)
    list(APPEND deformvolume_vtk_components RenderingImage) # of deform-interactive
  endif ()
endif ()
if (BUILD_TESTING)
  list(APPEND deformvolume_vtk_components
    FiltersHybrid IOExodus IOGeometry TestingCore TestingRendering)
endif ()

# VTK 9.6's own functions pass empty arguments on, of which CMake 3.31 and later warn.
set(CMAKE_POLICY_DEFAULT_CMP0174 OLD)

if (DEFORMVOLUME_USE_PARAVIEW)
  find_package(ParaView 5.11 REQUIRED COMPONENTS RemotingCore RemotingServerManager)
endif ()
set(deformvolume_optional_vtk_components "")
if (NOT DEFORMVOLUME_USE_PARAVIEW AND NOT RenderingVolumeOpenGL2 IN_LIST deformvolume_vtk_components)
  # Of the module in Rendering.
  list(APPEND deformvolume_optional_vtk_components RenderingOpenGL2 RenderingVolumeOpenGL2)
endif ()
if (DEFORMVOLUME_BUILD_EXAMPLES)
  # ParaView's VTK has no ImagingMorphological.
  list(APPEND deformvolume_optional_vtk_components ImagingMorphological IOOggTheora)
endif ()
if (BUILD_TESTING AND NOT DEFORMVOLUME_SANITIZE)
  list(APPEND deformvolume_optional_vtk_components ParallelMPI)
endif ()
if (deformvolume_optional_vtk_components)
  list(PREPEND deformvolume_optional_vtk_components OPTIONAL_COMPONENTS)
endif ()
find_package(VTK 9.1 REQUIRED
  COMPONENTS ${deformvolume_vtk_components}
  ${deformvolume_optional_vtk_components})

if (NOT DEFORMVOLUME_USE_PARAVIEW AND TARGET VTK::RenderingVolumeOpenGL2)
  list(APPEND deformvolume_package_components RenderingOpenGL2 RenderingVolumeOpenGL2)
endif ()

find_package(glm REQUIRED)

# Version 5 says that it is not compatible with a request for version 3, though it is for this project.
find_package(Eigen3 REQUIRED NO_MODULE)
if (Eigen3_VERSION VERSION_LESS 3.3)
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is too old: 3.3 or later is needed.")
endif ()

find_program(DEFORMVOLUME_TETGEN_EXECUTABLE tetgen
  DOC "The TetGen program that vtkTetGenMesher runs by default")

# The system's OpenCL loader is asked for before those that GPU toolkits put elsewhere: theirs may
# be older and know fewer vendors.
find_library(OpenCL_LIBRARY OpenCL
  PATHS "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}" /usr/lib64 /usr/lib
  NO_DEFAULT_PATH)
find_path(OpenCL_INCLUDE_DIR CL/cl.h PATHS /usr/include NO_DEFAULT_PATH)
find_package(OpenCL 1.2 REQUIRED)
find_path(OpenCL_CXX_INCLUDE_DIR CL/opencl.hpp HINTS "${OpenCL_INCLUDE_DIR}")
mark_as_advanced(OpenCL_CXX_INCLUDE_DIR)
if (NOT OpenCL_CXX_INCLUDE_DIR)
  message(FATAL_ERROR
    "CL/opencl.hpp is missing. Install the C++ bindings of OpenCL (on Debian and Ubuntu the package "
    "opencl-clhpp-headers), or set OpenCL_CXX_INCLUDE_DIR to the folder that holds CL/opencl.hpp.")
endif ()
