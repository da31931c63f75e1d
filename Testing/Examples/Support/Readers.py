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
python = os.path.join(here, "..", "..", "build", "readers", "bin", "python")
# A push that moves no voxel by as much as 1/512, so that values stay as they are.
still = ("--lattice", "3,3,3", "--push", "0,0,0,1e-7,0,0,1e6", "--bounds", "volume", "--quiet")


def run(script, *arguments):
    """Runs a script; skips the test where its Python is not installed."""
    if not os.path.exists(python):
        print("Skipped: run bash Testing/packages.sh readers, which installs SimpleITK, nibabel, pynrrd "
              "and pydicom from PyPI.")
        sys.exit(125)
    # A path for the modules of this Python is none for another one.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    call(python, os.path.join(here, script), *arguments, environment=environment)


def load(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return json.load(file)


def fails(program, folder, name, words, *arguments):
    """The program says what is wrong with a file, and neither a function nor a place in its sources."""
    target = os.path.join(folder, "no.vti")
    _, errors = call(program, os.path.join(folder, name), *still, *arguments, "-o", target, code=1)
    assert errors.startswith("deform-volume: cannot read ") and errors.count("\n") == 1, errors
    assert words in errors, f"{words} is not in {errors}"
    assert not any(part in errors for part in ("0x", "::", ".cxx", "()")), errors
    assert not os.path.exists(target)


def get_matrix(image):
    """Index to world, of the index counted from the first voxel."""
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
    """The scalars as an array [z, y, x(, component)]."""
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(*image.GetDimensions()[::-1], *values.shape[1:])


def get_distance(matrix, place, shape):
    """How far the corners of a volume lie at most from where they should, in voxels and in mm."""
    corners = numpy.array([[x, y, z, 1] for z in (0, shape[0] - 1) for y in (0, shape[1] - 1)
                           for x in (0, shape[2] - 1)])
    voxels = numpy.linalg.inv(place) @ matrix @ corners.T - corners.T
    return numpy.abs(voxels).max(), numpy.linalg.norm((matrix - place) @ corners.T, axis=0).max()


def compare(image, values, place):
    """Values are equal, in their type, and voxels lie where they should."""
    matrix = get_matrix(image)
    # VTK's reader of NIfTI files turns the order of slices where that makes axes right-handed.
    if (numpy.linalg.inv(place) @ matrix)[2, 2] < -0.5:
        values = values[::-1]
        place = place.copy()
        place[:3, 3] += place[:3, 2] * (len(values) - 1)
        place[:3, 2] *= -1
    read = get_array(image)
    assert read.dtype == values.dtype, (read.dtype, values.dtype)
    assert numpy.array_equal(read, values, equal_nan=read.dtype.kind == "f"), (read.shape, values.shape)
    return get_distance(matrix, place, values.shape)


def check(program, folder, case, *outputs):
    """A file is read as the other program read it, and with the warning that belongs to it alone."""
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
    # Sheared axes cannot be those of the file: the warning says how far voxels lie from there.
    assert abs(distance - case["farthest"]) < 1e-3 * case["farthest"] + 1e-6, (distance, case["farthest"])
    numbers = re.search("sheared by ([-0-9.e]+)[.] .* up to ([-0-9.e]+) from", errors)
    for number, expected in zip(numbers.groups() if numbers else (), (case["shear"], case["farthest"])):
        assert abs(float(number) / expected - 1) < 1e-3, (number, expected)
