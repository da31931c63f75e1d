#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the wheel of the Python package, and tests it in a minimal Debian system: as a user without
# privileges, without OpenCL, compiler, linker and network, with VTK from PyPI, but without the libraries
# for windows that VTK uses. Run this as root on Debian. The minimal system comes from the Debian archive
# that apt uses here, the packages come from PyPI. Both are downloaded once.
#
# Usage: pristine.sh [--wheel FILE] [SUITE [VTK]]
#   SUITE   a release of Debian: bullseye (the default), with the oldest versions of glibc, Python and VTK
#           that the package supports: 2.31, 3.9 and 9.3.0
#   VTK     a version of VTK on PyPI (the default for other releases: the newest one)
#   --wheel tests this wheel, and does not build one
set -euo pipefail
cd "$(dirname "$0")/../.."
wheel=
if [ "${1-}" = --wheel ]; then
  wheel=$(realpath "$2")
  shift 2
fi
suite=${1-bullseye}
vtk=${2-}
[ -n "$vtk" ] || [ "$suite" != bullseye ] || vtk=9.3.0
folder=$PWD/build/wheel
root=$folder/$suite
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
  debootstrap --variant=minbase --include=python3-venv "$suite" "$root" "$archive" \
    /usr/share/debootstrap/scripts/sid
  chroot "$root" useradd --create-home user
  touch "$root.made"
}

download() # options and packages of pip; downloads them for the Python of the minimal system
{
  python3 -m pip download --quiet --disable-pip-version-check --only-binary=:all: \
    --python-version "$python" --platform manylinux_2_28_x86_64 --platform manylinux2014_x86_64 \
    --dest "$folder/packages/$python" "$@"
}

make_system >"$root.log" 2>&1 &
system=$!
if [ -z "$wheel" ]; then
  bash Python/wheel.sh "$folder"
  wheel=$(ls "$folder"/deformvolume-*.whl)
fi
wait $system || {
  tail -20 "$root.log"
  exit 1
}
python=$(chroot "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
download numpy pocl-binary-distribution
download --no-deps "vtk${vtk:+==$vtk}"

# Runs a command in the minimal system, without the environment, the user and the network of this one.
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
cp "$wheel" "$folder/packages/$python"/*.whl "$root/wheels"
cp Testing/Wheel/*.py "$root/tests"
inside bash -c '
  set -e
  for program in ld gcc cc clang c++; do
    ! command -v $program || { echo "$program is installed, but this test is for systems without it"; exit 1; }
  done
  python3 -m venv venv
  pip="venv/bin/pip install --quiet --no-index --find-links /wheels"
  $pip deformvolume
  # The dependencies of VTK are only needed for rendering.
  $pip --no-deps --no-compile "vtk$0"
  for test in /tests/test_*.py; do
    echo "== $test"
    venv/bin/python "$test"
  done
  venv/bin/python -c "import platform, numpy, deformvolume.vtk
from vtkmodules.vtkCommonCore import vtkVersion
print(\"passed: Python\", platform.python_version() + \", numpy\", numpy.__version__ + \", vtk\",
      vtkVersion.GetVTKVersion())"' "${vtk:+==$vtk}"
