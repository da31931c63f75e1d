#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing (on Debian and Ubuntu, as root), builds the preset vtk, and deforms two
# volumes of the Debian package mricron-data with a tetrahedral mesh:
#
#   build/demo/deformed.vti, before-after.png
#       ch2better, the brain of an MRI at 301 x 370 x 316 voxels, pushed in at its front
#   build/demo/head-deformed.vti, head-before-after.png
#       ch2, the whole head at 181 x 217 x 181 voxels, with its nose pushed in
#   build/demo/cut-and-pull.png
#       ch2better again, cut along a sheet and pulled open
#   build/demo/squished-head.png
#       ch2 again, pulled by its nose, by finite elements and by springs
#
# Can be repeated. Needs no network if nothing is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

bash Testing/packages.sh library example
# The packages that only tests need are not required. An existing build directory is not reconfigured.
[ -f build/vtk/build.ninja ] || cmake --preset vtk -DBUILD_TESTING=OFF
cmake --build --preset vtk --target deform-volume cut-and-pull squished-head deform-interactive \
  vtkDeformVolumePython vtkDeformVolumeInteractionPython

templates=/usr/share/mricron/templates
mkdir -p build/demo/kernel-cache
export POCL_CACHE_DIR="${POCL_CACHE_DIR:-$PWD/build/demo/kernel-cache}"

deform() # VOLUME RESULT PICTURE OPTION...: OPTION is an option of deform-volume
{
  local volume=$1 result=$2 image=$3
  shift 3
  echo
  echo "$volume"
  # Without -noreset, the X server resets when its last client exits, which can end the next client.
  xvfb-run -a -s "-noreset -screen 0 1400x1024x24" build/vtk/bin/deform-volume \
    "$volume" --tetgen "$@" --output "build/demo/$result" --image "build/demo/$image"
  echo "See build/demo/$image and build/demo/$result"
}

# Positions are in mm: x to the right, y to the front, z to the head.
deform $templates/ch2better.nii.gz deformed.vti before-after.png \
  --push 0,72,-5,0,-25,0,60
deform $templates/ch2.nii.gz head-deformed.vti head-before-after.png \
  --push 0,90,-54,0,-20,0,45

echo
echo "$templates/ch2better.nii.gz, cut and pulled open"
xvfb-run -a -s "-noreset -screen 0 1400x1024x24" build/vtk/bin/cut-and-pull \
  $templates/ch2better.nii.gz build/demo/cut-and-pull.png
echo "See build/demo/cut-and-pull.png"

echo
echo "$templates/ch2.nii.gz, pulled by its nose"
xvfb-run -a -s "-noreset -screen 0 1400x1024x24" build/vtk/bin/squished-head \
  $templates/ch2.nii.gz build/demo/squished-head.png 400
echo "See build/demo/squished-head.png"

echo
echo "build/vtk/bin/deform-interactive drags, cuts and carves the head in a window"
