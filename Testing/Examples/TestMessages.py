# SPDX-License-Identifier: BSD-3-Clause
"""Tests that messages of deform-volume about wrong files and numbers use only words that its users know.
Usage: TestMessages.py PROGRAM FOLDER"""
import functools
import os

import Messages
import numpy
from MeshFiles import (
    make_blocks,
    make_hexahedra,
    make_moves,
    make_places,
    make_tetrahedra,
    make_unstructured,
    to_points,
    to_vtk,
    write,
)
from Volumes import begin_test, call, make_ball, read_vti, write_vti
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import (
    VTK_BEZIER_TETRAHEDRON,
    VTK_CONVEX_POINT_SET,
    VTK_QUAD,
    VTK_QUADRATIC_TETRA,
    VTK_TETRA,
    VTK_TRIANGLE,
    vtkImageData,
    vtkPolyData,
)
from vtkmodules.vtkIOXML import (
    vtkXMLMultiBlockDataWriter,
    vtkXMLPolyDataWriter,
    vtkXMLUnstructuredGridWriter,
)

program, path = begin_test("Messages")
XML = {"SetDataMode": 1}
fails = functools.partial(Messages.refuses, program, path)


def warns(expected, *arguments, source="in.vti"):
    Messages.warns(program, expected, path(source), *arguments, "-o", path("o.vti"))
    os.remove(path("o.vti"))


volume = make_ball()
write_vti(volume, path("in.vti"))
_, places = make_places(volume.GetBounds())
moves = make_moves(places)
lattice = ("--lattice", "7,7,7")
push = ("--push", "9,20,25,3,0,0,15")


def write_mesh(name, grid):
    write(vtkXMLUnstructuredGridWriter(), grid, path(name), **XML)
    return "--mesh", path(name), "--displacement", "Displacement"


def make_field(*names):
    field = vtkImageData()
    field.SetDimensions(3, 3, 3)
    field.SetOrigin(-4, 4, 6)
    field.SetSpacing(13, 17, 19)
    for name in names:
        field.GetPointData().AddArray(to_vtk(name, numpy.ones((27, 3))))
    return field


def make_cells(kind, size, count=1):
    """Returns a mesh of tetrahedra with additional cells of another type."""
    grid = make_unstructured(places, moves)
    for cell in range(count):
        grid.InsertNextCell(kind, size, list(range(cell, cell + size)))
    return grid


mesh = write_mesh("mesh.vtu", make_unstructured(places, moves))
write_vti(make_field("U"), path("field.vti"))
field = ("--field", path("field.vti"), "--displacement", "U")
sheet = vtkPolyData()
sheet.SetPoints(to_points(numpy.array([(9.25, 0, 0), (9.25, 90, 0), (9.25, 0, 90)], float)))
sheet.Allocate(1)
sheet.InsertNextCell(VTK_TRIANGLE, 3, [0, 1, 2])
write(vtkXMLPolyDataWriter(), sheet, path("sheet.vtp"), **XML)
cut = ("--cut", path("sheet.vtp"))
chain_mail = ("--model", "chainmail", "--pull", "8,20,25,-3,1,1,3")


def check_resamplers():
    """Checks errors about options that a resampler does not support."""
    rasterization = ("--resampler", "mesh-rasterization")
    exact = ("--resampler", "exact")
    for arguments in (field, chain_mail):
        fails(2, ["--resampler mesh-rasterization", "forward field"], *arguments, *rasterization)
    fails(1, ["--resampler mesh-rasterization", "forward field"], "--mesh", path("field.vti"),
          "--displacement", "U", *rasterization)
    for arguments in (mesh, (*lattice, *push)):
        fails(2, "--outside extrapolate", *arguments, *rasterization, "--outside", "extrapolate")
        fails(2, "--smooth-cut", *arguments, *rasterization, *cut, "--smooth-cut")
        for option, value in (("--keep", "3"), ("--jacobian", path("j.vti")), ("--fold-count", path("f.vti")),
                              ("--density-array", "Values")):
            fails(2, f"--resampler mesh-rasterization cannot be used with {option}", *arguments, *rasterization,
                  option, value)
    inverse = (*field, "--field-is-inverse")
    fails(2, "inverse", *inverse, *exact)
    fails(2, "inverse", *inverse, *cut, "--smooth-cut")


