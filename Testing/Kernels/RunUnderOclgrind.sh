#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Usage: RunUnderOclgrind.sh LIBRARY LOG PROGRAM [ARGUMENT]...
#
# Runs a program on the device of Oclgrind. Fails if the program fails, or if Oclgrind reports anything. Oclgrind itself
# never fails.
set -u

library=$1
log=$2
shift 2
if [ ! -e "$library" ]; then
  echo "Skipped: Oclgrind is not installed (Debian 13 and later have no package oclgrind)"
  exit 125
fi
rm -f "$log"

# The device is named, so that the program fails rather than run on another device. Optimization is disabled, because
# Oclgrind 21.10 does not support all instructions that its own compiler puts into inlined functions. The search for
# uninitialized values is disabled, because it reports values that clEnqueueFillBuffer wrote.
OCL_ICD_VENDORS="$library" DEFORMVOLUME_DEVICE=oclgrind OCLGRIND_LOG="$log" \
  OCLGRIND_BUILD_OPTIONS=-cl-opt-disable \
  OCLGRIND_DATA_RACES="${OCLGRIND_DATA_RACES:-1}" \
  OCLGRIND_LOCAL_MEM_SIZE="${OCLGRIND_LOCAL_MEM_SIZE:-1048576}" "$@" || exit 1

if [ ! -e "$log" ]; then
  echo "Oclgrind has not written $log"
  exit 1
fi
if [ -s "$log" ]; then
  echo "Oclgrind reports:"
  head -100 "$log"
  exit 1
fi
