# SPDX-License-Identifier: BSD-3-Clause
"""Tests the options of deform-volume, and the texts and exit codes of its errors.
Usage: TestCommandLine.py PROGRAM FOLDER"""
import functools
import os
import re

import Messages
import numpy
from MeshFiles import to_points, to_vtk, write
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkStructuredGrid, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import (
    vtkXMLStructuredGridWriter,
    vtkXMLUnstructuredGridReader,
    vtkXMLUnstructuredGridWriter,
)

program, path = begin_test("CommandLine")
volume = make_ball()
write_vti(volume, path("in.vti"))
push = ("--push", "9,20,25,3,0,0,15")
lattice = ("--lattice", "9,9,9")


fails = functools.partial(Messages.fails, program)

# Wrong usage.
fails(2, "no VOLUME")
fails(2, "exactly one of --mesh, --field, --transform, --tetgen, --lattice and --model", path("in.vti"), "-o", path("o.vti"))
fails(2, "exactly one of", path("in.vti"), "--tetgen", *lattice, *push, "-o", path("o.vti"))
fails(2, "seven numbers", path("in.vti"), *lattice, "--push", "1,2,3", "-o", path("o.vti"))
fails(2, "seven numbers", path("in.vti"), *lattice, "--push", "1,2,3,4,5,6,7,8", "-o",
      path("o.vti"))
fails(2, "radius", path("in.vti"), *lattice, "--push", "1,2,3,4,5,6,0", "-o", path("o.vti"))
fails(2, "at least 2 nodes", path("in.vti"), "--lattice", "3,1,3", *push, "-o", path("o.vti"))
fails(2, "three node counts", path("in.vti"), "--lattice", "3,3", *push, "-o", path("o.vti"))
fails(2, "nothing to write", path("in.vti"), *lattice, *push)
fails(1, "--background nan needs a volume of real numbers", path("in.vti"), *lattice, *push, "--background", "nan",
      "-o", path("o.vti"))
fails(2, "at least one --push", path("in.vti"), *lattice)
fails(2, "at least one --push", path("in.vti"), *lattice, "-o", path("o.vti"), "--write-mesh",
      path("m.vtu"))
fails(2, "--write-mesh requires --tetgen or --lattice", path("in.vti"), "--carve",
      "sphere:9,20,25,5", "-o", path("o.vti"), "--write-mesh", path("m.vtu"))
fails(2, "must end in .vti", path("in.vti"), *lattice, *push, "-o", path("o.jpg"))
fails(2, "must end in .png", path("in.vti"), *lattice, *push, "--image", path("o.jpg"))
fails(2, "--displacement", path("in.vti"), "--mesh", path("m.vtu"), "-o", path("o.vti"))
fails(2, "--nonsense", path("in.vti"), *lattice, *push, "-o", path("o.vti"), "--nonsense")
fails(2, "--outside", path("in.vti"), *lattice, *push, "-o", path("o.vti"), "--outside", "x")
fails(2, "VOLUME: the argument is empty", "", *lattice, *push, "-o", path("o.vti"))
for option in ("--output", "--reference", "--scale", "--background", "--frame", "--label-volume", "--transform",
               "--field", "--mesh", "--cut", "--points-output", "--gravity", "--tetgen-executable"):
    fails(2, f"{option}: the argument is empty", path("in.vti"), *lattice, *push, "-o", path("o.vti"), option, "")
# Each option takes one argument.
for option in ("-o", "--jacobian", "--cut", "--density-array"):
    fails(2, "not expected: second.vti", path("in.vti"), *lattice, *push, "-o", path("o.vti"), option, "first.vti",
          "second.vti")

