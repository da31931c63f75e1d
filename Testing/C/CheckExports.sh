#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that libdeformvolume.so exports all functions of its header, and nothing else.
#
# Usage: CheckExports.sh <library> <header>
set -euo pipefail
exported=$(nm --dynamic --defined-only "$1" | awk '{ print $NF }' | sort)
declared=$(sed -n 's/^ *DV_EXPORT .*[ *]\(dv_[a-z_0-9]*\)(.*/\1/p' "$2" | sort)
[ -n "$declared" ] || {
  echo "the header declares no function"
  exit 1
}
diff <(echo "$declared") <(echo "$exported") || {
  echo "the functions of the header (<) differ from the exported ones (>)"
  exit 1
}
