#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the tests of the kernels and of the VTK classes, built by preset vtk, on each installed OpenCL
# driver for CPUs, and prints a table. Tests that cannot run on a driver count as skipped, and the
# reasons are listed.
#
# Usage: drivers.sh [DRIVER]...
#   pocl      PoCL (Debian: pocl-opencl-icd)
#   intel     Intel's runtime for CPUs, in build/intel-opencl. To install it:
#             python3 -m venv build/intel-opencl &&
#             build/intel-opencl/bin/pip install intel-opencl-rt intel-cmplr-lib-rt
#   rusticl   Mesa's rusticl on llvmpipe (Debian 13 or later: mesa-opencl-icd)
# Default: all drivers that are installed. Each process loads one driver only, because several
# versions of LLVM in one process conflict.
#
# DEFORMVOLUME_DRIVER_TESTS: a regular expression of CTest that selects tests; default: all tests of
# the kernels and of the VTK classes.
# DEFORMVOLUME_TEST_TIMEOUT: seconds that a test may take, 900 by default. Drivers that compile for
# minutes need more.
# DEFORMVOLUME_BUILD: another build directory than build/vtk.
set -euo pipefail
cd "$(dirname "$0")/.."

build=$(realpath "${DEFORMVOLUME_BUILD:-build/vtk}")
output=$PWD/build/drivers
tests=${DEFORMVOLUME_DRIVER_TESTS:-^(Kernels|Cxx)\.}
# Tests that are left out, because they choose a driver or a cache themselves, or need no driver.
others='Oclgrind|TestEnvironment|TestTetGen|TestDeformLarge'
library=$PWD/build/intel-opencl/lib

icd() # prints the path of the .icd file of a driver in the folder of the system, if there is one
{
  grep -l -i -s "$1" /etc/OpenCL/vendors/*.icd | head -1
}

is_there()
{
  case $1 in
    pocl) [ -n "$(icd pocl)" ] ;;
    intel) [ -e "$library/libintelocl.so" ] ;;
    rusticl) [ -n "$(icd rusticl)" ] ;;
    *)
      echo "drivers.sh: no driver $1; there are: pocl intel rusticl" >&2
      exit 2
      ;;
  esac
}

choose() # DRIVER: sets the environment such that programs use this driver
{
  local folder=$output/$1
  mkdir -p "$folder/vendors"
  case $1 in
    pocl) cp "$(icd pocl)" "$folder/vendors" ;;
    intel)
      echo "$library/libintelocl.so" >"$folder/vendors/intel.icd"
      export LD_LIBRARY_PATH=$library
      ;;
    rusticl)
      cp "$(icd rusticl)" "$folder/vendors"
      export RUSTICL_ENABLE=llvmpipe
      ;;
  esac
  export OCL_ICD_VENDORS=$folder/vendors
}

# Prints the seconds of compilation in a first and in a second process, with a cache that is empty at first.
first_update() # DRIVER
{
  local caches=$output/$1/first-update
  rm -rf "$caches"
  mkdir -p "$caches"
  export HOME=$caches XDG_CACHE_HOME=$caches
  unset POCL_CACHE_DIR
  local run
  for run in 1 2; do
    "$build/bin/FirstUpdate" 2>&1 | sed -n 's/.* compilation \([0-9.]*\) .*/\1/p'
  done | paste -s -d ' '
}

device()
{
  "$build/bin/FirstUpdate" 2>/dev/null | sed -n 's/.* device //p'
}

run() # DRIVER: runs the tests, and writes the numbers of its row of the table
{
  local folder=$output/$1 log=$output/$1/tests.log times
  (
    choose "$1"
    times=$(first_update "$1")
    # Tests are not run in parallel, because their times are printed. They share one kernel cache.
    ctest --test-dir "$build" -R "$tests" -E "$others" --timeout "${DEFORMVOLUME_TEST_TIMEOUT:-900}" \
      --output-on-failure >"$log" 2>&1 || true
    # CTest's log also has the output of tests that pass or are skipped.
    cp "$build/Testing/Temporary/LastTest.log" "$folder/output.log"
    {
      echo "$(device)"
      sed -n 's/.*tests passed, \([0-9]*\) tests failed out of \([0-9]*\).*/\1 \2/p' "$log"
      grep -c '\*\*\*Skipped' "$log" || true
      grep -a -c '^\[  SKIPPED \] .*)$' "$folder/output.log" || true
      echo "$times"
      sed -n 's/^Total Test time (real) = *\([0-9.]*\) sec/\1/p' "$log"
    } >"$folder/row"
  )
}

drivers=("$@")
if [ ${#drivers[@]} -eq 0 ]; then
  for driver in pocl intel rusticl; do
    if is_there $driver; then
      drivers+=($driver)
    fi
  done
fi
[ -x "$build/bin/FirstUpdate" ] || {
  echo "Build first: cmake --preset vtk && cmake --build --preset vtk" >&2
  exit 1
}

failed=0
for driver in "${drivers[@]}"; do
  if ! is_there "$driver"; then
    echo "$driver: skipped, it is not installed"
    continue
  fi
  echo "== $driver"
  mkdir -p "$output/$driver"
  run "$driver"
  grep -a -A100 'The following tests FAILED' "$output/$driver/tests.log" | grep -a '^	' || true
done

echo
echo '| Driver | Tests passed | Failed | Skipped | Cases of GoogleTest skipped | Compilation, first process | Second process | Seconds of all tests |'
echo '|---|---|---|---|---|---|---|---|'
for driver in "${drivers[@]}"; do
  [ -e "$output/$driver/row" ] || continue
  {
    read -r name
    read -r bad all
    read -r skipped
    read -r cases
    read -r cold warm
    read -r seconds
  } <"$output/$driver/row"
  echo "| $driver: $name | $((all - bad - skipped)) | $bad | $skipped | $cases | $cold s | $warm s | $seconds |"
  [ "$bad" -eq 0 ] || failed=1
done
for driver in "${drivers[@]}"; do
  [ -e "$output/$driver/output.log" ] || continue
  # The reasons for skipping, as GoogleTest and other tests print them.
  {
    grep -a -A1 ': Skipped$' "$output/$driver/output.log" | grep -a -v ': Skipped$\|^--'
    sed -n 's/^skipped: //p' "$output/$driver/output.log"
  } | sort | uniq -c | sed "s/^ */$driver: skipped /" || true
done
exit $failed
