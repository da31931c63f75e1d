#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command with a kernel cache of PoCL that no other command has at the same time: PoCL does
# not survive several processes that compile into one. So there are as many caches as commands that
# run at once. What a command has compiled goes to all of them, by hard links: it is compiled once.
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

# Links the files of a cache into another one, where they are missing. Some versions of cp call that
# a failure; what is not shared is compiled again.
share() # from, to
{
  flock "$folder/all.lock" cp --recursive --link --no-clobber "$1/." "$2" 2>/dev/null || true
}

share "$folder/all" "$own"
status=0
POCL_CACHE_DIR=$own "$@" || status=$?
share "$own" "$folder/all"
exit $status
