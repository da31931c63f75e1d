#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command with a kernel cache of PoCL that no other command has at the same time: PoCL does
# not survive several processes that compile into one. So there are as many caches as commands that
# run at once, and a kernel is compiled once for each of them.
#
# Usage: WithKernelCache.sh FOLDER COMMAND [ARGUMENT]...
set -euo pipefail

folder=$1
shift
mkdir -p "$folder"
number=1
# The lock is held by the command, which inherits the descriptor.
exec 9>"$folder/$number.lock"
until flock --nonblock --conflict-exit-code 75 9; do
  [ $? -eq 75 ] || exit 1
  number=$((number + 1))
  exec 9>"$folder/$number.lock"
done
mkdir -p "$folder/$number"
export POCL_CACHE_DIR=$folder/$number
exec "$@"
