# SPDX-License-Identifier: BSD-3-Clause
# Sets the directory of the Python package in the build tree and in the install tree. With the prefix
# /usr/local, the Python of the system finds the package there.

if (NOT DEFORMVOLUME_WRAP_PYTHON)
  return ()
endif ()

# Debian's Python searches dist-packages, other ones search site-packages.
cmake_path(GET Python3_SITEARCH FILENAME deformvolume_python_packages)
set(DEFORMVOLUME_PYTHON_DIRECTORY
  "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/${deformvolume_python_packages}"
  CACHE STRING "Where the Python package is installed, relative to the prefix")
mark_as_advanced(DEFORMVOLUME_PYTHON_DIRECTORY)

# In the build tree, build/<preset>/python is a link to that directory.
file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/${DEFORMVOLUME_PYTHON_DIRECTORY}")
file(CREATE_LINK "${DEFORMVOLUME_PYTHON_DIRECTORY}" "${CMAKE_BINARY_DIR}/python" SYMBOLIC)
