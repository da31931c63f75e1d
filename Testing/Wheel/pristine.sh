#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the wheel of the Python package and runs it in a pristine Debian 11 (glibc 2.31, Python 3.9), as
# a user without rights, without OpenCL, a compiler, a linker or a network. As root, on Debian; that
# system and the packages of the wheel come from the archives that this system uses, once.
#
# Usage: pristine.sh [FOLDER]    (default: build/wheel)
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(realpath -m "${1-build/wheel}")
root=$folder/bullseye
unshare --mount --net --pid --fork true || {
  echo "Skipped: this system does not let root mount"
  exit 125
}
mkdir -p "$folder"

make_system()
{
  bash Testing/packages.sh wheel
  [ ! -e "$root.made" ] || return 0
  local archive
  archive=$(apt-cache policy | sed -n 's|^ *[0-9]* \(http[^ ]*/debian\)/\? .*|\1|p' | head -1)
  [ -n "$archive" ] || {
    echo "apt on this system knows no Debian archive" >&2
    return 1
  }
  rm -rf --one-file-system "$root"
  debootstrap --variant=minbase --include=python3-venv bullseye "$root" "$archive" \
    /usr/share/debootstrap/scripts/sid
  chroot "$root" useradd --create-home user
  touch "$root.made"
}

download_packages() # those that the wheel depends on, for Python 3.9
{
  python3 -m pip download --quiet --disable-pip-version-check --only-binary=:all: \
    --python-version 3.9 --platform manylinux_2_28_x86_64 --platform manylinux2014_x86_64 \
    --dest "$folder/packages" numpy pocl-binary-distribution
}

make_system >"$folder/bullseye.log" 2>&1 &
system=$!
download_packages &
download=$!
bash Python/wheel.sh "$folder"
wait $system || {
  tail -20 "$folder/bullseye.log"
  exit 1
}
wait $download

# Nothing of this system's environment, user or network.
inside() # command...
{
  unshare --mount --net --pid --fork --kill-child bash -c '
    set -e
    root=$0
    mount --bind "$root" "$root"
    mount -t proc proc "$root/proc"
    mount --bind /dev/null "$root/dev/null"
    mount --bind /dev/urandom "$root/dev/urandom"
    mount -t tmpfs -o mode=1777 tmpfs "$root/dev/shm"
    cd "$root"
    pivot_root . .
    umount --lazy .
    cd /home/user
    exec /usr/bin/setpriv --reuid=user --regid=user --init-groups --inh-caps=-all \
      --no-new-privs /usr/bin/env -i HOME=/home/user LANG=C.UTF-8 PATH=/usr/bin:/bin "$@"' \
    "$root" "$@" </dev/null
}

mkdir -p "$root/dev/shm"
[ -e "$root/dev/null" ] || touch "$root/dev/null"
[ -e "$root/dev/urandom" ] || touch "$root/dev/urandom"
rm -rf "$root/wheels" "$root/home/user" "$root/tests"
install -d -o 1000 -g 1000 "$root/home/user"
mkdir "$root/wheels" "$root/tests"
cp "$folder"/*.whl "$folder"/packages/*.whl "$root/wheels"
cp Testing/Wheel/*.py "$root/tests"
inside bash -c '
  set -e
  for program in ld gcc cc clang c++; do
    ! command -v $program || { echo "there is a $program"; exit 1; }
  done
  python3 -m venv venv
  venv/bin/pip install --quiet --no-index --find-links /wheels deformvolume
  for test in /tests/test_*.py; do
    echo "== $test"
    venv/bin/python "$test"
  done'
