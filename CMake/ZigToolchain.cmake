# SPDX-License-Identifier: BSD-3-Clause
# A toolchain for libraries that run on all Linux systems on x86-64 since glibc 2.28: the compiler of
# the package ziglang from PyPI, with libc++ linked statically. The environment variable
# DEFORMVOLUME_ZIG is the path of its program zig, and DEFORMVOLUME_ZIG_PREFIX a folder with GLM, Eigen
# and the headers of OpenCL alone, as /usr/include has those of another C library, too. Python/wheel.sh
# makes both.
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
