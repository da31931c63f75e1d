#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The interface of an installed DeformVolume::Kernels: every header compiles by itself, none names
# OpenCL or VTK, and the library hides all that is not in them.
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
# Comments may name what they like.
if sed 's|//.*||' "${headers[@]}" | grep -n 'cl::\|cl_[a-z]\|CL/\|vtk'; then
  echo "a header names OpenCL or VTK"
  failed=1
fi

# Templates of the standard library and of GLM are weak symbols, which all libraries share.
symbols=$(nm --dynamic --demangle --defined-only "$library" | grep ' [TDBR] ')
if others=$(grep -v ' deformvolume::' <<<"$symbols"); then
  printf 'exported, but not of this library:\n%s\n' "$others"
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
