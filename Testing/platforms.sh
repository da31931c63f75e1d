#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the two commands of README.md in pristine Debian systems, which it makes in build/platforms,
# and prints a table of the results, with the numbers of compiler warnings. Needs root and Debian.
# Packages come from the archive that this system uses. Logs, and the pictures that Examples/run.sh
# draws, are kept in build/platforms: look at the pictures. The files of ccache are kept for the next
# run, in ~/.cache/deformvolume-platforms.
#
# Usage: platforms.sh [--keep] [--quick] [SUITE]...    (default: bookworm trixie forky)
#   --keep  keeps the systems with all that was built in them, to investigate a failure
#   --quick builds against VTK only and runs the quick tests only
#   SUITE   the name of a Debian release
# Fails if a command fails. If none fails, but a system cannot be made, the status is 3.
set -euo pipefail
cd "$(dirname "$0")/.."

commands=("bash Examples/run.sh" "bash Testing/run.sh --all")
keep=0
while [[ "${1-}" == --* ]]; do
  case $1 in
    --keep) keep=1 ;;
    --quick) commands=("bash Testing/run.sh") ;;
    *)
      echo "platforms.sh: unknown option $1" >&2
      exit 2
      ;;
  esac
  shift
done
suites=("$@")
[ ${#suites[@]} -gt 0 ] || suites=(bookworm trixie forky)

bash Testing/packages.sh platforms
archive=$(apt-cache policy | sed -n 's|^ *[0-9]* \(http[^ ]*/debian\)/\? .*|\1|p' | head -1)
[ -n "$archive" ] || {
  echo "platforms.sh: apt on this system knows no Debian archive" >&2
  exit 3
}

make_system() # SUITE FOLDER
{
  local suite=$1 root=$2
  rm -rf --one-file-system "$root"
  debootstrap --variant=minbase "$suite" "$root" "$archive" /usr/share/debootstrap/scripts/sid
  {
    echo "deb $archive $suite main"
    # Only released suites have updates.
    for updates in "$archive $suite-updates" "$archive-security $suite-security"; do
      read -r address name <<<"$updates"
      ! curl -fsIL "$address/dists/$name/Release" >/dev/null || echo "deb $address $name main"
    done
  } >"$root/etc/apt/sources.list"
  # A copy of the archive may be older than its date of expiry.
  echo 'Acquire::Check-Valid-Until "false";' >"$root/etc/apt/apt.conf.d/99platforms"
  mkdir -p "$HOME/.cache/deformvolume-platforms/$suite" "$root/root/.cache/ccache"
  inside "$root" apt-get update -qq
  inside "$root" apt-get -y -qq upgrade
  mkdir "$root/src"
  git ls-files -z | tar --create --null --files-from - | tar --extract --directory "$root/src"
}

# Runs a command in a system, with its own /proc and without the environment of this system. Mounts end
# with the mount namespace. pivot_root is used instead of chroot, because a test of the installation
# makes further namespaces, which the kernel does not allow after chroot.
inside() # FOLDER COMMAND [ARGUMENT]...
{
  # shellcheck disable=SC2016 # the inner shell expands these
  unshare --mount bash -c '
    set -e
    root=$0
    mount --bind "$root" "$root"
    kept=$HOME/.cache/deformvolume-platforms/${root##*/}
    [ ! -d "$kept" ] || mount --bind "$kept" "$root/root/.cache/ccache"
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount --bind /sys "$root/sys"
    cd "$root"
    pivot_root . .
    umount --lazy .
    cd /
    exec /usr/bin/env -i HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
      PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"' "$@" </dev/null
}

versions() # FOLDER: prints the versions of packages that differ between the systems
{
  # If a command has failed early, not all of these packages are installed.
  # shellcheck disable=SC2016 # the inner shell expands these
  { inside "$1" dpkg-query --show --showformat='${Package} ${Version}\n' \
    g++ cmake libvtk9-dev paraview pocl-opencl-icd tetgen libopenmpi-dev 2>/dev/null || true; } |
    sed -E 's/^libvtk9-dev/VTK/; s/^pocl-opencl-icd/PoCL/; s/^libopenmpi-dev/Open MPI/; s/^paraview/ParaView/
      s/^cmake/CMake/; s/^tetgen/TetGen/; s/ ([0-9]+:)?([0-9]+(\.[0-9]+)*)[^ ]*$/ \2/' |
    paste -s -d, | sed 's/,/, /g'
}

mkdir -p build/platforms
rows=()
failed=0
missing=0
for suite in "${suites[@]}"; do
  root=build/platforms/$suite
  echo "== $suite: a pristine system"
  # Start the function in the background: if its status were tested directly, bash would ignore set -e in it.
  make_system "$suite" "$root" >"$root.log" 2>&1 &
  wait $! || {
    tail -20 "$root.log"
    missing=1
    continue
  }
  row="| Debian $suite"
  results=""
  for command in "${commands[@]}"; do
    echo "== $suite: $command"
    script=${command#bash }
    log="$root-${script%%/*}.log"
    begin=$SECONDS
    if inside "$root" bash -c "cd /src && $command" >"$log" 2>&1; then
      result="passed"
    else
      result="failed"
      failed=1
      tail -100 "$log"
    fi
    sed -n '/^== summary/,$p' "$log"
    tests=$(sed -n '/^== summary/,$ s/^\([a-z]*\): .* out of \([0-9]*\)$/\1 \2/p' "$log" |
      paste -s -d, | sed 's/,/, /g')
    warnings=$(grep -c ': warning: ' "$log" || true)
    [ "$warnings" = 0 ] || result+=", $warnings warnings"
    results+=" | $result${tests:+ ($tests tests)}, $(((SECONDS - begin + 59) / 60)) min"
  done
  rows+=("$row | $(versions "$root")$results |")
  for picture in "$root"/src/build/demo/*.png; do
    [ ! -f "$picture" ] || mv "$picture" "$root-$(basename "$picture")"
  done
  [ $keep = 1 ] || rm -rf --one-file-system "$root"
done

echo
printf '| System | Versions'
printf ' | `%s`' "${commands[@]}"
printf ' |\n|---|---%s|\n' "$(printf '|---%.0s' "${commands[@]}")"
[ ${#rows[@]} -eq 0 ] || printf '%s\n' "${rows[@]}"
[ $failed = 0 ] || exit 1
[ $missing = 0 ] || exit 3