# Options that do not apply.
mesh = ("--mesh", path("m.vtu"), "--displacement", "D")
tetgen = ("--tetgen", *push)
for deformation, option, expected in (
        ((*lattice, *push), ("--rest", path("m.vtu")), "--rest requires --mesh"),
        ((*lattice, *push), ("--displacement", "D"), "--displacement requires --mesh"),
        ((*lattice, *push), ("--scale", "2"), "--scale requires --mesh"),
        ((*lattice, *push), ("--isovalue", "4"), "--isovalue requires --tetgen"),
        ((*lattice, *push), ("--edge-length", "4"), "--edge-length requires --tetgen"),
        (mesh, ("--radius-edge-ratio", "2"), "--radius-edge-ratio requires --tetgen"),
        (mesh, ("--tetgen-executable", "t"), "--tetgen-executable requires --tetgen"),
        (mesh, ("--write-mesh", path("o.vtu")), "--write-mesh requires --tetgen"),
        (mesh, push, "--push requires"),
        (("--mesh", path("m.vtu"), "--rest", path("r.vtu")), ("--scale", "2"), "excludes"),
        (("--mesh", path("m.vtu"), "--rest", path("r.vtu")), ("--points-are-deformed",), "excludes"),
        ((*lattice, *push), ("--points-are-deformed",), "--points-are-deformed requires --mesh"),
        (tetgen, ("--isovalue", "4", "--labels"), "excludes"),
        (mesh, ("--threshold", "4"), "--threshold requires --image"),
        (mesh, ("--view", "0,1,0"), "--view requires --image")):
    fails(2, expected, path("in.vti"), *deformation, *option, "-o", path("o.vti"))

# Invalid numbers.
for number in ("nan", "inf", "many"):
    for deformation, option in ((mesh, "--scale"), (tetgen, "--isovalue"),
                                (tetgen, "--edge-length"), (tetgen, "--radius-edge-ratio"),
                                (("--image", path("o.png"), *mesh), "--threshold")):
        fails(2, option, path("in.vti"), *deformation, option, number, "-o", path("o.vti"))
    fails(2, "seven numbers", path("in.vti"), *lattice, "--push", f"1,2,3,4,{number},6,7", "-o",
          path("o.vti"))
    fails(2, "three node counts", path("in.vti"), "--lattice", f"3,{number},3", *push, "-o",
          path("o.vti"))
fails(2, "--edge-length", path("in.vti"), *tetgen, "--edge-length", "-1", "-o", path("o.vti"))
fails(2, "--radius-edge-ratio", path("in.vti"), *tetgen, "--radius-edge-ratio", "-1", "-o",
      path("o.vti"))
fails(2, "--padding", path("in.vti"), *lattice, *push, "--padding", "-1", "-o", path("o.vti"))
for text in ("1,2", "1,0,1", "1,1,-2"):
    fails(2, f"--spacing {text}: ", path("in.vti"), *lattice, *push, "--spacing", text, "-o", path("o.vti"))
call(program, path("in.vti"), *lattice, *push, "--spacing", "2,0.75,1", "-o", path("spacing.vti"))
assert read_vti(path("spacing.vti")).GetSpacing() == (2, 0.75, 1)
for option in ("--padding", "--frame", "--frames"):
    fails(2, f"{option}: 010 begins with 0", path("in.vti"), *lattice, *push, option, "010", "-o", path("o.vti"))

# The help names the formats that the program reads and writes, and no others.
help_text, _ = call(program, "--help", quiet=True)


def get_formats(begin):
    line = [line for line in help_text.splitlines() if line.lstrip().startswith(begin)][0]
    return set(re.findall(r"\.[a-z]+(?:\.gz)?", line.split("(the scalars)")[0])), line


read, line = get_formats("VOLUME FILE")
written, _ = get_formats("-o,--output")
assert {".nii", ".nii.gz", ".vti"} <= read == written, (read, written)
for suffix in read | {".nii", ".mhd", ".mha", ".nrrd", ".nhdr", ".mgz", ".img", ".tif"}:
    with open(path("text" + suffix), "w", encoding="utf-8") as file:
        file.write("no volume")
    _, errors = call(program, path("text" + suffix), *lattice, *push, "-o", path("o.vti"), code=1)
    assert ("a volume is a" in errors) == (suffix not in read), errors
    _, errors = call(program, path("none.vti"), *lattice, *push, "-o", path("o" + suffix), code=None)
    assert ("must end in" in errors) == (suffix not in written), errors
_, errors = call(program, path(), *lattice, *push, "-o", path("o.vti"), code=1)
assert ("DICOM" in line) == ("a volume is a" not in errors), errors

# Input files are not overwritten, whatever path to them is given.
with open(path("in.vti"), "rb") as file:
    content = file.read()
os.symlink("in.vti", path("link.vti"))
for output in ("in.vti", "../" + os.path.basename(path()) + "/in.vti", "link.vti"):
    fails(2, "overwritten", path("in.vti"), *lattice, *push, "-o", path("o.vti"), "-o",
          path(output))
