# SPDX-License-Identifier: BSD-3-Clause
# Where the Python package lies, both in the build tree and in the install tree: where the system's
# Python looks when the prefix is /usr/local.

if (NOT DEFORMVOLUME_WRAP_PYTHON)
  return ()
endif ()

# Debian's Python looks into dist-packages, others into site-packages.
cmake_path(GET Python3_SITEARCH FILENAME deformvolume_python_packages)
set(DEFORMVOLUME_PYTHON_DIRECTORY
  "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/${deformvolume_python_packages}"
  CACHE STRING "Where the Python package is installed, relative to the prefix")
mark_as_advanced(DEFORMVOLUME_PYTHON_DIRECTORY)

# A build tree has the same place under a name without the version, too: build/<preset>/python.
file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/${DEFORMVOLUME_PYTHON_DIRECTORY}")
file(CREATE_LINK "${DEFORMVOLUME_PYTHON_DIRECTORY}" "${CMAKE_BINARY_DIR}/python" SYMBOLIC)
