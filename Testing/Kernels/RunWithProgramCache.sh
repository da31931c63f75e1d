#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Usage: RunWithProgramCache.sh FOLDER COMMAND [ARGUMENT]...
#
# Runs a command, which uses an OpenCL driver whose programs DeformVolume keeps, with an empty
# program cache, with a filled one and with a damaged one. Fails where the command fails, where
# nothing is kept, where what is kept is not used, and where what is damaged is.
set -euo pipefail

folder=$1
shift
if [ ! -e "${OCL_ICD_VENDORS-/}" ]; then
  echo "Skipped: the driver $OCL_ICD_VENDORS is not installed"
  exit 125
fi
rm -rf "$folder"
export DEFORMVOLUME_CACHE_DIR=$folder

files() # with their numbers, which change where a file is written anew
{
  find "$folder" -type f -printf '%i %f\n' | sort -k 2
}

echo "== empty"
"$@"
first=$(files)
if [ -z "$first" ]; then
  echo "No program was kept."
  exit 1
fi
echo "== filled"
"$@"
if [ "$(files)" != "$first" ]; then
  printf 'Programs were compiled again:\n%s\n%s\n' "$first" "$(files)"
  exit 1
fi
echo "== damaged"
for file in "$folder"/*.program; do
  size=$(stat -c %s "$file")
  tail -c +$((size - 15)) "$file" | tr '\0-\377' '\1-\377\0' |
    dd of="$file" bs=1 seek=$((size - 16)) conv=notrunc status=none
done
"$@"
kept=$(comm -12 <(printf '%s\n' "$first" | sort) <(files | sort))
if [ -n "$kept" ]; then
  printf 'Damaged programs were trusted:\n%s\n' "$kept"
  exit 1
fi
