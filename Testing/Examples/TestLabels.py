# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume deforms labels with their volume, as vtkDeformVolumeFilter deforms categorical arrays.
Usage: TestLabels.py PROGRAM FOLDER"""
import gzip
import os
import struct

import numpy
from deformvolume_vtk import vtkDeformVolumeFilter
from MeshFiles import make_moves, make_places, make_unstructured, to_vtk, write
from Messages import fails, warns
from Rotation import turn
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkNIFTIImageReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti

program, path = begin_test("Labels")
TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
volume = make_ball(direction=turn(2, 30).ravel())
air = vtk_to_numpy(volume.GetPointData().GetScalars())
air -= 1000
write_vti(volume, path("in.vti"))
number = volume.GetNumberOfPoints()
random = numpy.random.default_rng(3)


def make_labels(**arrays):
    """Returns an image with these arrays on the grid of the volume."""
    image = vtkImageData()
    image.CopyStructure(volume)
    for name, values in arrays.items():
        image.GetPointData().AddArray(to_vtk(name, values))
    if arrays:
        image.GetPointData().SetActiveScalars(list(arrays)[-1])
    return image


def make_values(kind):
    """Returns random whole numbers of all sizes that a type can represent, few of them 0."""
    if kind.startswith("float"):
        return random.integers(-2 ** 20, 2 ** 20, number).astype(kind)
    limits = numpy.iinfo(kind)
    return random.integers(limits.min, limits.max, number, dtype=kind, endpoint=True)


all_types = {kind: make_values(kind) for kind in TYPES}
write_vti(make_labels(**all_types), path("all.vti"))
one = make_labels(parts=all_types["int16"])
write_vti(one, path("one.vti"))
_, places = make_places(volume.GetBounds())
mesh = make_unstructured(places, make_moves(places))
write(vtkXMLUnstructuredGridWriter(), mesh, path("mesh.vtu"), SetDataMode=1)
by_mesh = ("--mesh", path("mesh.vtu"), "--displacement", "Displacement")


def refuses(code, expected, labels, *arguments, output="o.vti", deformation=by_mesh):
    fails(program, code, expected, path("in.vti"), *deformation, "--label-volume", path(labels),
          "--label-output", path(output), *arguments)
    assert not os.path.exists(path(output))


# Misuse.
volume_output = ("-o", path("v.vti"))
fails(program, 2, "--label-volume requires --label-output", path("in.vti"), *by_mesh, *volume_output,
      "--label-volume", path("one.vti"))
fails(program, 2, "--label-output requires --label-volume", path("in.vti"), *by_mesh, *volume_output,
      "--label-output", path("o.vti"))
refuses(2, ["--label-output", "must end in .vti"], "one.vti", output="o.png")
fails(program, 2, "overwritten", path("in.vti"), *by_mesh, "--label-volume", path("one.vti"),
      "--label-output", path("one.vti"))

# Labels on other grids: the error states how the grids differ.
for change, expected in (
        (lambda image: image.SetDimensions(25, 22, 18), "18 voxels on axis z, and the volume has 19"),
        (lambda image: image.SetDimensions(24, 22, 19), "24 voxels on axis x, and the volume has 25"),
        (lambda image: image.SetSpacing(1, 1.51, 2),
         "The position of a corner is "),
        (lambda image: image.SetOrigin(-3, 5.5, 7),
         "The position of a corner is -3, 5.5, 7, and in the volume -3, 5, 7."),
        (lambda image: image.SetDirectionMatrix(turn(2, 31).ravel()), "The position of a corner is "),
        (lambda image: image.SetDirectionMatrix((1, 0, 0, 0, 1, 0, 0, 0, 1)), "The position of a corner is "),
        (lambda image: image.SetExtent(1, 25, 0, 21, 0, 18), "The position of a corner is ")):
    other = vtkImageData()
    other.CopyStructure(volume)
    change(other)
    other.GetPointData().AddArray(to_vtk("parts", numpy.zeros(other.GetNumberOfPoints(), "uint8")))
    write_vti(other, path("other.vti"))
    refuses(1, ["not on the grid of the volume", expected], "other.vti")

# Arrays that are not labels.
write_vti(make_labels(), path("none_inside.vti"))
refuses(1, "its voxels have no numeric array", "none_inside.vti")
for kind, bad in (("float32", 0.5), ("float64", 1e-3), ("float64", numpy.nan), ("float32", numpy.inf)):
    fractions = all_types[kind].copy()
    fractions[number // 2] = bad
    write_vti(make_labels(good=all_types["uint8"], bad=fractions), path("fractions.vti"))
    refuses(1, ['array "bad" holds', "labels are integers"], "fractions.vti")
write_vti(make_labels(parts=all_types["int16"], more=all_types["uint8"]), path("two.vti"))
refuses(1, ["one array", "parts, more", "Write .vti"], "two.vti", output="o.nii.gz")


def make_filter(arrays, **settings):
    """Returns a filter that deforms the labels as categorical arrays of the volume."""
    image = vtkImageData()
    image.ShallowCopy(volume)
    subject = vtkDeformVolumeFilter()
    for name, values in arrays.items():
        image.GetPointData().AddArray(to_vtk(name, values))
        subject.AddCategoricalArray(name)
    subject.SetInputData(image)
    subject.SetDeformationData(mesh)
    subject.SetInputArrayToProcess(0, 1, 0, 0, "Displacement")
    for name, value in settings.items():
        getattr(subject, name)(value)
    subject.Update()
    return subject.GetOutput()


def same_grid(image, other):
    assert image.GetExtent() == other.GetExtent(), (image.GetExtent(), other.GetExtent())
    for index in ((0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)):
        places = [[0.0] * 3, [0.0] * 3]
        for each, place in zip((image, other), places):
            each.TransformIndexToPhysicalPoint(index, place)
        assert numpy.allclose(*places, atol=1e-5), places


def check(expected, arrays, name="labels.vti"):
    """Checks that labels equal those of a filter bit for bit, and are 0 in voxels that are not covered."""
    image = read_vti(path(name))
    same_grid(image, expected)
    data = image.GetPointData()
    names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
    assert names == list(arrays), names
    covered = get_values(expected, "vtkValidPointMask") != 0
    for array in arrays:
        values, wanted = get_values(image, array), get_values(expected, array)
        assert values.dtype == wanted.dtype == arrays[array].dtype, (array, values.dtype)
        assert numpy.array_equal(values, numpy.where(covered, wanted, wanted.dtype.type(0))), array
    assert covered.sum() > 3000 and not covered.all()


def deform(*arguments, labels="all.vti", output="labels.vti", source="in.vti"):
    call(program, path(source), *arguments, "--label-volume", path(labels), "--label-output",
         path(output), "--quiet")


# Labels of all types together. The deformed volume is the same as without labels.
deform(*by_mesh, "--padding", "1", "-o", path("v.vti"))
check(make_filter(all_types, SetPadding=1), all_types)
assert read_vti(path("labels.vti")).GetPointData().GetScalars().GetName() == "float64"
call(program, path("in.vti"), *by_mesh, "--padding", "1", "-o", path("alone.vti"), "--quiet")
with_labels, alone = read_vti(path("v.vti")), read_vti(path("alone.vti"))
assert [with_labels.GetPointData().GetArrayName(i) for i in range(
    with_labels.GetPointData().GetNumberOfArrays())] == ["Values", "vtkValidPointMask"]
assert numpy.array_equal(get_values(with_labels), get_values(alone))
assert get_values(alone).min() <= -1000 and with_labels.GetExtent() == alone.GetExtent()

# Other deformations, cubic interpolation, and a reference grid.
deform(*by_mesh, "--interpolation", "cubic", "--resampler", "mesh-rasterization")
check(make_filter(all_types, SetInterpolation=vtkDeformVolumeFilter.CUBIC_INTERPOLATION,
                  SetResampler=vtkDeformVolumeFilter.MESH_RASTERIZATION), all_types)
reference = make_ball(dimensions=(31, 27, 25), spacing=(0.9, 1.4, 1.9), origin=(-4.0, 3.0, 5.0),
                      direction=(turn(0, 20) @ numpy.diag((1, 1, -1))).ravel())
reference.SetOrigin(reference.GetOrigin()[0], 18.0, 45.0)
write_vti(reference, path("reference.vti"))
deform(*by_mesh, "--reference", path("reference.vti"))
check(make_filter(all_types, SetReferenceData=reference), all_types)

# Grids that differ by less than the tolerance are equal.
near = make_labels(parts=all_types["int16"])
near.SetSpacing(1.0001, 1.5, 2.0)
near.SetOrigin(-3.0, 5.004, 7.0)
write_vti(near, path("near.vti"))
deform(*by_mesh, labels="near.vti")
check(make_filter({"parts": all_types["int16"]}), {"parts": all_types["int16"]})

# Voxels that are carved out have no label.
carving = ("--carve", "sphere:0,25,25,6")
deform(*by_mesh, *carving, "-o", path("carved.vti"), labels="one.vti")
left = get_values(read_vti(path("carved.vti")), "vtkValidPointMask") != 0
assert not get_values(read_vti(path("labels.vti")), "parts")[~left].any()
deform(*by_mesh, labels="one.vti")
assert get_values(read_vti(path("labels.vti")), "parts")[~left].any()

# Files with one array, in the world that a registration program uses. VTK's reader of NIfTI files
# reads voxels in the order in which they are stored.
still = ("--lattice", "3,3,3", "--push", "0,0,0,1e-7,0,0,1e6", "--bounds", "volume", "--quiet")
call(program, path("in.vti"), *still, "-o", path("in.nii.gz"))
for kind in ("uint8", "int16"):
    write_vti(make_labels(parts=all_types[kind]), path("kind.vti"))
    call(program, path("kind.vti"), *still, "-o", path("kind.nii.gz"), "--labels")
    deform("--lattice", "9,9,9", "--push", "9,20,25,3,0,0,15", "-o", path("v.nii.gz"), source="in.nii.gz",
           labels="kind.nii.gz", output="kind_deformed.nii.gz")
    deform("--lattice", "9,9,9", "--push", "9,20,25,3,0,0,15", source="in.vti", labels="kind.vti")
    reader = vtkNIFTIImageReader()
    reader.SetFileName(path("kind_deformed.nii.gz"))
    reader.Update()
    stored, wanted = get_values(reader.GetOutput()), get_values(read_vti(path("labels.vti")))
    assert stored.dtype == wanted.dtype and numpy.array_equal(stored, wanted), kind
    with gzip.open(path("kind_deformed.nii.gz")) as file, gzip.open(path("v.nii.gz")) as beside:
        # Codes, forms and spacing are those of the deformed volume.
        first, second = file.read(352), beside.read(352)
        assert first[76:108] == second[76:108] and first[252:328] == second[252:328], kind

# A file of labels with several frames.
with gzip.open(path("kind.nii.gz")) as file:
    content = bytearray(file.read())
content[40:50] = struct.pack("<5h", 4, *volume.GetDimensions(), 2)
with gzip.open(path("times.nii.gz"), "wb") as file:
    file.write(bytes(content) + bytes(content[352:]))
fails(program, 1, ["2 frames in time", "a file of its own"], path("in.nii.gz"), *still, "--label-volume",
      path("times.nii.gz"), "--label-output", path("o.nii.gz"))

# Labels in a file of the other world, which only a program with ITK reads.
text, _ = call(program, "--help", quiet=True)
if ".mha" in text.splitlines()[5]:
    call(program, path("one.vti"), "--volume-space", "ras", *still, "-o", path("one.mha"), "--labels")
    deform("--lattice", "9,9,9", "--push", "9,20,25,3,0,0,15", source="in.nii.gz", labels="one.mha",
           output="one.nrrd")
    deform("--lattice", "9,9,9", "--push", "9,20,25,3,0,0,15", labels="one.vti")
    call(program, path("one.nrrd"), *still, "-o", path("again.vti"))
    assert numpy.array_equal(get_values(read_vti(path("again.vti"))),
                             get_values(read_vti(path("labels.vti")), "parts"))

# An array of strings is left out, with a warning.
names = vtkStringArray()
names.SetName("names")
names.SetNumberOfValues(number)
words = make_labels(parts=all_types["int16"])
words.GetPointData().AddArray(names)
write_vti(words, path("words.vti"))
warns(program, ['"names"', "left out"], path("in.vti"), *by_mesh, "--label-volume", path("words.vti"),
      "--label-output", path("labels.vti"))
check(make_filter({"parts": all_types["int16"]}), {"parts": all_types["int16"]})
