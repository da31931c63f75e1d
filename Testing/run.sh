#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds against VTK, against ParaView's VTK and with the sanitizers, and
# runs all tests of each. From a pristine Debian 12 as root; afterwards without a network and
# without rights.
#
# Usage: run.sh [--quick] [PRESET]...    (default: vtk paraview asan)
#   --quick leaves out the tests that take long
set -euo pipefail
cd "$(dirname "$0")/.."

tests=()
if [ "${1-}" = --quick ]; then
  tests=(--label-regex quick)
  shift
fi
presets=("$@")
[ ${#presets[@]} -gt 0 ] || presets=(vtk paraview asan)

bash Testing/packages.sh library example test paraview

# Kernels run on all processors already; more than a few tests at once only wait for each other.
jobs=$(nproc)
[ "$jobs" -le 4 ] || jobs=4

mkdir -p build
failed=0
for preset in "${presets[@]}"; do
  echo "== $preset: build"
  cmake --preset "$preset" >"build/configure-$preset.log" 2>&1 || {
    cat "build/configure-$preset.log"
    exit 1
  }
  cmake --build --preset "$preset"
done

for preset in "${presets[@]}"; do
  echo "== $preset: test"
  ctest --preset "$preset" --parallel "$jobs" "${tests[@]}" 2>&1 | tee "build/test-$preset.log" ||
    failed=1
done

echo "== summary"
for preset in "${presets[@]}"; do
  echo "$preset: $(grep -a 'tests passed' "build/test-$preset.log")"
  grep -a -A100 'The following tests \(FAILED\|did not run\)' "build/test-$preset.log" |
    grep -a '^	' || true
done
exit $failed
