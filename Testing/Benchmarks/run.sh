#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Repeats the published evaluation on this machine, on its processors and on its GPU if there is one,
# and writes build/benchmarks/report.md with plots. Documents/benchmarks.md says what it means.
#
# Usage: Testing/Benchmarks/run.sh [--quick]
#   --quick   few rounds and no volume over 30 million voxels: to see that it works, not to rely on
# DEFORMVOLUME_DEVICE, if set, is the only device that is measured.
set -euo pipefail
cd "$(dirname "$0")/../.."

quick=()
case "${1-}" in
  "") ;;
  --quick) quick=(--quick) ;;
  *)
    echo "usage: Testing/Benchmarks/run.sh [--quick]" >&2
    exit 2
    ;;
esac

bash Testing/packages.sh library test benchmark
[ -f build/vtk/build.ninja ] || cmake --preset vtk >/dev/null
cmake --build --preset vtk --target DeformVolumeBenchmarkPrograms

results=build/benchmarks
programs=build/vtk/bin
rm -rf "$results"
mkdir -p "$results"

measure() # PROGRAM NAME-OF-RESULT [ARGUMENT]...
{
  local program=$1 result=$2
  shift 2
  "$programs/$program" "$@" "--benchmark_out=$folder/$result.json" --benchmark_out_format=json
}

# Volume, type, nodes on each axis, resampler; a process of its own for each.
memory=("189 305 229 ushort 13 exact" "189 305 229 ushort 80 exact"
  "189 305 229 ushort 13 mesh-rasterization" "189 305 229 ushort 13 published")
[ ${#quick[@]} -gt 0 ] || memory+=("464 464 464 ushort 13 exact" \
  "1000 1000 1000 uchar 13 exact" "1000 1000 1000 uchar 13 mesh-rasterization")

devices=(cpu gpu)
[ -z "${DEFORMVOLUME_DEVICE-}" ] || devices=("$DEFORMVOLUME_DEVICE")
for device in "${devices[@]}"; do
  export DEFORMVOLUME_DEVICE=$device
  folder=$results/${device//[^[:alnum:]]/-}
  mkdir -p "$folder"
  status=0
  measure DeformVolumeDevice device || status=$?
  if [ $status -eq 125 ]; then
    rm -r "$folder"
    continue
  fi
  [ $status -eq 0 ]
  measure DeformVolumeBenchmarks benchmarks "${quick[@]}"
  for line in "${memory[@]}"; do
    # shellcheck disable=SC2086 # a list of words
    measure DeformVolumeMemory "memory-${line// /-}" $line
  done
  xvfb-run -a -s "-noreset -screen 0 1920x1200x24" \
    "$programs/DeformVolumeRendering" "${quick[@]}" "--pictures=$folder" \
    "--benchmark_out=$folder/rendering.json" --benchmark_out_format=json
done

/usr/bin/python3 Testing/Benchmarks/report.py "$results"