fails(2, "overwritten", path("other.vti"), "--mesh", path("in.vti"), "--displacement", "D", "-o",
      path("in.vti"))
with open(path("in.vti"), "rb") as file:
    assert file.read() == content

# Outputs do not overwrite one another, whatever path to them is given.
here = os.path.join(path(), ".", "o.vti")
for outputs in (("-o", path("o.vti"), "-o", path("o.vti")), ("-o", path("o.vti"), "--jacobian", here),
                ("--points-output", path("o.csv"), "--points-output", path("../CommandLine/o.csv")),
                ("-o", path("o.vti"), "--write-mesh", path("o.vtu"), "--inverse-field", here)):
    fails(2, "written twice", path("in.vti"), *lattice, *push, *outputs, "--points", "a.csv", "--points", "b.csv",
          *(() if "--points-output" in outputs else ("--points-output", "a.csv", "--points-output", "b.csv")))
chain_mail = ("--model", "chainmail", "--pull", "9,20,25,1,0,0", "--frames", "12")
for image in ("m0001.png", "m0012.png"):
    fails(2, f"{image} is written twice, for --image", path("in.vti"), *chain_mail, "--movie", path("m.png"), "--image",
          path(image))
fails(1, "xvfb-run", path("in.vti"), *chain_mail, "--movie", path("m.png"), "--image", path("m0013.png"),
      environment={name: value for name, value in os.environ.items() if name != "DISPLAY"})

# The same holds for the files of the values of .mhd and .nhdr files.
if ".mhd" in written:
    fails(2, ["o.raw is written twice, for --output", "Give --jacobian"], path("in.vti"), *lattice, *push, "-o",
          path("o.mhd"), "--jacobian", path("o.nhdr"))
    call(program, path("in.vti"), *lattice, *push, "-o", path("first.mhd"), "-o", path("second.nhdr"), "-o",
         path("second.mhd"), "-q")
    os.rename(path("first.raw"), path("values.raw"))
    for name in ("named.mhd", "named.mha"):
        with open(path("first.mhd"), encoding="ascii") as file, open(path(name), "w", encoding="ascii") as named:
            named.write(file.read().replace("first.raw", "values.raw"))
    for source, output in (("second.nhdr", "second.mhd"), ("named.mhd", "values.nhdr"), ("named.mha", "values.mhd")):
        data = output.split(".", maxsplit=1)[0] + ".raw"
        before = os.stat(path(data))
        fails(2, f"{data} holds the values of the input", path(source), *lattice, *push, "--jacobian", path(output))
        assert os.stat(path(data)) == before
    call(program, path("named.mhd"), *lattice, *push, "-o", path("named.nhdr"), "-q")

# Failures.
fails(1, "no such file", path("none.nii.gz"), *lattice, *push, "-o", path("o.vti"))
with open(path("text.nii"), "w", encoding="utf-8") as file:
    file.write("no volume")
fails(1, "not a NIfTI file", path("text.nii"), *lattice, *push, "-o", path("o.vti"))
fails(1, "a volume is a", __file__, *lattice, *push, "-o", path("o.vti"))
os.makedirs(path("empty"), exist_ok=True)
fails(1, "DICOM" if "DICOM" in line else "a volume is a", path("empty"), *lattice, *push, "-o", path("o.vti"))
fails(1, "no folder", path("in.vti"), *lattice, *push, "-o", path("none/o.vti"))
os.makedirs(path("folder.nii"), exist_ok=True)
fails(1, "there is a folder of this name", path("in.vti"), *lattice, *push, "-o", path("folder.nii"))
os.mkfifo(path("pipe.vti"))
fails(1, "does not write into pipes", path("in.vti"), *lattice, *push, "-o", path("pipe.vti"))
no_display = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
fails(1, "xvfb-run", path("in.vti"), *lattice, *push, "--image", path("o.png"),
      environment=no_display)
assert not os.path.exists(path("o.vti"))
assert not os.path.exists(path("o.png"))

# Valid commands.
assert "Exit codes" in help_text, help_text
output, _ = call(program, "--version")
assert re.fullmatch(r"deform-volume \d+\.\d+\.\d+\n", output), output
output, _ = call(program, "--list-devices")
assert output.strip(), "--list-devices lists no device"

