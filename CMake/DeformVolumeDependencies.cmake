# SPDX-License-Identifier: BSD-3-Clause
# Finds the dependencies of this project.

if (DEFORMVOLUME_BUILD_MODULE)
  include(DeformVolumeVTK)
endif ()

find_package(glm REQUIRED)

# Without a version, because the package of Eigen 5 refuses a request for version 3. Eigen 5 can be
# used as well.
find_package(Eigen3 REQUIRED NO_MODULE)
if (Eigen3_VERSION VERSION_LESS 3.3)
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is too old: 3.3 or later is needed.")
endif ()

find_program(DEFORMVOLUME_TETGEN_EXECUTABLE tetgen
  DOC "The TetGen program that vtkTetGenMesher runs by default")

# The OpenCL loader of the system comes first: the loaders of GPU toolkits may be older, and support
# fewer vendors.
if (DEFORMVOLUME_USE_OPENCL_LOADER)
  find_library(OpenCL_LIBRARY OpenCL
    PATHS "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}" /usr/lib64 /usr/lib
    NO_DEFAULT_PATH)
  find_path(OpenCL_INCLUDE_DIR CL/cl.h PATHS /usr/include NO_DEFAULT_PATH)
  find_package(OpenCL 1.2 REQUIRED)
  set(deformvolume_opencl OpenCL::OpenCL ${CMAKE_DL_LIBS})
else ()
  # The engine loads the drivers itself, and needs only headers.
  find_path(OpenCL_INCLUDE_DIR CL/cl_icd.h REQUIRED)
  mark_as_advanced(OpenCL_INCLUDE_DIR)
  set(deformvolume_opencl ${CMAKE_DL_LIBS})
endif ()
find_path(OpenCL_CXX_INCLUDE_DIR CL/opencl.hpp HINTS "${OpenCL_INCLUDE_DIR}")
mark_as_advanced(OpenCL_CXX_INCLUDE_DIR)
if (NOT OpenCL_CXX_INCLUDE_DIR)
  message(FATAL_ERROR
    "CL/opencl.hpp is missing. Install the C++ bindings of OpenCL (on Debian and Ubuntu the package "
    "opencl-clhpp-headers), or set OpenCL_CXX_INCLUDE_DIR to the folder that holds CL/opencl.hpp.")
endif ()
