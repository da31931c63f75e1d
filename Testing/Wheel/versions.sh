#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Tests the wheel in build/wheel, which Python/wheel.sh has built, with each installed version of Python,
# with several versions of VTK, and with pyvista and pyopencl. pip installs the packages from PyPI into a virtual
# environment, which is removed if its tests pass. The wheel is also tested by pristine.sh with the Python
# of later releases of Debian and the newest VTK. These systems are removed if their tests pass, too.
# Prints a table.
#
# Usage: versions.sh [PYTHON | SUITE]...    (default: all of Python 3.9 and later on the PATH and in
#                                           ~/.pyenv, trixie and forky)
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$PWD/build/wheel
wheel=$(ls "$folder"/deformvolume-*.whl)

pythons=()
suites=()
for argument in "$@"; do
  if [ -x "$argument" ]; then
    pythons+=("$argument")
  else
    suites+=("$argument")
  fi
done
if [ $# -eq 0 ]; then
  suites=(trixie forky)
  for minor in 9 10 11 12 13 14; do
    # The newest patch release of each version.
    for python in "/usr/bin/python3.$minor" \
      $(printf '%s\n' ~/.pyenv/versions/3."$minor".*/bin/python | sort -rV); do
      if [ -x "$python" ]; then
        pythons+=("$python")
        break
      fi
    done
  done
fi

failed=0
rows=()
try() # python, additional packages: the table says if they are not available for this Python
{
  local python=$1 venv=$folder/versions result
  rm -rf "$venv"
  "$python" -m venv "$venv"
  if ! "$venv/bin/pip" install --quiet --disable-pip-version-check --only-binary=:all: \
    "$wheel" "${@:2}" >"$venv.log" 2>&1; then
    result="not available"
  else
    result=passed
    local test
    for test in Testing/Wheel/test_{devices,deform,misuse,vtk,pyvista}.py; do
      # Drivers of this system are not used.
      env -u OCL_ICD_VENDORS -u OCL_ICD_FILENAMES OPENCL_VENDOR_PATH=/nowhere \
        "$venv/bin/python" "$test" >>"$venv.log" 2>&1 || result=failed
    done
    if [ $result = failed ]; then
      failed=1
      tail -40 "$venv.log"
    fi
  fi
  rows+=("| $("$python" --version) | ${*:2} | $result |")
  echo "${rows[-1]}"
  [ "$result" = failed ] || rm -rf "$venv"
}

for python in "${pythons[@]}"; do
  for packages in "" "vtk==9.3.1" "vtk==9.6.2" "vtk==9.7.2" "pyvista" "pyopencl"; do
    # shellcheck disable=SC2086 # none or one
    try "$python" $packages
  done
done
for suite in ${suites[@]+"${suites[@]}"}; do
  log=$folder/versions-$suite.log
  status=0
  bash Testing/Wheel/pristine.sh --wheel "$wheel" "$suite" >"$log" 2>&1 || status=$?
  found=$(sed -n 's/^passed: //p' "$log")
  case $status in
    0)
      result=passed
      rm -rf --one-file-system "$folder/$suite" "$folder/$suite.made" "$folder/$suite.log"
      ;;
    125) result="skipped: root cannot mount" ;;
    *)
      result=failed
      failed=1
      tail -40 "$log"
      ;;
  esac
  rows+=("| ${found%%,*}, Debian $suite | ${found#*, } | $result |")
  echo "${rows[-1]}"
done
printf '\n| Python | Besides | Result |\n|---|---|---|\n'
printf '%s\n' "${rows[@]}"
exit $failed
