# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume moves meshes by finite elements and by springs as the filters do, and reports wrong options.
Usage: TestModels.py PROGRAM FOLDER"""
import functools
import os
import re

import deformvolume_vtk
import Messages
import numpy
from MeshFiles import make_handles, to_vtk
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkProbeFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridReader

program, path = begin_test("Models")
volume = make_ball()
write_vti(volume, path("in.vti"))
bounds = volume.GetBounds()
middle = [0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]) for axis in range(3)]
height = bounds[4] + 2.0
pull_text = f"{middle[0]},{middle[1]},{bounds[5]},3,1,2,4"
lattice = ("--lattice", "7,7,7")
fix = ("--fix", f"below:{height}")
pull = ("--pull", pull_text)
gravity = ("--gravity", "0,0,-1")


fails = functools.partial(Messages.refuses, program, path)

# Misuse.
fails(2, "Give --tetgen or --lattice", "--model", "fem", *fix, *pull)
fails(2, "Use --pull", "--model", "fem", *lattice, *fix, "--push", "1,2,3,4,5,6,7")
fails(2, "expected box:", "--model", "fem", *lattice, "--fix", "above:3")
fails(2, "three numbers", "--model", "fem", *lattice, *fix, "--gravity", "1,2")
fails(2, "--young", "--model", "fem", *lattice, *fix, "--young", "nan")
fails(1, "No constraints", "--model", "fem", *lattice, "--gravity", "0,0,-9.81")
fails(2, "needs a --pull or --gravity", "--model", "fem", *lattice, *fix)
fails(2, "--fix requires", "--model", "chainmail", *fix, *pull)
for option, value in (("--gravity", "0,0,1"), ("--young", "5"), ("--poisson", "0.2"), ("--density", "900")):
    fails(2, option + " requires --model fem", "--model", "chainmail", "--pull", "9,20,25,3,0,0,15", option, value)
fails(2, "--duration requires --model mass-spring", "--model", "fem", *lattice, *fix, "--duration", "2")
for duration in ("0", "-1"):
    fails(2, "--duration must be greater than 0", "--model", "mass-spring", *lattice, *fix, *gravity, "--duration",
          duration)
fails(2, "--young requires --model", *lattice, "--push", "9,20,25,3,0,0,15", "--young", "5")
for text in ("5=1", "1:2", "1:2=", "1:2=3,", "1:2=3,0.3,1,4", "2:1=3", "a:2=3"):
    fails(2, f"--material {text}" if text[0] in "25" else "--material", "--model", "fem", *lattice, *fix,
          "--material", text)
for text in ("0:10=100,,5", "0:10=100,a"):
    fails(2, f"--material {text}: expected", "--model", "fem", *lattice, *fix, "--material", text)
for text in ("box:1,2", "below:x", "label:"):
    fails(2, f"--fix {text.removesuffix(':')}: expected", "--model", "fem", *lattice, "--fix", text)
for text in ("kidney", "Liver", "1:2=kidney", "1:2=liver,0.3"):
    fails(2, "brain, liver, fat, muscle, skin, cartilage, bone", "--model", "fem", *lattice, *fix, "--material", text)
fails(2, "--material liver and --young set the same property", "--model", "fem", *lattice, *fix, "--material", "liver",
      "--young", "5000")
fails(2, "--material fat: --material liver already sets the tissue of the body", "--model", "fem", *lattice, *fix,
      "--material", "liver", "--material", "fat")
fails(2, "--material label:x", "--model", "fem", *lattice, *fix, "--material", "label:x=bone")
fails(2, "--material requires --model", *lattice, "--push", "9,20,25,3,0,0,15", "--material", "liver")
fails(1, "Young modulus of material 0", "--model", "fem", *lattice, *fix, *gravity, "--material", "0:9=-1")
fails(2, "--material requires", "--model", "chainmail", *pull, "--material", "0:9=1")
fails(2, "--smooth-cut cannot be used with --model fem", "--model", "fem", *lattice, *fix, "--cut", "x.vtp",
      "--smooth-cut")
fails(2, "--keep cannot be used with --model fem", "--model", "fem", *lattice, *fix, "--cut", "x.vtp", "--keep", "3")
fails(2, "--open-splits requires --mesh", "--model", "fem", *lattice, *fix, *pull, "--open-splits")
fails(2, "excludes", "--mesh", "x.vtu", "--displacement", "D", "--open-splits", "--keep", "3")
fails(2, "--movie requires --frames", "--model", "fem", *lattice, *fix, "--movie", "x.png")
fails(2, "--frames requires --movie", "--model", "fem", *lattice, *fix, "--frames", "3")
fails(2, "must end in .png", "--model", "fem", *lattice, *fix, "--movie", "x.mp4", "--frames", "3")
fails(2, "--frames", "--model", "fem", *lattice, *fix, "--movie", "x.png", "--frames", "0")
fails(2, "--movie requires --model", *lattice, "--push", "9,20,25,3,0,0,15", "--movie", "x.png",
      "--frames", "3")
fails(1, "there is no folder", "--model", "fem", *lattice, *fix, *gravity, "--movie",
      path("none/x.png"), "--frames", "3")
fails(2, "needs the cubes of --lattice", "--model", "mass-spring", "--tetgen", *fix)
fails(2, "--write-mesh requires --tetgen or --lattice", "--model", "chainmail", *pull, "--write-mesh", path("m.vtu"))

# The expected results, made by the filters.
source = deformvolume_vtk.vtkLatticeTetrahedraSource()
source.SetInputData(volume)
source.SetNumberOfNodes(7, 7, 7)
source.Update()
mesh = vtkUnstructuredGrid()
mesh.DeepCopy(source.GetOutput())
heights = vtk_to_numpy(mesh.GetPoints().GetData())[:, 2]
mesh.GetPointData().AddArray(to_vtk("Fixed", (heights <= height).astype(numpy.uint8)))
handles, radius = make_handles(pull_text)


def check(name, model, words, *arguments):
    model.SetInputData(mesh)
    model.SetHandlesData(handles)
    model.SetHandleRadius(radius)
    model.SetLengthUnitToMillimetre()
    model.SetYoungModulus(5000)
    model.SetPoissonRatio(0.4)
    model.SetGravity(0, 0, -2)
    if name == "fem":
        model.SetModeToConverged()
        model.Update()
    else:
        # Handles move during the first half.
        model.SetEndTime(0.1)
        model.SetFrameTime(0.1)
        for time in (0.05, 0.099, 0.1):
            model.UpdateTimeStep(time)
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(volume)
    deform.SetDeformationData(model.GetOutput())
    deform.Update()
    output, _ = call(program, path("in.vti"), "--model", name, *lattice, *fix, *pull, "--gravity",
                     "0,0,-2", "--young", "5000", "--poisson", "0.4", *arguments, "-o",
                     path(f"{name}.vti"), "--write-mesh", path(f"{name}.vtu"))
    assert words in output, output
    numpy.testing.assert_array_equal(get_values(read_vti(path(f"{name}.vti"))),
                                     get_values(deform.GetOutput()))
    assert os.path.exists(path(f"{name}.vtu"))


def check_tissues():
    """Checks that the name of a tissue gives the same result as its numbers, for the body and for a range of values."""
    low, high = volume.GetPointData().GetScalars().GetRange()
    limit = 0.5 * (low + high)

    def deformed(name, *arguments):
        call(program, path("in.vti"), "--model", "fem", *lattice, *fix, *pull, "--gravity", "0,0,-2", *arguments,
             "-o", path(name))
        return get_values(read_vti(path(name)))

    numbers_of_body = ("--young", "5500", "--poisson", "0.49", "--density", "1060")
    by_numbers = deformed("numbers.vti", *numbers_of_body)
    assert (by_numbers != deformed("soft.vti")).any()
    numpy.testing.assert_array_equal(deformed("liver.vti", "--material", "liver"), by_numbers)
    both = deformed("both.vti", "--material", "liver", "--material", f"{limit}:1e9=muscle")
    assert (both != by_numbers).any()
    numpy.testing.assert_array_equal(
        both, deformed("ranges.vti", *numbers_of_body, "--material", f"{limit}:1e9=11100,0.49,1050"))


def check_materials_and_cut():
    """Checks a mesh with a stiffer upper half that a plane cuts."""
    plane = vtkPlaneSource()
    plane.SetOrigin(middle[0] + 0.3, bounds[2] - 9, middle[2])
    plane.SetPoint1(middle[0] + 0.3, bounds[3] + 9, middle[2])
    plane.SetPoint2(middle[0] + 0.3, bounds[2] - 9, bounds[5] + 9)
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToBinary()
    writer.SetInputConnection(plane.GetOutputPort())
    writer.SetFileName(path("sheet.vtp"))
    writer.Write()
    low, high = volume.GetPointData().GetScalars().GetRange()
    limit = 0.5 * (low + high)
    materials = deformvolume_vtk.vtkMaterialFromVolume()
    materials.SetInputData(mesh)
    materials.SetVolumeData(volume)
    materials.SetMaterial(0, 2e4, 0.2, 900)
    materials.SetMaterial(1, 5000, 0.4, 1000)
    materials.AddMaterialRange(limit, 1e9, 0)
    model = deformvolume_vtk.vtkFiniteElementDeformation()
    model.SetInputConnection(materials.GetOutputPort())
    model.SetModeToConverged()
    model.SetHandlesData(handles)
    model.SetHandleRadius(radius)
    model.SetLengthUnitToMillimetre()
    model.SetSheetConnection(plane.GetOutputPort())
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(volume)
    deform.SetDeformationConnection(model.GetOutputPort())
    deform.OpenSplitsOn()
    deform.Update()
    output, _ = call(program, path("in.vti"), "--model", "fem", *lattice, *fix, *pull, "--young",
                     "5000", "--poisson", "0.4", "--material", f"{limit}:1e9=2e4,0.2,900", "--cut",
                     path("sheet.vtp"), "-o", path("cut.vti"), "--write-mesh", path("cut.vtu"))
    assert f"{model.GetNumberOfSplitFaces()} faces of tetrahedra of the mesh split" in output, output
    assert model.GetNumberOfSplitFaces() > 20, model.GetNumberOfSplitFaces()
    expected = get_values(deform.GetOutput())
    numpy.testing.assert_array_equal(get_values(read_vti(path("cut.vti"))), expected)

    # The nodes of split faces have copies.
    positions, counts = numpy.unique(vtk_to_numpy(model.GetOutput().GetPoints().GetData()), axis=0,
                                     return_counts=True)
    distance = numpy.abs(positions[counts > 1][:, 0] - middle[0] - 0.3).max()
    assert distance > 0.1, distance
    found = re.search(r"split, at most (\S+) mm from the sheet", output)
    assert found and abs(float(found.group(1)) - distance) <= 5e-3 * distance, (output, distance)  # three digits

    # The mesh that was written is split, too.
    arguments = ("--mesh", path("cut.vtu"), "--displacement", "Displacement", "-o", path("again.vti"))
    call(program, path("in.vti"), *arguments, "--open-splits")
    numpy.testing.assert_array_equal(get_values(read_vti(path("again.vti"))), expected)
    Messages.warns(program, "--open-splits", path("in.vti"), *arguments)
    again = get_values(read_vti(path("again.vti")))
    assert again.shape != expected.shape or (again != expected).any()


def make_bar():
    """Writes a bar of three labels in air: an image of the labels, one of a hundred times the labels, and one of 100.
    Returns its voxels as an array [z, y, x]."""
    labels = numpy.zeros((48, 24, 24), numpy.int16)
    for label, (first, last) in {3: (4, 20), 2: (20, 28), 1: (28, 44)}.items():
        labels[first:last, 6:18, 6:18] = label
    for name, values in (("labels.vti", labels), ("hundreds.vti", 100 * labels), ("bar.vti", 100 * (labels > 0))):
        image = vtkImageData()
        image.SetDimensions(24, 24, 48)
        image.GetPointData().SetScalars(to_vtk("Values", values.astype(numpy.int16).ravel()))
        write_vti(image, path(name))
    return labels


def read_vtu(name):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path(name))
    reader.Update()
    return reader.GetOutput()


def get_corners(mesh):
    """Returns the nodes at the corners of each tetrahedron with ten nodes."""
    return vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 10)[:, :4]


def check_size_of_body():
    """Checks that the mesh of a body that is simulated is hardly larger than the body."""
    make_bar()
    body = 12 * 12 * 40
    arguments = (path("bar.vti"), "--tetgen", "--model", "fem", "--fix", "below:6", "--gravity", "1,0,0", "-o",
                 path("o.vti"), "--write-mesh", path("bar.vtu"))
    output, errors = call(program, *arguments, "--edge-length", "5")
    simulated = read_vtu("bar.vtu")
    points = vtk_to_numpy(simulated.GetPoints().GetData())[get_corners(simulated)]
    volume_of_mesh = numpy.abs(numpy.linalg.det(points[:, 1:] - points[:, :1])).sum() / 6
    found = re.search(r"; mesh (\S+) ml, body (\S+) ml", output)
    assert found and float(found.group(2)) == body / 1000, output
    assert abs(float(found.group(1)) * 1000 - volume_of_mesh) < 1e-3 * volume_of_mesh, (output, volume_of_mesh)
    # A tenth of an edge and half a voxel on each side.
    assert 0.9 * body < volume_of_mesh < 14 * 14 * 42 and errors == "", (volume_of_mesh, errors)
    # Voxels outside the body do not count, although they are in tetrahedra.
    call(program, *arguments, "--edge-length", "5", "--material", "50:1000=500,0.4")
    moduli = vtk_to_numpy(read_vtu("bar.vtu").GetCellData().GetArray("YoungModulus"))
    assert (moduli == 500).all(), moduli
    coarse = (*arguments, "--edge-length", "12")
    Messages.warns(program, "times the volume of the body", *coarse)
    _, errors = call(program, *coarse, "--material", "-1:50=100,0.3,1")
    assert errors == "", errors


def check_fixed_labels():
    """Checks that labels hold their tissue, and that they come from --label-volume if there is one."""
    labels = make_bar()
    top = ("--pull", "11.5,11.5,43,4,0,0,5")
    arguments = ("--tetgen", "--isovalue", "50", "--edge-length", "3.5", "--model", "fem", *top)
    values = ("--fix", "label:300", "--material", "150:250=2000")
    output, errors = call(program, path("hundreds.vti"), *arguments, *values, "-o", path("values.vti"),
                          "--write-mesh", path("held.vtu"))
    assert errors == "", errors
    held = read_vtu("held.vtu")
    found = re.search(r"fixed +(\d+) of (\d+) nodes", output)
    corners = numpy.unique(get_corners(held))
    fixed = vtk_to_numpy(held.GetPointData().GetArray("Fixed"))[corners] != 0
    assert found and [int(text) for text in found.groups()] == [fixed.sum(), len(corners)], (output, fixed.sum())
    # Voxels in tetrahedra whose nodes are all fixed do not move. Without a warning these are at least 80 %.
    places = vtkPoints()
    places.SetData(to_vtk("", numpy.argwhere(labels == 3)[:, ::-1].astype(float)))
    tissue = vtkPolyData()
    tissue.SetPoints(places)
    probe = vtkProbeFilter()
    probe.SetInputData(tissue)
    probe.SetSourceData(held)
    probe.Update()
    moves = numpy.linalg.norm(vtk_to_numpy(probe.GetOutput().GetPointData().GetArray("Displacement")), axis=1)
    assert (moves > 1e-6).mean() < 0.2, (moves > 1e-6).mean()
    # A fixed node beyond the label is in a tetrahedron with it, whose edges are less than twice as long as the target.
    heights = numpy.array([held.GetPoint(node)[2] for node in corners])
    assert not fixed[heights > 20 + 7].any()

    # The same labels in a file of their own.
    beside = (path("bar.vti"), "--label-volume", path("labels.vti"), *arguments)
    call(program, *beside, "--fix", "label:3", "--material", "label:2=2000", "-o", path("o.vti"), "--write-mesh",
         path("beside.vtu"))
    for name in ("Fixed", "Displacement"):
        numpy.testing.assert_array_equal(*(vtk_to_numpy(mesh.GetPointData().GetArray(name))
                                           for mesh in (held, read_vtu("beside.vtu"))))
    fails_beside = functools.partial(Messages.fails, program, 1)
    output = ("-o", path("none.vti"))
    fails_beside("label:7: no voxel of --label-volume has this value. Values are 0 to 3", *beside, "--fix", "label:7",
                 *output)
    fails_beside("label:3: no voxel of the volume has this value. Values are 0 to 100", path("bar.vti"), *arguments,
                 "--fix", "label:3", *output)
    Messages.warns(program, "No voxel has the label 9 of --material. Labels are 0 to 3", *beside, "--fix", "label:3",
                   "--material", "label:9=bone", *output)
    Messages.warns(program, "% of the tissue with the labels of --fix is in tetrahedra with nodes that are not fixed",
                   path("hundreds.vti"), "--lattice", "3,3,5", "--model", "fem", *top, "--fix", "below:1", "--fix",
                   "label:200", *output)


def check_rounded_positions():
    """Checks that --fix includes nodes whose positions are rounded to floats, as those of NIfTI files are."""
    image = make_ball(spacing=[float(numpy.float32(1.2))] * 3, origin=(0, 0, 0))
    write_vti(image, path("rounded.vti"))
    assert image.GetSpacing()[2] * 3 > 3.6
    # Two layers of a lattice with the spacing 3.6.
    for kind in ("below:3.6", "box:-1,99,-1,99,0,3.6"):
        output, _ = call(program, path("rounded.vti"), "--model", "fem", "--lattice", "9,8,7", "--fix", kind, *gravity,
                         "-o", path("o.vti"))
        assert "fixed      144 of 504 nodes" in output, output


def check_results_without_use():
    """Checks simulations without an equilibrium, without motion, and with materials that no voxel has."""
    arguments = (path("in.vti"), "--model", "fem", *lattice, "--gravity", "0,0,-9.81", "-o", path("useless.vti"))
    Messages.fails(program, 1, "no equilibrium was found", *arguments, *fix, "--young", "100", "--write-mesh",
                   path("useless.vtu"), warnings=2)
    assert not os.path.exists(path("useless.vti")) and not os.path.exists(path("useless.vtu"))
    Messages.warns(program, "fixes all nodes", *arguments, "--fix", "below:1000")
    far = ("--fix", "below:10", "--pull", f"{middle[0]},{middle[1]},{bounds[5] + 20},0,0,1")
    Messages.warns(program, "is 20 mm outside the mesh, and moves the nearest node", *arguments, *far)
    Messages.warns(program, "Nothing holds the body", path("in.vti"), "--model", "fem", *lattice, *pull, "-o",
                   path("loose.vti"))
    Messages.warns(program, ["springs still move by up to", "mm/s"], path("in.vti"), "--model", "mass-spring",
                   *lattice, *fix, "--gravity", "0,0,-1", "--duration", "0.1", "-o", path("moving.vti"))
    Messages.warns(program, ["3000:4000 of --material", "0 to 849"], *arguments, *fix, "--material",
                   "0:700=liver", "--material", "3000:4000=bone")


check_materials_and_cut()
check_size_of_body()
check_fixed_labels()
check_rounded_positions()
check_results_without_use()
check_tissues()
check("fem", deformvolume_vtk.vtkFiniteElementDeformation(), "to equilibrium, strain energy")
check("mass-spring", deformvolume_vtk.vtkMassSpringDeformation(), "0.1 s, in steps of", "--duration",
      "0.1")
