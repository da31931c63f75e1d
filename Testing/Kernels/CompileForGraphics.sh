#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Usage: CompileForGraphics.sh PROGRAM FOLDER
#
# Checks with clang the OpenCL programs that the program KernelTexts writes into the folder. The target has no
# extensions of its own, like the drivers of graphics cards. Fails if clang finds an error.
set -euo pipefail

program=$1
folder=$2
clang=$(command -v clang-15 || command -v clang || true)
if [ -z "$clang" ]; then
  echo "Skipped: clang is not installed"
  exit 125
fi
rm -rf "$folder"
failed=0
for precision in double single; do
  mkdir -p "$folder/$precision"
  "$program" "$folder/$precision" $precision texts
  number=0
  for file in "$folder/$precision"/*.cl; do
    # Drivers define the version.
    # shellcheck disable=SC2046 # a list of words
    "$clang" -x cl $(cat "${file%.cl}.options") -target spir64-unknown-unknown \
      -D__OPENCL_VERSION__=120 -fsyntax-only "$file" || failed=1
    number=$((number + 1))
  done
  echo "$number programs in $precision precision"
done
exit $failed
