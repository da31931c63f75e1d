# SPDX-License-Identifier: BSD-3-Clause
# A toolchain for libraries for all Linux systems on x86-64 with glibc 2.28 or later: the compiler of
# the PyPI package ziglang, with libc++ linked statically. Python/wheel.sh sets two environment
# variables: DEFORMVOLUME_ZIG is the path of the program zig. DEFORMVOLUME_ZIG_PREFIX is a folder that
# contains only GLM, Eigen and the headers of OpenCL. /usr/include cannot be used for them, because it
# contains the headers of another C library as well.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
foreach (variable IN ITEMS DEFORMVOLUME_ZIG DEFORMVOLUME_ZIG_PREFIX)
  if (NOT EXISTS "$ENV{${variable}}")
    message(FATAL_ERROR "The environment variable ${variable} names nothing that exists.")
  endif ()
endforeach ()
set(CMAKE_C_COMPILER "$ENV{DEFORMVOLUME_ZIG}" cc)
set(CMAKE_CXX_COMPILER "$ENV{DEFORMVOLUME_ZIG}" c++)
foreach (language IN ITEMS C CXX)
  set(CMAKE_${language}_FLAGS_INIT
    "-target x86_64-linux-gnu.2.28 -ffunction-sections -fdata-sections")
endforeach ()
set(CMAKE_SHARED_LINKER_FLAGS_INIT "-Wl,--gc-sections -s")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections -s")

set(CMAKE_PREFIX_PATH "$ENV{DEFORMVOLUME_ZIG_PREFIX}")
set(CMAKE_FIND_USE_CMAKE_SYSTEM_PATH FALSE)
