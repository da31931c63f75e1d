#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Usage: RunUnderOclgrind.sh LIBRARY LOG PROGRAM [ARGUMENT]...
#
# Runs a program on Oclgrind's device. Fails where the program fails, and where Oclgrind, which
# never fails itself, has reported anything.
set -u

library=$1
log=$2
shift 2
if [ ! -e "$library" ]; then
  echo "Skipped: Oclgrind is not installed (Debian 13 and later have no package oclgrind)"
  exit 125
fi
rm -f "$log"

# The device is named, so that the program fails rather than run elsewhere. Without optimisation,
# because Oclgrind 21.10 does not know all that its own compiler puts into inlined functions. Its
# search for uninitialised values is left out: it takes what clEnqueueFillBuffer wrote for such.
OCL_ICD_VENDORS="$library" DEFORMVOLUME_DEVICE=oclgrind OCLGRIND_LOG="$log" \
  OCLGRIND_BUILD_OPTIONS=-cl-opt-disable \
  OCLGRIND_DATA_RACES="${OCLGRIND_DATA_RACES:-1}" \
  OCLGRIND_LOCAL_MEM_SIZE="${OCLGRIND_LOCAL_MEM_SIZE:-1048576}" "$@" || exit 1

if [ ! -e "$log" ]; then
  echo "Oclgrind left no log"
  exit 1
fi
if [ -s "$log" ]; then
  echo "Oclgrind reports:"
  head -100 "$log"
  exit 1
fi