# A push moves voxels near its center by its displacement, and no voxel beyond its radius.
output, errors = call(program, *lattice, *push, "-o", path("pushed.vti"), path("in.vti"),
                      "--write-mesh", path("mesh.vtu"), "--background", "-7", "--bounds", "volume")
# Cubes of 4.5 over 24 x 31.5 x 36: 7 x 8 x 9 nodes.
for word in ("step", "Seconds for resampling", "total", "25 x 22 x 19", "504 nodes"):
    assert word in output, word
assert "\r" not in errors, "a progress bar is written although there is no terminal"
pushed = read_vti(path("pushed.vti"))
before = get_values(volume)
after = get_values(pushed, "Values")
assert pushed.GetDimensions() == volume.GetDimensions(), (pushed.GetDimensions(), volume.GetDimensions())
assert not numpy.array_equal(before, after)
mask = get_values(pushed, "vtkValidPointMask")
assert numpy.array_equal(after[mask == 0], numpy.full((mask == 0).sum(), -7))
# The nodes of the lowest layer, at z = 7, are 18 away from the push.
assert numpy.array_equal(before[0], after[0]), "voxels beyond the radius have moved"

reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(path("mesh.vtu"))
reader.Update()
mesh = reader.GetOutput()
points = vtk_to_numpy(mesh.GetPoints().GetData())
moves = vtk_to_numpy(mesh.GetPointData().GetArray("Displacement"))
distance = numpy.linalg.norm(points - (9.0, 20.0, 25.0), axis=1) / 15.0
profile = numpy.where(distance < 1, (1 - distance ** 2) ** 2, 0.0)
assert numpy.allclose(moves, profile[:, None] * (3.0, 0.0, 0.0), atol=1e-12)

# The mesh alone, for another solver.
output, errors = call(program, path("in.vti"), *lattice, "--write-mesh", path("alone.vtu"))
assert "504 nodes" in output and errors == "", (output, errors)
reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(path("alone.vtu"))
reader.Update()
alone = reader.GetOutput()
assert numpy.array_equal(vtk_to_numpy(alone.GetPoints().GetData()), points)
assert not vtk_to_numpy(alone.GetPointData().GetArray("Displacement")).any()

# The mesh that was written gives the same result, and so does the pair of rest and deformed mesh.
call(program, path("in.vti"), "--mesh", path("mesh.vtu"), "--displacement", "Displacement", "-o",
     path("again.vti"), "--background", "-7", "--bounds", "volume")
assert numpy.array_equal(after, get_values(read_vti(path("again.vti")), "Values"))
deformed = vtkUnstructuredGrid()
deformed.DeepCopy(mesh)
for node, move in enumerate(moves):
    deformed.GetPoints().SetPoint(node, *(points[node] + move))
write(vtkXMLUnstructuredGridWriter(), deformed, path("deformed.vtu"), SetDataMode=1)
call(program, path("in.vti"), "--mesh", path("deformed.vtu"), "--rest", path("mesh.vtu"), "-o",
     path("pair.vti"), "--background", "-7", "--bounds", "volume", "--quiet")
assert numpy.array_equal(after, get_values(read_vti(path("pair.vti")), "Values"))

# The deformed mesh with its displacements gives the same result, except for the rounding of differences.
call(program, path("in.vti"), "--mesh", path("deformed.vtu"), "--displacement", "Displacement",
     "--points-are-deformed", "-o", path("beside.vti"), "--background", "-7", "--bounds", "volume",
     "--quiet")
assert (after != get_values(read_vti(path("beside.vti")), "Values")).mean() < 1e-3

# A structured grid of one cell that does not move.
box = volume.GetBounds()
grid = vtkStructuredGrid()
grid.SetDimensions(2, 2, 2)
grid.SetPoints(to_points([[box[2 * axis + (corner >> axis & 1)] for axis in range(3)] for corner in range(8)]))
grid.GetPointData().AddArray(to_vtk("D", numpy.zeros((8, 3))))
write(vtkXMLStructuredGridWriter(), grid, path("grid.vts"))
call(program, path("in.vti"), "--mesh", path("grid.vts"), "--displacement", "D", "-o",
     path("still.vti"), "--quiet")
assert numpy.array_equal(get_values(volume, "Values"), get_values(read_vti(path("still.vti")), "Values"))

