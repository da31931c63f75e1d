# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads results as FEBio, FEBio Studio and SOFA write them, with the options of
Documents/solvers.md, and reports errors for wrong options, wrong units and changed meshes.
Usage: TestSolvers.py PROGRAM FOLDER"""

import Messages
import numpy
from MeshFiles import make_moves, make_places, make_tetrahedra, make_unstructured, write, write_collection
from SolverFiles import find_edges, write_febio, write_febio_studio, write_sofa
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

program, path = begin_test("Solvers")

# A volume around the origin of the world, as scans usually are.
volume = make_ball(origin=(-12.0, -16.0, -18.0))
write_vti(volume, path("in.vti"))
places = make_places(volume.GetBounds())[1]
moves = make_moves(places)
cells = make_tetrahedra()
displacement = ("--displacement", "displacement")


def fails(expected, *arguments, warnings=0):
    Messages.fails(program, 1, expected, path("in.vti"), *arguments, "-o", path("o.vti"), warnings=warnings)


def deform(*arguments, warnings=()):
    """Returns the values and the coverage of the deformed volume. warnings: a text for each expected warning."""
    _, errors = call(program, path("in.vti"), *arguments, "-o", path("o.vti"), "--quiet", "--bounds", "volume")
    assert errors.count("warning:") == len(warnings), errors
    for text in warnings:
        assert text in errors, f"{text} is not in {errors}"
    Messages.check_words(errors)
    result = read_vti(path("o.vti"))
    return get_values(result).astype(float), get_values(result, "vtkValidPointMask")


def mesh(name):
    return "--mesh", path(name)


def check_same(expected, *arguments, warnings=()):
    """Checks values. Voxels at the rim of the covered part may be covered or not."""
    values, covered = deform(*arguments, warnings=warnings)
    assert (covered != expected[1]).mean() < 1e-3, (covered != expected[1]).mean()
    check_values(values, expected[0], (covered != 0) & (expected[1] != 0))


def check_values(values, expected, both):
    """Checks values. Numbers with six digits change a position by at most 5e-5 mm. In a few voxels this changes the
    rounded position by 1/256 voxel on each axis. Values of neighboring voxels are integers and differ by up to 850."""
    difference = numpy.abs(values - expected)[both]
    assert difference.max() <= 3 * 850 / 256 + 1, difference.max()
    assert (difference > 0).mean() < 0.02, (difference > 0).mean()


def add_middle_nodes(center):
    """Returns tetrahedra of ten nodes, or of 15 nodes, with nodes in the faces and the center."""
    points = list(map(tuple, places))
    numbers = {}

    def add(*corners):
        key = tuple(sorted(corners))
        if key not in numbers:
            numbers[key] = len(points)
            points.append(tuple(places[list(corners)].mean(axis=0)))
        return numbers[key]

    quadratic = []
    for a, b, c, d in cells:
        middle = [add(*edge) for edge in ((a, b), (b, c), (c, a), (a, d), (b, d), (c, d))]
        faces = [add(*face) for face in ((a, b, c), (a, b, d), (b, c, d), (a, c, d), (a, b, c, d))]
        quadratic.append([a, b, c, d] + middle + (faces if center else []))
    return numpy.array(points), quadratic


def interpolate(moves_of_corners, quadratic, number):
    """Returns displacements of all nodes, linear in each tetrahedron."""
    result = numpy.zeros((number, 3))
    for cell in quadratic:
        corners = moves_of_corners[cell[:4]]
        result[cell[:4]] = corners
        for node, (a, b) in zip(cell[4:10], ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))):
            result[node] = 0.5 * (corners[a] + corners[b])
    return result


def check_febio(expected):
    """Tests files of FEBio: points are at rest, and there is a file for each state."""
    for state, factor in enumerate((0.0, 0.5, 1.0)):
        write_febio(path(f"model.{state}.vtk"), places, factor * moves, cells, factor)
        write_febio_studio(path(f"model.st{state}.vtk"), places, factor * moves, cells, factor)
    write_collection(path("model.pvd"), [(0.0, "model.0.vtk"), (0.5, "model.1.vtk"), (1.0, "model.2.vtk")])
    known = ['"fluid_pressure" (1 component)', '"displacement" (3 components)', '"reaction_forces" (3 components)']
    fails(['no point array "U"', *known], *mesh("model.2.vtk"), "--displacement", "U")
    fails(['no point array "Displacement"', *known], *mesh("model.2.vtk"), "--displacement", "Displacement")
    fails("part_id\" of displacements", *mesh("model.2.vtk"), "--displacement", "part_id")
    check_same(expected, *mesh("model.2.vtk"), *displacement)
    check_same(expected, *mesh("model.pvd"), *displacement, warnings=["3 time steps; the last one, of the time 1"])
    half = deform(*mesh("exact.vtu"), *displacement, "--scale", "0.5")
    check_same(half, *mesh("model.1.vtk"), *displacement)
    # An export of FEBio Studio has deformed points.
    check_same(expected, *mesh("model.st2.vtk"), *displacement, "--points-are-deformed")
    values, _ = deform(*mesh("model.st2.vtk"), *displacement, warnings=["--points-are-deformed"])
    assert numpy.abs(values - expected[0]).max() > 20.0, numpy.abs(values - expected[0]).max()
    check_same(expected, *mesh("model.st2.vtk"), "--rest", path("model.0.vtk"))
    # Tetrahedra of ten nodes, and tetrahedra of 15 nodes with the cell type of ten nodes.
    points, quadratic = add_middle_nodes(center=False)
    write_febio(path("quadratic.vtk"), points, interpolate(moves, quadratic, len(points)), quadratic, 1.0)
    check_same(expected, *mesh("quadratic.vtk"), *displacement)
    points, quadratic = add_middle_nodes(center=True)
    write_febio(path("center.vtk"), points, numpy.zeros((len(points), 3)), quadratic, 1.0)
    fails("is a quadratic tetra with 15 points instead of 10", *mesh("center.vtk"), *displacement)


def check_sofa(expected):
    """Tests files of SOFA: points are deformed, there is a file for each step, and edges are written by default."""
    ignored = ["are ignored: 255 line"]
    for step, factor in ((0, 0.0), (1, 1.0)):
        write_sofa(path(f"body{step}.vtu"), places + factor * moves, cells, edges=False)
        write_sofa(path(f"body_{step}.vtk"), places + factor * moves, cells, [("rest_position", places)])
        write_sofa(path(f"edges{step}.vtu"), places + factor * moves, find_edges(cells), edges=False)
    fails(["60 points and 255 cells", "three-dimensional cells"], *mesh("edges1.vtu"), "--rest", path("edges0.vtu"))
    fails("there are no point arrays", *mesh("body1.vtu"), *displacement)
    fails(['no point array "displacement"', '"rest_position" (3 components)'], *mesh("body_1.vtk"), *displacement)
    check_same(expected, *mesh("body1.vtu"), "--rest", path("body0.vtu"))
    check_same(expected, *mesh("body_1.vtk"), "--rest", path("body_0.vtk"), warnings=ignored)
    check_same(expected, *mesh("body1.vtu"), "--rest", path("body_0.vtk"), warnings=ignored)
    # A tetrahedron has been deleted between two steps: SOFA moves the last one to its index, and keeps all edges.
    left = cells[:-1]
    left[3] = cells[-1]
    write_sofa(path("less1.vtu"), places + moves, find_edges(cells) + left, [("rest_position", places)], edges=False)
    fails("cells of the deformation mesh are not those of the mesh at rest", *mesh("less1.vtu"), "--rest", path("body0.vtu"))
    write_sofa(path("less0.vtu"), places, left, edges=False)
    values, covered = deform(*mesh("less1.vtu"), "--rest", path("less0.vtu"))
    both = (covered != 0) & (expected[1] != 0)
    assert 0.0 < ((covered == 0) & (expected[1] != 0)).mean() < 0.05, ((covered == 0) & (expected[1] != 0)).mean()
    # The values in the remaining tetrahedra have not changed.
    check_values(values, expected[0], both)
    # Displacements that ParaView's Calculator computes from the rest positions.
    write_sofa(path("less2.vtu"), places + moves, left, [("rest_position", places), ("displacement", moves)])
    values, again = deform(*mesh("less2.vtu"), *displacement, "--points-are-deformed", warnings=["are ignored"])
    assert (again != covered).mean() < 1e-3, (again != covered).mean()
    check_values(values, expected[0], (again != 0) & (expected[1] != 0))
    # A point has been deleted.
    number = 30
    others = [[node - (node > number) for node in cell] for cell in cells if number not in cell]
    write_sofa(path("fewer1.vtu"), numpy.delete(places + moves, number, axis=0), others)
    fails(["has 59 points", "mesh at rest has 60"], *mesh("fewer1.vtu"), "--rest", path("body0.vtu"))


def check_units():
    """Tests a mesh in meters around the origin, where it contains some voxels of a volume in millimeters."""
    write_febio(path("metres.vtk"), 1e-3 * places, 1e-3 * moves, cells, 1.0)
    none = "nothing is written, because the deformed volume covers no voxel of the result"
    small = "The mesh is smaller than two voxels of the volume on each axis"
    whole = ("--bounds", "volume")
    fails([small, none], *mesh("metres.vtk"), *displacement, *whole, warnings=2)
    deform(*mesh("metres.vtk"), *displacement, "--keep", "1", warnings=[small])
    write_febio(path("kilometres.vtk"), 1e3 * places, moves, cells, 1.0)
    large = "The cells of the mesh are more than ten times as long as the volume"
    deform(*mesh("kilometres.vtk"), *displacement, warnings=[large])
    # A mesh elsewhere contains no voxel, and the error states both boxes.
    write_febio(path("aside.vtk"), 1e-3 * places + 40.0, 1e-3 * moves, cells, 1.0)
    fails(["holds no voxel of the volume", "x from 39.988 to 40.012", "x from -12 to 12", "millimeters"],
          *mesh("aside.vtk"), *displacement)
    write_sofa(path("metres0.vtu"), 1e-3 * places, cells, edges=False)
    write_sofa(path("metres1.vtu"), 1e-3 * (places + moves), cells, edges=False)
    fails([small, none], *mesh("metres1.vtu"), "--rest", path("metres0.vtu"), *whole, warnings=2)
    # A mesh of a small part of the volume is not an error, and there is no warning.
    write_febio(path("part.vtk"), 0.1 * places, 0.1 * moves, cells, 1.0)
    _, covered = deform(*mesh("part.vtk"), *displacement)
    assert covered.any()


exact = make_unstructured(places, moves)
exact.GetPointData().GetArray("Displacement").SetName("displacement")
write(vtkXMLUnstructuredGridWriter(), exact, path("exact.vtu"))
truth = deform(*mesh("exact.vtu"), *displacement)
check_febio(truth)
check_sofa(truth)
check_units()
