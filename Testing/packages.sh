#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what this project needs from Debian's archive, where it is missing. Needs no network,
# and no rights, where nothing is missing.
#
# Usage: packages.sh SET...
#   library   to build the library and its Python package against VTK
#   example   to build and run the programs in Examples
#   test      to build and run the tests
#   benchmark to measure and draw the results, besides test
#   paraview  to build and test against ParaView's VTK on the same machine
#   check     to check the style of the sources
set -euo pipefail

declare -A packages=(
  [library]="g++ cmake ninja-build ccache libvtk9-dev python3-vtk9 libglm-dev opencl-headers
    opencl-clhpp-headers ocl-icd-opencl-dev pocl-opencl-icd tetgen"
  [example]="libcli11-dev mricron-data xvfb xauth"
  [test]="libgtest-dev libbenchmark-dev libopenmpi-dev openmpi-bin oclgrind python3-numpy mricron-data
    xvfb xauth"
  [benchmark]="python3-matplotlib"
  [paraview]="paraview paraview-dev libopenmpi-dev libdouble-conversion-dev libutfcpp-dev
    liblz4-dev liblzma-dev libgl-dev libopengl-dev libx11-dev libglew-dev libfreetype-dev"
  [check]="clang-format"
)

version() # of an installed package; empty where it is not installed
{
  dpkg-query --show --showformat '${db:Status-Status} ${Version}' "$1" 2>/dev/null |
    sed -n 's/^installed //p'
}

updated=no
update() # apt's lists, once
{
  if [ $updated = no ]; then
    apt-get update -qq
    updated=yes
  fi
}

download() # a package's file into a folder
{
  (cd "$2" && apt-get download -qq -o APT::Sandbox::User=root "$1")
}

install()
{
  local missing=() package
  for package in "$@"; do
    [ -n "$(version "$package")" ] || missing+=("$package")
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

# ParaView's Python package conflicts with VTK's, although no file of one overwrites a file of the
# other's library. So that both can be built against on one machine, a complete ParaView is put
# together in build/paraview-prefix: that package's files, and links to those of the others.
paraview_prefix()
{
  local prefix=build/paraview-prefix wanted package
  wanted="$(version paraview-dev) $(version paraview)"
  [ "$(cat $prefix/version 2>/dev/null)" = "$wanted" ] && return
  echo "Putting ParaView together in $prefix"
  rm -rf $prefix
  mkdir -p $prefix/download
  package="python3-paraview=$(version paraview)"
  download "$package" $prefix/download || {
    update
    download "$package" $prefix/download
  }
  dpkg -x $prefix/download/python3-paraview_*.deb $prefix
  rm -r $prefix/download
  dpkg -L paraview paraview-dev | sort -u | while read -r file; do
    [ -z "$file" ] || [ -d "$file" ] || printf '%s\0' "$file"
  done | xargs -0 cp --symbolic-link --parents --force --target-directory $prefix
  # CMake resolves links before it looks for what lies beside a package file.
  local cmake
  for cmake in /usr/lib/*/cmake/paraview-*; do
    rm -rf "$prefix$cmake"
    cp -r "$cmake" "$prefix$cmake"
  done
  echo "$wanted" >$prefix/version
}

cd "$(dirname "$0")/.."
if [ $# -eq 0 ]; then
  echo "usage: packages.sh ${!packages[*]}" >&2
  exit 2
fi
for set in "$@"; do
  if [ -z "${packages[$set]-}" ]; then
    echo "packages.sh: no set $set; there are: ${!packages[*]}" >&2
    exit 2
  fi
  # shellcheck disable=SC2086 # a list of words
  install ${packages[$set]}
  if [ "$set" = paraview ]; then
    paraview_prefix
  fi
done
