#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Usage: RunInUsrLocal.sh PREFIX COMMAND...
#
# Runs a command in a mount namespace in which /usr/local contains only the files of PREFIX, and without
# PYTHONPATH.
set -u

prefix=$1
shift
if ! unshare --map-root-user --mount true; then
  echo "Skipped: this system does not allow mount namespaces"
  exit 125
fi
unset PYTHONPATH
# shellcheck disable=SC2016 # the inner shell expands these
exec unshare --map-root-user --mount \
  sh -c 'mount --bind "$0" /usr/local && exec "$@"' "$prefix" "$@"
