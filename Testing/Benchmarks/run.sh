#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures, and writes what it measured to build/benchmarks/report.md.
#
# Usage: Testing/Benchmarks/run.sh [--quick]
#   --quick   one repetition instead of seven: to see that it works, not to rely on
set -euo pipefail
cd "$(dirname "$0")/../.."

repetitions=7
case "${1-}" in
  "") ;;
  --quick) repetitions=1 ;;
  *)
    echo "usage: Testing/Benchmarks/run.sh [--quick]" >&2
    exit 2
    ;;
esac

bash Testing/packages.sh library test
[ -f build/vtk/build.ninja ] || cmake --preset vtk >/dev/null
cmake --build --preset vtk --target DeformVolumeBenchmarks

mkdir -p build/benchmarks
build/vtk/bin/DeformVolumeBenchmarks \
  --benchmark_repetitions=$repetitions \
  --benchmark_enable_random_interleaving=true \
  --benchmark_out=build/benchmarks/result.json \
  --benchmark_out_format=json
/usr/bin/python3 Testing/Benchmarks/report.py build/benchmarks/result.json |
  tee build/benchmarks/report.md
