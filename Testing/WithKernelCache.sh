#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command with a kernel cache of PoCL that no other command uses at the same time, because
# processes that share a cache compile in turn. So there are as many caches as commands at the same
# time. Hard links share compiled kernels between the caches, so each kernel is compiled once.
#
# Usage: WithKernelCache.sh FOLDER COMMAND [ARGUMENT]...
set -euo pipefail

folder=$1
shift
mkdir -p "$folder/all"
number=1
# The lock is held by the command, too, which inherits the descriptor.
exec 9>"$folder/$number.lock"
until flock --nonblock --conflict-exit-code 75 9; do
  [ $? -eq 75 ] || exit 1
  number=$((number + 1))
  exec 9>"$folder/$number.lock"
done
own=$folder/$number
mkdir -p "$own"

# Links the files of a cache that are missing in another one into that one. If files exist there, some
# versions of cp report a failure, which is ignored: kernels that are not shared are compiled again.
share() # from, to
{
  flock "$folder/all.lock" cp --recursive --link --no-clobber "$1/." "$2" 2>/dev/null || true
}

share "$folder/all" "$own"
status=0
POCL_CACHE_DIR=$own "$@" || status=$?
share "$own" "$folder/all"
exit $status
