# SPDX-License-Identifier: BSD-3-Clause
"""Tests press_head.py, which presses a head with CalculiX: the displacements in the result file are those that CalculiX
prints, deform-volume moves voxels by these displacements, and the picture equals the baseline.
Usage: TestCalculiX.py PROGRAM SCRIPT BASELINE FOLDER"""
import os
import re
import shutil
import sys

import numpy
from Baselines import find_difference, read_baselines, read_picture
from Readers import python
from Volumes import begin_test, call, make_ball, read_vti
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkNIFTIImageReader, vtkNIFTIImageWriter, vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

VOLUME = "/usr/share/mricron/templates/ch2.nii.gz"
LIMIT = 0.3  # limit of the mean difference of color components (0 to 255)
CORNERS = ((0, 4, 6, 7), (1, 5, 4, 8), (2, 6, 5, 9), (3, 8, 7, 9))  # tetrahedra of a corner and three mid-side nodes

program, script, baseline, path = begin_test("CalculiX")
environment = dict(os.environ, PATH=os.path.dirname(python) + os.pathsep + os.environ["PATH"])
for name, advice in (("ccx", "install calculix-ccx"),
                     ("ccx2paraview", "run bash Testing/packages.sh readers, which installs it from PyPI")):
    if not shutil.which(name, path=environment["PATH"]):
        print(f"skipped: {name} is missing: {advice}")
        sys.exit(125)
if not os.path.exists(VOLUME):
    print(f"skipped: {VOLUME} is missing, install the package mricron-data")
    sys.exit(125)


def check_misuse():
    """Calls the script without a program, and with a volume that contains no head."""
    _, errors = call(sys.executable, script, VOLUME, path(), "--deform-volume", path("none"), code=1)
    assert f"there is no program {path('none')}" in errors, errors
    _, errors = call(sys.executable, script, VOLUME, path(), "--deform-volume", program, code=1,
                     environment=dict(os.environ, PATH=""))
    assert "there is no program ccx: install CalculiX" in errors, errors
    writer = vtkNIFTIImageWriter()
    writer.SetFileName(path("ball.nii"))
    writer.SetInputData(make_ball(spacing=(1.0, 1.0, 1.0)))
    writer.Write()
    _, errors = call(sys.executable, script, path("ball.nii"), path("ball"), "--edge-length", 5, "--deform-volume",
                     program, code=1, environment=environment)
    assert "The volume must be a head" in errors, errors