def check_volumes():
    for name, change, expected in (
            ("slice.vti", lambda image: image.SetDimensions(22, 19, 1), "22 x 19 x 1 voxels"),
            ("none.vti", lambda image: None, "no numeric array")):
        image = vtkImageData()
        image.SetDimensions(25, 22, 19)
        change(image)
        if name == "slice.vti":
            image.GetPointData().SetScalars(to_vtk("Values", numpy.zeros(22 * 19)))
        write_vti(image, path(name))
        fails(1, [path(name), expected], *lattice, *push, source=name)
    for name in ("grid.vtr", "grid.vts", "mesh.vtu"):
        with open(path(name), "ab"):
            pass
        fails(1, [path(name), "a volume is a", "Resample To Image"], *mesh, source=name)
    # Without active scalars the first array is used.
    image = make_ball()
    image.GetPointData().SetActiveScalars(None)
    write_vti(image, path("inactive.vti"))
    call(program, path("inactive.vti"), "--tetgen", "--edge-length", "9", *push, "-o",
         path("inactive-out.vti"))
    fails(1, ["no such array", "Values"], *mesh, "--categorical", "Labels")
    # Names of arrays are checked before the mesh is read.
    words = vtkStringArray()
    words.SetName("Words")
    words.SetNumberOfValues(image.GetNumberOfPoints())
    image.GetPointData().AddArray(words)
    image.GetPointData().AddArray(to_vtk("Jacobian", numpy.zeros(image.GetNumberOfPoints())))
    write_vti(image, path("words.vti"))
    missing = ("--mesh", path("none.vtu"), "--displacement", "U")
    for option, name, expected in (("--density-array", "Words", "It has Values, Jacobian"),
                                   ("--categorical", "Words", "no such array of numbers"),
                                   ("--density-array", "Values", 'has a point array "Jacobian"'),
                                   ("--jacobian", path("j.vti"), 'has a point array "Jacobian"')):
        fails(1, [option, expected], *missing, option, name, source="words.vti")
    # Masks are not the values, also if they are the first array or the scalars.
    for mask, kind in (("vtkGhostType", numpy.uint8), ("vtkValidPointMask", numpy.int8),
                       ("BoundaryDistance", numpy.float32)):
        for is_active in (False, True):
            image = vtkImageData()
            image.CopyStructure(volume)
            ones = numpy.full(volume.GetNumberOfPoints(), mask != "vtkGhostType", kind)
            image.GetPointData().AddArray(to_vtk(mask, ones))
            image.GetPointData().AddArray(volume.GetPointData().GetScalars())
            image.GetPointData().SetActiveScalars(mask if is_active else None)
            write_vti(image, path("masked.vti"))
            call(program, path("masked.vti"), *lattice, *push, "-q", "-o", path("masked.mha"))
            call(program, path("masked.mha"), *lattice, *push, "-q", "-o", path("masked-out.vti"))
            assert read_vti(path("masked-out.vti")).GetPointData().GetScalars().GetRange()[1] > 800
        image.GetPointData().RemoveArray("Values")
        write_vti(image, path("only-mask.vti"))
        fails(1, "no numeric array", *lattice, *push, source="only-mask.vti")


def check_backgrounds():
    for given, written in (("-1000", "0"), ("300", "255"), ("7.5", "8")):
        image = make_ball()
        image.GetPointData().SetScalars(to_vtk("Bytes", numpy.zeros(image.GetNumberOfPoints(), numpy.uint8)))
        write_vti(image, path("bytes.vti"))
        arguments = (path("bytes.vti"), *lattice, *push, "--padding", "1", "--background", given, "-o",
                     path("bytes-o.vti"))
        output, errors = call(program, *arguments)
        words = f"--background {given}: the values of {path('bytes.vti')} are integers from 0 to 255. The background is"
        assert f"{words} {written}." in errors, errors
        Messages.check_words(errors)
        assert f"background {written}\n" in output, output
        assert read_vti(path("bytes-o.vti")).GetPointData().GetScalars().GetValue(0) == int(written)
    _, errors = call(program, path("bytes.vti"), *lattice, *push, "--background", "7", "-o", path("bytes-o.vti"))
    assert "--background" not in errors, errors


