#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks the interface of an installed DeformVolume::Kernels: every header compiles alone, no header uses
# OpenCL or VTK, and the library exports only symbols of these headers.
#
# Usage: CheckInterface.sh <library> <include directory> <compiler>
set -euo pipefail
library=$1 include=$2 compiler=$3
failed=0

shopt -s nullglob
headers=("$include"/deformvolume/Kernels/*.h)
[ ${#headers[@]} -gt 0 ] || {
  echo "no headers in $include/deformvolume/Kernels"
  exit 1
}
for header in "${headers[@]}"; do
  "$compiler" -std=c++17 -fsyntax-only -Wall -Wextra -Werror -x c++ -I "$include" \
    -include "$header" /dev/null || failed=1
done
# Comments may contain these names.
if sed 's|//.*||' "${headers[@]}" | grep -n 'cl::\|cl_[a-z]\|CL/\|vtk'; then
  echo "the installed headers must not use OpenCL or VTK in the lines above"
  failed=1
fi

# Templates of the standard library and of GLM are weak symbols, which are not listed here.
symbols=$(nm --dynamic --demangle --defined-only "$library" | grep ' [TDBR] ')
if others=$(grep -v ' deformvolume::' <<<"$symbols"); then
  printf 'exported, but not in the namespace deformvolume:\n%s\n' "$others"
  failed=1
fi
if hidden=$(grep 'cl::\|OpenCLContext\|Internals\|DeviceVolume\|OutputSlab' <<<"$symbols"); then
  printf 'exported, but not in the headers:\n%s\n' "$hidden"
  failed=1
fi
grep -q 'deformvolume::VolumeDeformer::Deform(' <<<"$symbols" || {
  echo "VolumeDeformer is not exported"
  failed=1
}
exit $failed
