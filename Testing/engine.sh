#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and installs the engine without VTK, and builds and runs an example with the installed files,
# in build/engine. With ccache it takes seconds if the engine has been compiled for VTK.
set -euo pipefail
cd "$(dirname "$0")/.."

bash Testing/packages.sh engine
# shellcheck disable=SC2086 # a list of words
cmake --preset engine -DBUILD_TESTING=OFF ${DEFORMVOLUME_CMAKE_OPTIONS-} >/dev/null
cmake --build --preset engine
prefix=$PWD/build/engine/prefix
rm -rf "$prefix" build/engine/minimal-kernels
cmake --install build/engine --prefix "$prefix" >/dev/null
cmake -S Examples/minimal-kernels -B build/engine/minimal-kernels -G Ninja \
  -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON >/dev/null
cmake --build build/engine/minimal-kernels
build/engine/minimal-kernels/minimal-kernels
if grep -ri 'vtk[0-9]*\.h\|libvtk' "$prefix" --include='*.h' --include='*.cmake'; then
  echo "Installed files refer to VTK"
  exit 1
fi
