#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages of Debian that this project needs and that are missing. If none is missing, it
# needs neither a network nor root.
#
# Usage: packages.sh [--upgrade] SET...
#   --upgrade first updates the packages of the sets and their dependencies
#   engine    to build the engine, which needs no VTK
#   library   to build the library and its Python package against VTK
#   example   to build and run the programs in Examples
#   test      to build and run the tests
#   readers   to compare volumes and transforms with other programs, which are installed from PyPI to
#             build/readers, and to run CalculiX
#   benchmark to run benchmarks and draw their results, in addition to the set test
#   paraview  to build and test against ParaView's VTK on the same machine
#   check     to check the style of the sources
#   clang     to build with Clang
#   wheel     to build the wheel of the Python package and to test it in a pristine system
#   platforms to test on other Debian releases
#   gpu-compilers for Testing/gpu-compilers.sh, on Debian 12
set -euo pipefail

declare -A packages=(
  [engine]="g++ cmake ninja-build ccache libglm-dev libeigen3-dev
    opencl-headers opencl-clhpp-headers ocl-icd-opencl-dev pocl-opencl-icd"
  [library]="g++ cmake ninja-build ccache libvtk9-dev python3-vtk9 libglm-dev libeigen3-dev
    opencl-headers opencl-clhpp-headers ocl-icd-opencl-dev pocl-opencl-icd tetgen"
  [example]="libcli11-dev libinsighttoolkit5-dev mricron-data xvfb xauth"
  [test]="libgtest-dev libbenchmark-dev libopenmpi-dev openmpi-bin oclgrind python3-numpy python3-xlib
    mricron-data xvfb xauth doxygen"
  [readers]="python3-venv calculix-ccx"
  [benchmark]="python3-matplotlib"
  [paraview]="paraview paraview-dev libopenmpi-dev libdouble-conversion-dev libutfcpp-dev
    liblz4-dev liblzma-dev libgl-dev libopengl-dev libx11-dev libglew-dev libfreetype-dev"
  [check]="clang-format"
  [clang]="clang"
  [wheel]="cmake ninja-build binutils libglm-dev libeigen3-dev opencl-headers opencl-clhpp-headers
    python3-venv python3-pip debootstrap"
  [platforms]="debootstrap curl"
  [gpu-compilers]="clang-15 libclc-15 llvm-spirv-15 spirv-tools rocm-device-libs oclgrind"
)
# Packages that are left out if the system does not have them. Tests that need them are skipped.
optional="oclgrind calculix-ccx"

version() # PACKAGE: prints the version of an installed package; nothing if it is not installed
{
  dpkg-query --show --showformat '${db:Status-Status} ${Version}' "$1" 2>/dev/null |
    sed -n 's/^installed //p'
}

updated=no
update() # updates the package lists of apt, once
{
  if [ $updated = no ]; then
    apt-get update -qq
    updated=yes
  fi
}

download() # PACKAGE FOLDER: downloads the file of a package
{
  (cd "$2" && apt-get download -qq -o APT::Sandbox::User=root "$1")
}

is_available() # PACKAGE: whether the package lists contain it
{
  apt-cache show --no-all-versions "$1" >/dev/null 2>&1
}