# With a mesh of the ball alone, voxels outside it are discarded.
output, _ = call(program, path("in.vti"), "--tetgen", "--isovalue", "400", "--edge-length", "5",
                 *push, "--quiet", "-o", path("ball.vti"), "--padding",
                 "2")
assert output == "", output
ball = read_vti(path("ball.vti"))
mask = get_values(ball, "vtkValidPointMask")
assert 0 < mask.sum() < mask.size, (mask.sum(), mask.size)
assert get_values(ball, "Values")[mask == 1].max() >= 800
# With --keep voxels outside the mesh are kept.
call(program, path("in.vti"), "--tetgen", "--isovalue", "400", "--edge-length", "5", "--push",
     "9,20,25,0.8,0,0,15", "--quiet", "-o", path("kept.vti"), "--keep", "1.5", "--bounds", "volume")
kept = read_vti(path("kept.vti"))
assert (get_values(kept, "vtkValidPointMask") == 1).all()
values = get_values(kept, "Values")
assert (values[:2] == before[:2]).all() and not (values == before).all()
for option in (("--keep", "3"), ("--outside", "extrapolate"), ("--resampler", "mesh-rasterization")):
    fails(2, " ".join(option[:1 + (option[0] != "--keep")]) + " needs a deformation", path("in.vti"), "--carve",
          "sphere:9,20,25,5", *option, "-o", path("o.vti"))
fails(2, "excludes", path("in.vti"), *lattice, *push, "--keep", "3", "--outside", "discard", "-o", path("o.vti"))

# Labels are not interpolated.
call(program, path("in.vti"), *lattice, *push, "-o", path("labels.vti"), "--labels", "--padding",
     "2")
labels = get_values(read_vti(path("labels.vti")), "Values")
assert set(numpy.unique(labels)) <= set(numpy.unique(before)) | {0}

# TetGen meshes categorical scalars as labels: all that are not 0, however they are numbered.
parts = make_ball()
ball_of_labels = get_values(parts) >= 800
vtk_to_numpy(parts.GetPointData().GetScalars())[:] = numpy.where(ball_of_labels, 1, 0).ravel()
vtk_to_numpy(parts.GetPointData().GetScalars())[ball_of_labels.ravel().argmax()] = 1000
write_vti(parts, path("parts.vti"))
for option in (("--labels",), ("--categorical", "Values")):
    output, _ = call(program, path("parts.vti"), *tetgen, *option, "-o", path("o.vti"))
    assert f"{ball_of_labels.sum()} voxels in 1 pieces, 0 voxels outside" in output, output
    os.remove(path("o.vti"))
output, _ = call(program, path("parts.vti"), *tetgen, "--categorical", "Values", "--isovalue", "1000", "-o",
                 path("o.vti"))
assert "body       1 voxels" in output, output
os.remove(path("o.vti"))

# The background is the least value of the scalars if values can be negative. Labels and other arrays have the
# background 0.
hounsfield = make_ball()
vtk_to_numpy(hounsfield.GetPointData().GetScalars())[:] -= 1000
hounsfield.GetPointData().AddArray(to_vtk("Dose", numpy.ones(hounsfield.GetNumberOfPoints())))
hounsfield.GetPointData().AddArray(to_vtk("Part", numpy.ones(hounsfield.GetNumberOfPoints(), numpy.int16)))
write_vti(hounsfield, path("ct.vti"))
least = get_values(hounsfield).min()
assert least < -900, least
for options, background in (((), least), (("--background", "24"), 24), (("--labels",), 0),
                            (("--categorical", "Values"), 0), (("--categorical", "Part"), least),
                            (("--interpolation", "nearest"), least)):
    output, _ = call(program, path("ct.vti"), *lattice, *push, "-o", path("air.vti"), "--padding", "2",
                     *options)
    air = read_vti(path("air.vti"))
    outside = get_values(air, "vtkValidPointMask") == 0
    assert outside.any() and (get_values(air, "Values")[outside] == background).all(), options
    for name in ("Dose", "Part"):
        numpy.testing.assert_array_equal(get_values(air, name)[outside], 24 if "--background" in options else 0)
        assert get_values(air, name)[~outside].min() > 0.99
    assert f"background {background}\n" in output, output
    if "nearest" in options:
        values = get_values(air, "Values")
        assert set(numpy.unique(values)) <= set(numpy.unique(get_values(hounsfield))), options