def check_fields():
    write_vti(make_field(), path("empty-field.vti"))
    write_vti(make_field("U", "V"), path("two.vti"))
    fails(1, ["3 components", "no point arrays"], "--field", path("empty-field.vti"))
    fails(1, ["--displacement", '"U" (3 components), "V" (3 components)'], "--field",
          path("two.vti"))
    for option in ("--field", "--mesh"):
        fails(1, ['no point array "W"', '"U" (3 components)'], option, path("two.vti"),
              "--displacement", "W")
        fails(1, ['no point array "U"', "no point arrays"], option, path("empty-field.vti"),
              "--displacement", "U")
    parts = make_field()
    for name in ("TX", "DISPX", "DISPY", "DISPZ"):
        parts.GetPointData().AddArray(to_vtk(name, numpy.ones(27)))
    write_vti(parts, path("parts.vti"))
    for option, *displacement in (("--field",), ("--field", "--displacement", "DISP"),
                                  ("--mesh", "--displacement", "DISPX")):
        fails(1, ['"DISPX", "DISPY" and "DISPZ"', "Merge Vector Components"], option, path("parts.vti"),
              *displacement)
    fails(1, "--points-are-deformed", "--mesh", path("field.vti"), "--displacement", "U",
          "--points-are-deformed")
    fails(1, "--open-splits", "--mesh", path("field.vti"), "--displacement", "U", "--open-splits")
    fails(1, "--rest", "--mesh", path("field.vti"), "--rest", path("mesh.vtu"))
    fails(1, "--rest", "--mesh", path("mesh.vtu"), "--rest", path("field.vti"))
    far = make_field("U")
    far.SetOrigin(1000, 0, 0)
    write_vti(far, path("far.vti"))
    fails(1, "holds no voxel of the volume", "--field", path("far.vti"))
    wrong = make_field("U")
    wrong.GetPointData().GetArray("U").SetComponent(13, 1, float("nan"))
    write_vti(wrong, path("nan.vti"))
    fails(1, "not finite", "--field", path("nan.vti"))


def check_meshes():
    fewer = make_unstructured(places[:-5], moves[:-5], make_tetrahedra()[:20])
    write_mesh("fewer.vtu", fewer)
    fails(1, [path("mesh.vtu"), "mesh has 60 points", "mesh at rest has 55"],
          "--mesh", path("mesh.vtu"), "--rest", path("fewer.vtu"))
    write_mesh("other.vtu", make_unstructured(places, moves, make_tetrahedra()[:20]))
    fails(1, "not those of the mesh at rest", "--mesh", path("mesh.vtu"), "--rest", path("other.vtu"))
    for name, value, expected in (("nan", float("nan"), "not finite"), ("far", 1e9, "16,383")):
        wrong = moves.copy()
        wrong[30] = value
        fails(1, expected, *write_mesh(name + ".vtu", make_unstructured(places, wrong)))
    fails(1, "holds no voxel", *write_mesh("far.vtu", make_unstructured(places + 1000, moves)))
    flat = places.copy()
    flat[:, 2] = 20
    fails(1, "flat", *write_mesh("flat.vtu", make_unstructured(flat, moves)))
    wrong = places.copy()
    wrong[7, 1] = float("inf")
    fails(1, "not finite", *write_mesh("inf.vtu", make_unstructured(wrong, moves)))
    wrong[7, 1] = float("nan")
    fails(1, "Point 7 of the deformation mesh is not finite",
          *write_mesh("nan.vtu", make_unstructured(wrong, moves)))
    for kind, size, expected in ((VTK_QUADRATIC_TETRA, 9, "quadratic tetra with 9 points"),
                                 (VTK_BEZIER_TETRAHEDRON, 4, "bezier tetra")):
        fails(1, expected, *write_mesh("cell.vtu", make_cells(kind, size)))
    bad = make_unstructured(places, moves)
    bad.InsertNextCell(VTK_TETRA, 4, [0, 1, 2, 99])
    bad.InsertNextCell(VTK_TETRA, 4, [0, 1, 2, 5000000])
    fails(1, [path("bad.vtu"), f"Cell {bad.GetNumberOfCells() - 2} of the deformation mesh uses point 99"],
          *write_mesh("bad.vtu", bad))
    good = make_unstructured(places, moves)
    fails(1, "uses point 99", *write_mesh("good.vtu", good)[:2], "--rest", path("bad.vtu"))
    convex = make_unstructured(places, moves, [])
    convex.InsertNextCell(VTK_CONVEX_POINT_SET, 8, make_hexahedra()[0])
    fails(1, ["no tetrahedra", "1 convex point set"], *write_mesh("convex.vtu", convex))
    warns(["3 quad", "ignored"], *write_mesh("shells.vtu", make_cells(VTK_QUAD, 4, 3)))
    wrong = moves.copy()
    wrong[30] = float("nan")
    block = make_unstructured(places, wrong)
    write(vtkXMLMultiBlockDataWriter(), make_blocks(("bone", block)), path("blocks.vtm"), **XML)
    fails(1, ['block "bone"', "not finite"], "--mesh", path("blocks.vtm"), "--displacement",
          "Displacement")


def check_sheets():
    bad = vtkPolyData()
    bad.DeepCopy(sheet)
    bad.InsertNextCell(VTK_TRIANGLE, 3, [0, 1, 99])
    write(vtkXMLPolyDataWriter(), bad, path("bad.vtp"), **XML)
    infinite = vtkPolyData()
    infinite.DeepCopy(sheet)
    infinite.GetPoints().SetPoint(1, float("nan"), 0, 0)
    write(vtkXMLPolyDataWriter(), infinite, path("infinite.vtp"), **XML)
    model = ("--model", "fem", *lattice, "--fix", "below:8", "--gravity", "0,0,-1")
    for name, expected in (("bad.vtp", "99"), ("infinite.vtp", "not finite")):
        fails(1, expected, "--cut", path(name))
        fails(1, expected, "--cut", path(name), *model)


