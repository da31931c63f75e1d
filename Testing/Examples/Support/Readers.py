# SPDX-License-Identifier: BSD-3-Clause
"""Common parts of the tests that compare deform-volume with SimpleITK, nibabel, pynrrd and pydicom.
Scripts that use these run with the Python of "Testing/packages.sh readers"."""
import json
import os
import re
import sys

import numpy
from Volumes import call, read_vti
from vtkmodules.util.numpy_support import vtk_to_numpy

here = os.path.dirname(os.path.abspath(__file__))
python = os.path.join(here, "..", "..", "..", "build", "readers", "bin", "python")
# A push that moves no voxel by as much as 1/512 voxel, so that values do not change.
still = ("--lattice", "3,3,3", "--push", "0,0,0,1e-7,0,0,1e6", "--bounds", "volume", "--quiet")


def run(script, *arguments):
    """Runs a script with the Python that "Testing/packages.sh readers" installs; skips the test without it."""
    if not os.path.exists(python):
        print("Skipped: run bash Testing/packages.sh readers, which installs SimpleITK, nibabel, pynrrd "
              "and pydicom from PyPI.")
        sys.exit(125)
    # PYTHONPATH has modules for the Python of this test, which another version of Python cannot load.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    call(python, os.path.join(here, script), *arguments, environment=environment)


def load(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return json.load(file)


def fails(program, folder, name, words, *arguments):
    """Checks that the program fails with one line which contains words, and no names of functions or source files."""
    target = os.path.join(folder, "no.vti")
    _, errors = call(program, os.path.join(folder, name), *still, *arguments, "-o", target, code=1)
    assert errors.startswith("deform-volume: cannot read ") and errors.count("\n") == 1, errors
    assert words in errors, f"{words} is not in {errors}"
    assert not any(part in errors for part in ("0x", "::", ".cxx", "()")), errors
    assert not os.path.exists(target)


def get_matrix(image):
    """Returns the matrix from an index, counted from the first voxel of the extent, to the world."""
    extent = image.GetExtent()
    first = [0.0] * 3
    image.TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], first)
    direction = image.GetDirectionMatrix()
    matrix = numpy.eye(4)
    matrix[:3, :3] = numpy.array([[direction.GetElement(row, column) for column in range(3)]
                                  for row in range(3)]) * numpy.array(image.GetSpacing())
    matrix[:3, 3] = first
    return matrix


def get_array(image):
    """Returns the scalars as an array [z, y, x(, component)]."""
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(*image.GetDimensions()[::-1], *values.shape[1:])


def get_distance(matrix, place, shape):
    """Returns the largest distance of the corners of a volume from their expected positions, in voxels and in mm.
    matrix, place: the actual and the expected matrix from the index to the world."""
    corners = numpy.array([[x, y, z, 1] for z in (0, shape[0] - 1) for y in (0, shape[1] - 1)
                           for x in (0, shape[2] - 1)])
    voxels = numpy.linalg.inv(place) @ matrix @ corners.T - corners.T
    return numpy.abs(voxels).max(), numpy.linalg.norm((matrix - place) @ corners.T, axis=0).max()


def compare(image, values, place):
    """Checks that values and their type are as expected. Returns the distances of get_distance()."""
    matrix = get_matrix(image)
    read = get_array(image)
    assert read.dtype == values.dtype, (read.dtype, values.dtype)
    assert numpy.array_equal(read, values, equal_nan=read.dtype.kind == "f"), (read.shape, values.shape)
    return get_distance(matrix, place, values.shape)


def check(program, folder, case, *outputs):
    """Checks that deform-volume reads a file as the other program did, with the expected warnings and no others."""
    target = os.path.join(folder, "read.vti")
    arguments = [argument for output in outputs for argument in ("-o", output)]
    _, errors = call(program, os.path.join(folder, case["file"]), *still, *case["arguments"], "-o",
                     target, *arguments)
    assert errors.count("warning:") == len(case["warnings"]), errors
    for warning in case["warnings"]:
        assert warning in errors, f"{warning} is not in {errors}"
    values = numpy.load(os.path.join(folder, case["values"]))
    voxels, distance = compare(read_vti(target), values, numpy.array(case["place"]))
    if case["shear"] == 0:
        assert voxels < 1e-4, voxels
        return
    # Sheared axes are replaced by perpendicular ones: the warning states how far voxels are moved by that.
    assert abs(distance - case["farthest"]) < 1e-3 * case["farthest"] + 1e-6, (distance, case["farthest"])
    numbers = re.search("sheared by ([-0-9.e]+)[.] .* up to ([-0-9.e]+) from", errors)
    for number, expected in zip(numbers.groups() if numbers else (), (case["shear"], case["farthest"])):
        assert abs(float(number) / expected - 1) < 1e-3, (number, expected)
