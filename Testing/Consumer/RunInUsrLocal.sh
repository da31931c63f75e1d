#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Usage: RunInUsrLocal.sh PREFIX COMMAND...
#
# Runs a command that finds what is installed under PREFIX in /usr/local, where nothing else is, and
# without PYTHONPATH. Nobody else sees that.
set -u

prefix=$1
shift
if ! unshare --map-root-user --mount true; then
  echo "Skipped: this system allows no mount namespace"
  exit 125
fi
unset PYTHONPATH
# shellcheck disable=SC2016 # the inner shell expands these
exec unshare --map-root-user --mount \
  sh -c 'mount --bind "$0" /usr/local && exec "$@"' "$prefix" "$@"
