#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that take too long for each change. Takes hours; logs are in build.
#   - all tests of the VTK classes against ParaView's VTK, with the sanitizers, with Clang, and as
#     static libraries; the quick tests without optimization and with the thread sanitizer
#   - the tests with Oclgrind that take minutes
#   - edits by cell, as on a GPU; edits and random pipelines with new seeds; all mutations
#   - the wheel of the Python package with several versions of Python and VTK
#   - Examples/run.sh and Testing/run.sh --all on other Debian systems
#
# Usage: nightly.sh [--seconds SECONDS]
#   --seconds  how long random pipelines run, 3600 by default
# Runs all checks, and fails if one of them has failed. A Debian system that cannot be made is reported,
# but is not a failure.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=3600
if [ "${1-}" = --seconds ] && [ $# -eq 2 ]; then
  seconds=$2
elif [ $# -gt 0 ]; then
  echo "nightly.sh: unknown arguments $*" >&2
  exit 2
fi

failed=()
run() # NAME COMMAND [ARGUMENT]...
{
  echo "== $1"
  "${@:2}" || failed+=("$1")
}

platforms()
{
  local status=0
  bash Testing/platforms.sh || status=$?
  if [ $status -eq 3 ]; then # a system could not be made
    echo "nightly.sh: not all systems could be made"
    status=0
  fi
  return $status
}

for preset in vtk paraview-all asan-all clang static; do
  run "all tests of $preset" bash Testing/run.sh --all "$preset"
done
for preset in debug tsan; do
  run "quick tests of $preset" bash Testing/run.sh "$preset"
done
run "configuration of long tests" cmake --preset vtk -DDEFORMVOLUME_LONG_TESTS=ON
run "long tests" ctest --preset vtk -R Oclgrind
run "configuration" cmake --preset vtk -DDEFORMVOLUME_LONG_TESTS=OFF
run "edits by cell, as on a GPU" build/vtk/bin/DeformVolumeEngineTests --device=gpu-like \
  --files=TestEdits,TestIncremental,TestOutputMaps '--gtest_filter=*ByCell'
seed=$(date +%s)
run "edits from seed $((seed % 99999))" build/vtk/bin/DeformVolumeEngineTests --files=TestEdits \
  --gtest_random_seed=$((seed % 99999))
run "random pipelines from seed $seed" build/vtk/bin/DeformVolumeFuzz --seed "$seed" \
  --seconds "$seconds" --keep-going
run "mutations" python3 Testing/mutations.py
run "wheel" bash Testing/Wheel/pristine.sh
run "wheel with versions of Python and VTK" bash Testing/Wheel/versions.sh
run "platforms" platforms

if [ ${#failed[@]} -gt 0 ]; then
  printf 'failed: %s\n' "${failed[@]}"
  exit 1
fi
