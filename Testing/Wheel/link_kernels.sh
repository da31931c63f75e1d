#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Links all kernels with the linker of the Python package and PoCL of the package
# pocl-binary-distribution: see link_kernels.py. The programs are those of the preset vtk, or of the build
# directory in DEFORMVOLUME_BUILD. PoCL is downloaded from PyPI once.
#
# Usage: link_kernels.sh [FOLDER]    (default: build/wheel)
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(realpath -m "${1-build/wheel}")
build=$(realpath "${DEFORMVOLUME_BUILD:-build/vtk}")
for program in KernelTexts deformvolume-ld; do
  [ -x "$build/bin/$program" ] || {
    echo "Build first: cmake --preset vtk && cmake --build --preset vtk" >&2
    exit 1
  }
done

package=$(find "$folder/packages" -name 'pocl_binary_distribution-*.whl' -print -quit 2>/dev/null || true)
if [ -z "$package" ]; then
  python3 -m pip download --quiet --disable-pip-version-check --no-deps --dest "$folder/packages" \
    pocl-binary-distribution
  package=$(find "$folder/packages" -name 'pocl_binary_distribution-*.whl' -print -quit)
fi
rm -rf "$folder/kernels"
mkdir -p "$folder/kernels/linker"
python3 -m zipfile -e "$package" "$folder/kernels/driver"
cp "$build/bin/deformvolume-ld" "$folder/kernels/linker/ld"
python3 Testing/Wheel/link_kernels.py Kernels "$build/bin/KernelTexts" \
  "$(find "$folder/kernels/driver" -name 'libpocl*.so*')" "$folder/kernels/linker" "$folder/kernels"
rm -rf "$folder/kernels"