# Updates packages and their dependencies, as far as these are installed.
upgrade()
{
  local installed=() package
  update
  for package in $(apt-cache depends --recurse --installed --no-suggests --no-conflicts \
    --no-breaks --no-replaces --no-enhances "$@" 2>/dev/null | grep '^[a-z]' | sort -u); do
    [ -z "$(version "$package")" ] || installed+=("$package")
  done
  [ ${#installed[@]} -eq 0 ] ||
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --only-upgrade --no-install-recommends \
      --no-remove -o Dpkg::Options::=--force-confold "${installed[@]}" >/dev/null
}

install()
{
  local missing=() package
  for package in "$@"; do
    [ -n "$(version "$package")" ] || missing+=("$package")
  done
  for package in $optional; do
    if [[ " ${missing[*]} " == *" $package "* ]]; then
      # A new system has no package lists yet.
      is_available g++ || update
      is_available "$package" && continue
      echo "This system has no package $package: the tests that need it are skipped"
      mapfile -t missing < <(printf '%s\n' "${missing[@]}" | grep -vx "$package")
    fi
  done
  [ ${#missing[@]} -eq 0 ] && return
  echo "Installing ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    echo "Only root can install packages. Run: apt-get install ${missing[*]}" >&2
    return 1
  fi
  update
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends --no-remove \
    "${missing[@]}" >/dev/null
}

# Makes a complete ParaView in build/paraview-prefix, with links to installed files. Debian's packages
# alone do not suffice, for two reasons. On Debian 12 and 13, ParaView's Python package conflicts with
# VTK's, although they have no file in common. So it is unpacked there, and both can be used on one
# machine. On Debian 13 and later, the CMake files name Python modules without the tag of the Python
# version that the files have.
paraview_prefix()
{
  local prefix=build/paraview-prefix wanted package linked=(paraview paraview-dev)
  wanted="$(version paraview-dev) $(version paraview)"
  [ "$(cat $prefix/version 2>/dev/null)" = "$wanted" ] && return
  echo "Putting ParaView together in $prefix"
  is_available python3-paraview || update
  rm -rf $prefix
  mkdir -p $prefix/download
  if apt-cache show --no-all-versions python3-paraview |
    grep '^Conflicts:.*python3-vtk9' >/dev/null; then
    package="python3-paraview=$(version paraview)"
    download "$package" $prefix/download || {
      update
      download "$package" $prefix/download
    }
    dpkg -x $prefix/download/python3-paraview_*.deb $prefix
  else
    install python3-paraview
    linked+=(python3-paraview)
  fi
  rm -r $prefix/download
  dpkg -L "${linked[@]}" | sort -u | while read -r file; do
    [ -z "$file" ] || [ -d "$file" ] || printf '%s\0' "$file"
  done | xargs -0 cp --symbolic-link --parents --force --target-directory $prefix
  local module
  find $prefix/usr/lib/python3 -name '*.cpython-*.so' | while read -r module; do
    ln -sf "$(basename "$module")" "${module%%.cpython-*}.so"
  done
  # CMake resolves links to package files before it looks for other files in their folder, so copy these.
  local cmake
  for cmake in /usr/lib/*/cmake/paraview-*; do
    rm -rf "$prefix$cmake"
    cp -r "$cmake" "$prefix$cmake"
  done
  echo "$wanted" >$prefix/version
}

# Installs SimpleITK, nibabel, pydicom, pynrrd and ccx2paraview in a virtual environment, because Debian
# has other versions of them or none. ccx2paraview also needs VTK, in PYTHONPATH.
readers()
{
  local folder=build/readers wanted
  local programs=("SimpleITK>=2.5.2,<2.6" "nibabel>=5.3,<6" "pydicom>=3.0,<4" "pynrrd>=1.1,<2"
    "ccx2paraview>=3.2,<4")
  wanted="$(/usr/bin/python3 --version) ${programs[*]}"
  [ "$(cat $folder/version 2>/dev/null)" = "$wanted" ] && return
  echo "Installing ${programs[*]} from PyPI in $folder"
  rm -rf $folder
  if /usr/bin/python3 -m venv $folder && $folder/bin/pip install --quiet "${programs[@]}"; then
    echo "$wanted" >$folder/version
  else
    rm -rf $folder
    echo "These packages cannot be installed: the tests that need them are skipped"
  fi
}

cd "$(dirname "$0")/.."
upgrade=no
if [ "${1-}" = --upgrade ]; then
  upgrade=yes
  shift
fi
if [ $# -eq 0 ]; then
  echo "usage: packages.sh [--upgrade] ${!packages[*]}" >&2
  exit 2
fi
for set in "$@"; do
  if [ -z "${packages[$set]-}" ]; then
    echo "packages.sh: no set $set; there are: ${!packages[*]}" >&2
    exit 2
  fi
done
if [ $upgrade = yes ]; then
  # shellcheck disable=SC2046 # a list of words
  upgrade $(for set in "$@"; do echo "${packages[$set]}"; done)
fi
for set in "$@"; do
  # shellcheck disable=SC2086 # a list of words
  install ${packages[$set]}
  if [ "$set" = paraview ]; then
    paraview_prefix
  elif [ "$set" = readers ]; then
    readers
  fi
done