def read_result():
    """Returns nodes, displacements at the last time, and the ten nodes of each tetrahedron."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path("head.4.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    return (vtk_to_numpy(grid.GetPoints().GetData()).astype(float), vtk_to_numpy(grid.GetPointData().GetArray("U")),
            vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 10))


def check_numbers(places, moves, tetrahedra):
    """Checks nodes and tetrahedra against the input of CalculiX, and displacements against the numbers that it prints.
    A .frd file has six digits."""
    with open(path("head.inp"), encoding="ascii") as file:
        text = file.read()
    rows = re.search(r"^\*NODE, NSET=ALL\n((?:\d.*\n)+)", text, flags=re.MULTILINE).group(1).splitlines()
    given = numpy.array([row.split(",") for row in rows], dtype=float)
    assert numpy.array_equal(given[:, 0], 1 + numpy.arange(len(places)))
    assert numpy.allclose(places, given[:, 1:], rtol=5.1e-6, atol=1e-12)
    rows = re.search(r"^\*ELEMENT.*\n((?:\d.*\n)+)", text, flags=re.MULTILINE).group(1).splitlines()
    assert numpy.array_equal(tetrahedra + 1, numpy.array([row.split(",")[1:] for row in rows], dtype=int))
    with open(path("head.dat"), encoding="ascii") as file:
        parts = file.read().split("displacements")
    assert len(parts) == 1 + 4, len(parts)
    printed = [line.split() for line in parts[-1].splitlines()[1:] if line.strip()]
    assert len(printed) == 4, printed
    for row in printed:
        move = moves[int(row[0]) - 1]
        assert numpy.linalg.norm(move) > 0.5, row
        assert numpy.allclose(move, numpy.array(row[1:], dtype=float), rtol=5.1e-6, atol=1e-12), (row, move)


def get_distances(corners, points):
    """Returns for each point the distance from the nearest face of its tetrahedron."""
    distances = [numpy.einsum("ij,ij->i", points - corners[:, a], normal) / numpy.linalg.norm(normal, axis=1)
                 for a, b, c, d in ((0, 1, 2, 3), (1, 2, 3, 0), (2, 3, 0, 1), (3, 0, 1, 2))
                 for normal in [numpy.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, a])]
                 for normal in [normal * numpy.sign(numpy.einsum("ij,ij->i", normal, corners[:, d] - corners[:, a]))
                                [:, None]]]
    return numpy.min(distances, axis=0)


def read_bounds():
    """Returns the positions of the first and the last voxel of the volume. Its axes are those of the world, and its
    spacing is 1 mm."""
    reader = vtkNIFTIImageReader()
    reader.SetFileName(VOLUME)
    reader.Update()
    matrix = numpy.array([[reader.GetSFormMatrix().GetElement(i, j) for j in range(4)] for i in range(3)])
    assert numpy.array_equal(matrix[:, :3], numpy.eye(3)), matrix
    return matrix[:, 3], matrix[:, 3] + reader.GetOutput().GetDimensions() - 1


def check_voxels(places, moves, tetrahedra):
    """Checks that the rest position of each voxel within a tetrahedron is the one with the same barycentric
    coordinates. The deformation is linear there, so the only error is the rounding of positions: 1/256 voxel, times the
    stretch."""
    call(program, VOLUME, "--mesh", path("head.pvd"), "--displacement", "U", "--inverse-field", path("inverse.vti"),
         "--quiet")
    field = read_vti(path("inverse.vti"))
    vectors = vtk_to_numpy(field.GetPointData().GetArray(0)).reshape(*field.GetDimensions()[::-1], 3)
    spacing = numpy.array(field.GetSpacing())
    assert numpy.allclose(spacing, 1.0), spacing
    first = numpy.array(field.GetPoint(0))
    small = tetrahedra[:, CORNERS].reshape(-1, 4)
    rest, deformed = places[small], (places + moves)[small]
    # The voxel that is nearest to the centroid of each tetrahedron.
    index = numpy.rint((deformed.mean(axis=1) - first) / spacing).astype(int)
    voxels = first + index * spacing
    inside = ((index >= 0) & (index < vectors.shape[2::-1])).all(axis=1)
    edges = deformed[:, 1:] - deformed[:, :1]
    weights = numpy.linalg.solve(numpy.swapaxes(edges, 1, 2), (voxels - deformed[:, 0])[:, :, None])
    expected = rest[:, 0] + numpy.einsum("ijk,ij->ik", rest[:, 1:] - rest[:, :1], weights[:, :, 0])
    # Only voxels are compared whose rest position lies in a cell that is within the tetrahedron and within the volume.
    # The mesh extends beyond the volume.
    low, high = read_bounds()
    inside &= ((expected > low) & (expected < high)).all(axis=1)
    chosen = numpy.flatnonzero(inside & (get_distances(rest, expected) > 1.75))
    moved = chosen[numpy.linalg.norm(expected - voxels, axis=1)[chosen] > 2.0]
    assert len(moved) > 100, (len(chosen), len(moved))
    found = vectors[tuple(index[chosen].T[::-1])] + voxels[chosen]
    stretch = numpy.linalg.norm((rest[:, 1:] - rest[:, :1]).transpose(0, 2, 1) @
                                numpy.linalg.inv(edges.transpose(0, 2, 1)), ord=2, axis=(1, 2))[chosen]
    wrong = numpy.linalg.norm(found - expected[chosen], axis=1)
    print(f"{len(chosen)} voxels, {len(moved)} of them moved by more than 2 mm, are wrong by at most {wrong.max()} mm")
    assert (wrong <= stretch / 256).all(), (wrong / stretch).max()


def shrink(name, small):
    """Writes a picture of a quarter of the width, without the captions."""
    picture = read_picture(path(name))[60:]
    height, width, _ = picture.shape
    picture = numpy.rint(picture.reshape(height // 4, 4, width // 4, 4, 3).mean(axis=(1, 3))).astype(numpy.uint8)
    image = vtkImageData()
    image.SetDimensions(width // 4, height // 4, 1)
    array = numpy_to_vtk(picture.reshape(-1, 3), deep=True)
    array.SetName("Colors")
    image.GetPointData().SetScalars(array)
    writer = vtkPNGWriter()
    writer.SetFileName(path(small))
    writer.SetInputData(image)
    writer.Write()
    return path(small)


def check_picture():
    """Checks that the picture equals the baseline, and that a picture with nine tenths of the displacements does
    not."""
    baselines = read_baselines(baseline)
    assert find_difference(shrink("pressed.png", "small.png"), baselines) < LIMIT
    call(program, VOLUME, "--mesh", path("head.pvd"), "--displacement", "U", "--scale", "0.9", "--view", "0.6,1,0.1",
         "--image", path("spoiled.png"), "--quiet")
    assert find_difference(shrink("spoiled.png", "small-spoiled.png"), baselines) > 2 * LIMIT


check_misuse()
output, _ = call(sys.executable, script, VOLUME, path(), "--edge-length", 28, "--deform-volume", program,
                 environment=environment)
for landmark in ("nose", "crown", "left ear", "brain"):
    assert f"{landmark} (node" in output, output
assert "Inverted tetrahedra: 0\n" in output, output
result = read_result()
check_numbers(*result)
check_voxels(*result)
check_picture()
