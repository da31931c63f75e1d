#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Repeats the published evaluation on this machine, on its CPUs and on its GPU if there is one, and
# writes build/benchmarks/report.md with plots. Documents/benchmarks.md explains the report.
#
# Usage: Testing/Benchmarks/run.sh [OPTION]...
#   --quick             few rounds and no volume over 30 million voxels: checks that everything works.
#                       Its times are not reliable
#   --programs FOLDER   measures with the programs in FOLDER, which were built elsewhere, and installs
#                       and builds nothing. Without matplotlib the report is left out
#   --libraries FOLDER  where these programs find libraries; Python does not look there
#   --output FOLDER     writes to this folder, which is empty or does not exist, instead of
#                       build/benchmarks
#   --parts PART,...    measures only these parts: benchmarks, memory, gpu-peers
#   --filter REGEX      runs only the benchmarks whose names match. Several filters are several runs, in
#                       this order, each with its own file of results
#   --seconds NUMBER    starts no further run with a filter after this time; the other parts follow
# If a measurement fails, the others continue, and the status is 1 at the end.
# DEFORMVOLUME_DEVICE, if set, is the only device that is measured.
set -euo pipefail

fail()
{
  echo "run.sh: $1" >&2
  exit 2
}

known="benchmarks,memory,gpu-peers"
quick=()
programs=""
libraries=""
results=""
parts=$known
filters=()
seconds=""
while [ $# -gt 0 ]; do
  case "$1" in
    --quick) quick=(--quick) ;;
    --programs | --libraries | --output | --parts | --filter | --seconds)
      [ -n "${2-}" ] || fail "$1 needs a value"
      case "$1" in
        --programs) programs=$(realpath -m -- "$2") ;;
        --libraries) libraries=$(realpath -m -- "$2") ;;
        --output) results=$(realpath -m -- "$2") ;;
        --parts) parts=$2 ;;
        --filter) filters+=("$2") ;;
        --seconds) seconds=$2 ;;
      esac
      shift
      ;;
    *)
      echo "usage: Testing/Benchmarks/run.sh [--quick] [--programs FOLDER] [--libraries FOLDER]" \
        "[--output FOLDER] [--parts PART,...] [--filter REGEX]... [--seconds NUMBER]" >&2
      exit 2
      ;;
  esac
  shift
done
cd "$(dirname "$0")/../.."

[[ -z "$seconds" || "$seconds" =~ ^[0-9]+$ ]] || fail "--seconds needs a whole number, not $seconds"
for part in ${parts//,/ }; do
  [[ ",$known," == *",$part,"* ]] || fail "no part is called $part; there are $known"
done
wants() # PART
{
  [[ ",$parts," == *",$1,"* ]]
}

[ -z "$libraries" ] || [ -d "$libraries" ] || fail "$libraries is not a folder"

python=/usr/bin/python3
if [ -n "$programs" ]; then
  python=python3
  for program in DeformVolumeDevice DeformVolumeBenchmarks DeformVolumeMemory; do
    [ -x "$programs/$program" ] || fail "$programs does not contain $program"
  done
else
  bash Testing/packages.sh library test benchmark
  [ -f build/vtk/build.ninja ] || cmake --preset vtk >/dev/null
  cmake --build --preset vtk --target DeformVolumeBenchmarkPrograms
  programs=build/vtk/bin
fi

if [ -z "$results" ]; then
  results=build/benchmarks
  rm -rf "$results"
elif [ -e "$results" ] && { [ ! -d "$results" ] || [ -n "$(ls -A "$results")" ]; }; then
  fail "$results is not an empty folder"
fi
mkdir -p "$results"

# The command that starts the programs.
start=(env)
[ -z "$libraries" ] || start=(env "LD_LIBRARY_PATH=$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}")

measure() # PROGRAM NAME-OF-RESULT [ARGUMENT]...
{
  local program=$1 result=$2
  shift 2
  "${start[@]}" "$programs/$program" "$@" "--benchmark_out=$folder/$result.json" --benchmark_out_format=json
}

# Each line is the volume, the type, the nodes on each axis and the resampler of one process.
memory=("189 305 229 ushort 13 exact" "189 305 229 ushort 80 exact"
  "189 305 229 ushort 13 mesh-rasterization")
[ ${#quick[@]} -gt 0 ] || memory+=("464 464 464 ushort 13 exact" \
  "1000 1000 1000 uchar 13 exact" "1000 1000 1000 uchar 13 mesh-rasterization")

# After a failure the other measurements continue.
failed=no
try() # COMMAND [ARGUMENT]...
{
  local status=0
  "$@" || status=$?
  if [ $status -ne 0 ]; then
    echo "run.sh: failed with status $status: $*" >&2
    failed=yes
  fi
}

measure_benchmarks()
{
  if [ ${#filters[@]} -eq 0 ]; then
    try measure DeformVolumeBenchmarks benchmarks "${quick[@]}"
    return
  fi
  local number=0
  for filter in "${filters[@]}"; do
    if [ -n "$seconds" ] && [ $SECONDS -ge "$seconds" ]; then
      echo "run.sh: $seconds seconds have passed: --filter '$filter' is left out" >&2
      continue
    fi
    number=$((number + 1))
    try measure DeformVolumeBenchmarks "benchmarks-$(printf %02d $number)" "${quick[@]}" \
      "--benchmark_filter=$filter"
  done
}

measure_gpu_peers()
{
  local status=0
  # The Python in PATH, which may have torch and cupy.
  python3 Testing/Benchmarks/Report/gpu_peers.py "$folder" || status=$?
  # 125: neither torch nor cupy is installed.
  if [ $status -ne 0 ] && [ $status -ne 125 ]; then
    echo "run.sh: gpu_peers.py failed with status $status" >&2
    failed=yes
  fi
}

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
  "$python" Testing/Benchmarks/Report/machine.py "$folder"
  if wants benchmarks; then measure_benchmarks; fi
  if wants memory; then
    for line in "${memory[@]}"; do
      # shellcheck disable=SC2086 # a list of words
      try measure DeformVolumeMemory "memory-${line// /-}" $line
    done
  fi
  if wants gpu-peers && grep -q '"device_is_processor": "0"' "$folder/device.json"; then
    measure_gpu_peers
  fi
done

if [ "$python" != /usr/bin/python3 ] && ! "$python" -c "import matplotlib" 2>/dev/null; then
  echo "run.sh: the report is left out: there is no matplotlib. Copy $results to a machine that has it:" \
    "Testing/Benchmarks/Report/report.py makes the report" >&2
else
  "$python" Testing/Benchmarks/Report/report.py "$results"
fi
[ $failed = no ]