def check_meshers():
    fails(2, "--keep: -1 is negative", *mesh, "--keep", "-1")
    tetgen = ("--tetgen", *push)
    fails(1, "isovalue", *tetgen, "--isovalue", "5000")
    image = make_ball()
    image.GetPointData().GetScalars().Fill(3)
    write_vti(image, path("constant.vti"))
    fails(1, "isovalue", *tetgen, source="constant.vti")
    image.GetPointData().SetScalars(to_vtk("Colors", numpy.zeros((25 * 22 * 19, 3), numpy.uint8)))
    write_vti(image, path("colors.vti"))
    fails(1, 'first component of the point array "Colors"', *tetgen, source="colors.vti")
    image.GetPointData().SetScalars(to_vtk("Labels", numpy.zeros(25 * 22 * 19, numpy.uint8)))
    write_vti(image, path("labels.vti"))
    fails(1, "label other than 0", *tetgen, "--labels", source="labels.vti")
    fails(1, "edge length", *tetgen, "--edge-length", "0.001")
    ball = (*tetgen, "--isovalue", "400", "--edge-length", "5")
    warns("two thirds of the fade distance", *ball, "--keep", "0.1")
    fails(1, "Cannot run TetGen", *tetgen, "--tetgen-executable", path("none"))
    fails(1, "TetGen failed", *tetgen, "--tetgen-executable", "/bin/false")
    fails(1, "fewer nodes", "--lattice", "100000,100000,100000", *push)


def check_models():
    fem, springs = ("--model", "fem", *lattice), ("--model", "mass-spring", *lattice)
    gravity = ("--gravity", "0,0,-1")
    for model in (fem, springs):
        fails(1, "radius", *model, "--fix", "below:90", "--pull", "9,20,25,1,0,0,0.001")
        fails(1, "radius", *model, "--fix", "below:90", "--pull", "9,20,25,1,0,0")
        fails(1, "fixes no node", *model, *gravity, "--fix", "below:-90")
        fails(1, "Poisson ratio", *model, *gravity, "--fix", "below:8", "--poisson", "0.7")
        fails(1, "Young modulus", *model, *gravity, "--fix", "below:8", "--young", "-1")
    warns("finite elements", *springs, *gravity, "--fix", "below:8", "--poisson", "0.1", "--duration", "0.01")
    fails(1, "nothing holds the body", *fem, "--pull", "9,20,25,1,0,0")
    image = make_ball(spacing=(1e-3, 1.5e-3, 2e-3), origin=(0, 0, 0))
    write_vti(image, path("metres.vti"))
    warns("millimeter", "--model", "fem", "--lattice", "5,5,5", "--fix", "below:0.001",
          *gravity, source="metres.vti")
    fails(1, "OpenCL", *mesh, "--device", "no-such-device")


def check_coverage():
    Messages.fails(program, 1, "covers no voxel of the result", path("in.vti"), "--carve", "sphere:9,20,25,90", "-o",
                   path("o.vti"), warnings=1)
    assert not os.path.exists(path("o.vti"))


def check_permission():
    """Checks files that the user cannot read. The superuser reads them, so another user starts the program."""
    user = ("setpriv", "--reuid", "65534", "--clear-groups") if os.geteuid() == 0 else ("env",)
    os.chmod(path(), 0o777)
    if call(*user, program, "--help", code=None, quiet=True)[1]:
        print("files without permission are not tested: another user cannot start the program")
        return
    for name, *arguments in (("secret.vti", *lattice, *push), ("in.vti", "--field", path("secret.vti")),
                             ("in.vti", "--mesh", path("secret.vtu"), "--displacement", "Displacement"),
                             ("in.vti", "--cut", path("secret.vtp")),
                             ("in.vti", *mesh, "--points", path("secret.csv"), "--points-output", path("p.csv"))):
        secret = [argument for argument in (path(name), *arguments) if "secret" in argument][0]
        with open(secret, "ab"):
            os.chmod(secret, 0)
        Messages.fails(user[0], 1, f"{secret}: there is no permission to read it", *user[1:], program, path(name),
                       *arguments, "-o", path("o.vti"))
    os.chmod(path(), 0o755)


check_resamplers()
check_volumes()
check_backgrounds()
check_fields()
check_meshes()
check_sheets()
check_meshers()
check_models()
check_coverage()
check_permission()
