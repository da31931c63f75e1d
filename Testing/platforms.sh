#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the two commands of README.md in pristine Debian systems, each made for it in
# build/platforms, and prints a table of what they found, warnings of the compiler among it. As root,
# on Debian; packages come from the archive that this system uses. The logs stay in build/platforms,
# and so do the pictures that Examples/run.sh draws: look at them. What ccache keeps of a system is
# kept for the next run, in ~/.cache/deformvolume-platforms: a system whose compiler and sources are
# the same compiles less.
#
# Usage: platforms.sh [--keep] [--quick] [SUITE]...    (default: bookworm trixie forky)
#   --keep  leaves the systems with what was built in them, to look into a failure
#   --quick builds against VTK only and runs the quick tests only
#   SUITE   the name of a Debian release
# Fails where a command fails; with status 3 where none does, but a system cannot be made.
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

make_system() # suite, folder
{
  local suite=$1 root=$2
  rm -rf --one-file-system "$root"
  debootstrap --variant=minbase "$suite" "$root" "$archive" /usr/share/debootstrap/scripts/sid
  {
    echo "deb $archive $suite main"
    # Those that are released have updates.
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

# The system's own /proc, and nothing of this system's environment. What is mounted for it goes with
# the namespace. Its root is that of the namespace, as the kernel gives a changed root (chroot) no
# further namespaces, which a test of the installation wants.
inside() # folder, command...
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

versions() # folder: of what differs between the systems
{
  # A command that failed early has not installed all of these.
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
  # In the background, as it would go on after errors where its status is asked for.
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
