#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs missing packages, builds against VTK, and runs the quick tests. On a pristine Debian 12 it
# needs root and a network. Later runs need neither.
#
# Usage: run.sh [--all] [PRESET]...
#   --all   runs all tests, and without PRESET those of vtk and paraview (the plugin), and the quick
#           tests of asan (the engine with the sanitizers)
#   PRESET  of CMakePresets.json, in place of vtk
# DEFORMVOLUME_CMAKE_OPTIONS: further options of CMake for all presets. The build directories keep them.
set -euo pipefail
cd "$(dirname "$0")/.."

all=no
tests=(--label-regex quick)
if [ "${1-}" = --all ]; then
  all=yes
  tests=()
  shift
fi
presets=("$@")
if [ ${#presets[@]} -eq 0 ]; then
  presets=(vtk)
  [ $all = no ] || presets=(vtk paraview asan)
fi

packages=(library example test)
case " ${presets[*]} " in *" paraview"*) packages+=(paraview) ;; esac
case " ${presets[*]} " in *" clang "*) packages+=(clang) ;; esac
[ $all = no ] || packages+=(readers)
bash Testing/packages.sh "${packages[@]}"

# A kernel uses all CPUs, so more than a few tests at the same time are not faster.
jobs=$(nproc)
[ "$jobs" -le 4 ] || jobs=4

mkdir -p build
failed=0
for preset in "${presets[@]}"; do
  echo "== $preset: build"
  # shellcheck disable=SC2086 # a list of words
  cmake --preset "$preset" ${DEFORMVOLUME_CMAKE_OPTIONS-} >"build/configure-$preset.log" 2>&1 || {
    cat "build/configure-$preset.log"
    exit 1
  }
  cmake --build --preset "$preset"
done

for preset in "${presets[@]}"; do
  echo "== $preset: test"
  selected=("${tests[@]}")
  # The slow tests repeat the same code of the host. Testing/nightly.sh runs all tests of asan-all.
  [ "$preset" != asan ] || selected=(--label-regex quick)
  ctest --preset "$preset" --parallel "$jobs" "${selected[@]}" 2>&1 | tee "build/test-$preset.log" ||
    failed=1
done

echo "== summary"
for preset in "${presets[@]}"; do
  echo "$preset: $(grep -a 'tests passed' "build/test-$preset.log")"
  grep -a -A100 'The following tests \(FAILED\|did not run\)' "build/test-$preset.log" |
    grep -a '^	' || true
done
exit $failed
