# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads meshes and sheets of many formats, each with the same result, and that the error for a
file that it cannot use states what the file contains. Usage: TestMeshFiles.py PROGRAM FOLDER"""
import functools
import os
import re
import shutil

import Messages
import numpy
from MeshFiles import (
    SIZE,
    add_arrays,
    make_blocks,
    make_hexahedra,
    make_moves,
    make_places,
    make_rectilinear,
    make_sheet,
    make_structured,
    make_tetrahedra,
    make_unstructured,
    state_space,
    to_points,
    to_vtk,
    write,
    write_collection,
    write_exodus,
    write_hdf,
)
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import (
    VTK_LINE,
    VTK_POLYHEDRON,
    VTK_QUAD,
    VTK_TETRA,
    VTK_VERTEX,
    vtkImageData,
    vtkPartitionedDataSet,
    vtkPartitionedDataSetCollection,
    vtkPolyData,
    vtkRectilinearGrid,
    vtkTable,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOGeometry import vtkOBJWriter
from vtkmodules.vtkIOLegacy import (
    vtkDataSetWriter,
    vtkPolyDataWriter,
    vtkStructuredPointsWriter,
    vtkTableWriter,
    vtkUnstructuredGridWriter,
)
from vtkmodules.vtkIOParallelXML import (
    vtkXMLPartitionedDataSetCollectionWriter,
    vtkXMLPartitionedDataSetWriter,
    vtkXMLPUnstructuredGridWriter,
)
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataWriter,
    vtkXMLMultiBlockDataWriter,
    vtkXMLPolyDataWriter,
    vtkXMLRectilinearGridWriter,
    vtkXMLStructuredGridWriter,
    vtkXMLUnstructuredGridWriter,
)

program, path = begin_test("MeshFiles")
volume = make_ball()
write_vti(volume, path("in.vti"))
axes, places = make_places(volume.GetBounds())
moves = make_moves(places)
mesh = make_unstructured(places, moves)
XML = {"SetDataMode": 1, "SetHeaderType": 64}  # binary, not appended


fails = functools.partial(Messages.refuses, program, path)


def as_mesh(name, displacement="Displacement"):
    return "--mesh", path(name), "--displacement", displacement


def cut_off(name, source, part=0.6):
    with open(path(source), "rb") as whole, open(path(name), "wb") as file:
        content = whole.read()
        file.write(content[:int(len(content) * part)])


def write_text(name, text="no mesh\n"):
    with open(path(name), "w", encoding="ascii") as file:
        file.write(text)


# Files of all formats.
write(vtkXMLUnstructuredGridWriter(), mesh, path("mesh.vtu"), **XML)
write(vtkUnstructuredGridWriter(), mesh, path("binary.vtk"), SetFileType=2)
write(vtkUnstructuredGridWriter(), mesh, path("old.vtk"), SetFileType=2, SetFileVersion=42)
write(vtkXMLPUnstructuredGridWriter(), mesh, path("mesh.pvtu"), SetNumberOfPieces=2,
      SetEndPiece=1, **XML)
write(vtkXMLUnstructuredGridWriter(), make_unstructured(places, moves, make_hexahedra()),
      path("hexahedra.vtu"), **XML)
structured = make_structured(places, moves)
write(vtkXMLStructuredGridWriter(), structured, path("mesh.vts"), **XML)
write(vtkDataSetWriter(), structured, path("structured.vtk"), SetFileType=2)
rectilinear = make_rectilinear(axes, moves)
write(vtkXMLRectilinearGridWriter(), rectilinear, path("mesh.vtr"), **XML)
write(vtkDataSetWriter(), rectilinear, path("rectilinear.vtk"), SetFileType=2)
cells = make_tetrahedra()
half = len(cells) // 2
parts = [make_unstructured(places, moves, some) for some in (cells[:half], cells[half:])]
write(vtkXMLMultiBlockDataWriter(), make_blocks(("left", parts[0]), ("right", parts[1])),
      path("mesh.vtm"), **XML)
collection = vtkPartitionedDataSetCollection()
both = vtkPartitionedDataSet()
for number, part in enumerate(parts):
    collection.SetPartition(number, 0, part)
    both.SetPartition(number, part)
write(vtkXMLPartitionedDataSetCollectionWriter(), collection, path("mesh.vtpc"), **XML)
write(vtkXMLPartitionedDataSetWriter(), both, path("mesh.vtpd"), **XML)
for number, part in enumerate(parts):
    write(vtkXMLUnstructuredGridWriter(), part, path(f"part{number}.vtu"), **XML)
write(vtkXMLUnstructuredGridWriter(), make_unstructured(places, 0.5 * moves), path("before.vtu"),
      **XML)
os.makedirs(path("series"))
shutil.copy(path("mesh.vtu"), path("series/last.vtu"))
write_collection(path("one.pvd"), [(0, "mesh.vtu")])
write_collection(path("parts.pvd"), [(0.5, "part0.vtu"), (0.5, "part1.vtu")])
write_collection(path("series.pvd"), [(2.5, "series/last.vtu"), (0, "before.vtu"),
                                      (1, path("before.vtu"))])
write_exodus(mesh, path("mesh.e"))
write_exodus(mesh, path("series.exo"), (0.0, 0.5, 1.0))
shutil.copy(path("mesh.e"), path("mesh.ex2"))
write_hdf(path("mesh.vtkhdf"), places, moves)


def make_point():
    grid = vtkRectilinearGrid()
    grid.SetDimensions(1, 1, 1)
    return grid


def make_flat():
    """Returns a grid with cells of all dimensions except three."""
    grid = make_unstructured(places, moves, [])
    for kind, points in ((VTK_QUAD, [0, 1, 4, 3]), (VTK_QUAD, [3, 4, 7, 6]), (VTK_LINE, [0, 1]),
                         (VTK_VERTEX, [0])):
        grid.InsertNextCell(kind, len(points), points)
    return grid


def add_cell_array(grid):
    grid.GetCellData().AddArray(to_vtk("Displacement", numpy.zeros((grid.GetNumberOfCells(), 3))))


def write_polyhedra(name):
    """Writes polyhedra as VTK 9.4 and later do: the faces are in arrays that earlier versions do not read."""
    write(vtkXMLUnstructuredGridWriter(), mesh, name, SetDataMode=0)
    with open(name, encoding="ascii") as file:
        text = file.read()
    text = re.sub('version="[0-9.]+" byte', 'version="2.3" byte', text)
    start = text.index('Name="types"')
    text = text[:start] + text[start:].replace(f" {VTK_TETRA}", f" {VTK_POLYHEDRON}")
    with open(name, "w", encoding="ascii") as file:
        file.write(text)


def write_sheets():
    """Writes one sheet in all formats, and returns the names of the files. All formats can represent its coordinates
    exactly."""
    sheet = make_sheet(volume.GetBounds(), volume.GetCenter()[0] + 0.25)
    sheet.GetPointData().Initialize()
    triangulation = vtkTriangleFilter()
    triangulation.SetInputData(sheet)
    triangulation.Update()
    triangles = triangulation.GetOutput()
    write(vtkXMLPolyDataWriter(), sheet, path("cut.vtp"), **XML)
    write(vtkPolyDataWriter(), sheet, path("cut.vtk"), SetFileType=2)
    write(vtkSTLWriter(), triangles, path("cut.stl"), SetFileType=2)
    write(vtkSTLWriter(), triangles, path("ascii.stl"), SetFileType=1)
    write(vtkPLYWriter(), triangles, path("cut.ply"), SetFileType=2)
    write(vtkPLYWriter(), triangles, path("ascii.ply"), SetFileType=1)
    write(vtkOBJWriter(), triangles, path("cut.obj"))
    return ["cut.vtp", "cut.vtk", "cut.stl", "ascii.stl", "cut.ply", "ascii.ply", "cut.obj"]


def check_misuse_of_meshes():
    fails(1, ["no such file"], *as_mesh("none.vtu"))
    fails(1, ["it is a folder"], *as_mesh("series"))
    # Formats that VTK does not read, and a name without a suffix.
    for name, converter in (
            ("fe.msh", "meshio convert fe.msh fe.vtu"), ("fe.med", "meshio convert fe.med"),
            ("fe.CGNS", "meshio convert fe.CGNS fe.vtu"), ("fe.xdmf", "ParaView"),
            ("fe.csv", "Table To Structured Grid"),
            ("fe.frd", "ccx2paraview fe.frd vtu"), ("fe.inp", "without results"),
            ("fe.bdf", "without results"), ("fe.feb", "FEBio Studio"),
            ("fe.xplt", "FEBio Studio"), ("fe.odb", "Save Data"), ("fe.stl", "Gmsh"),
            ("fe.vtu.series", "one of them"), ("field.nii.gz", "--field"), ("fe", "meshio")):
        write_text(name)
        fails(1, [".vtu, .pvtu, .vtm, .vts, .vtr, .vtk, .pvd, .e, .exo, .ex2, .vtkhdf", ".vti",
                  converter], *as_mesh(name))
    # Files whose content does not fit their suffix.
    for name in ("text.vtu", "text.vtk", "text.pvd", "text.e", "text.vtkhdf"):
        write_text(name)
        fails(1, [path(name), "cannot read", "damaged or cut off"], *as_mesh(name))
        write_text(name, "")
        fails(1, [path(name), "cannot read", "damaged or cut off"], *as_mesh(name))
    for source in ("mesh.vtu", "binary.vtk", "old.vtk", "one.pvd", "mesh.vtr", "mesh.e",
                   "mesh.vtkhdf"):
        for part in (0.3, 0.6, 0.95):
            cut_off("cut-off-" + source, source, part)
            fails(1, [path("cut-off-" + source), "cannot read", "damaged or cut off"],
                  *as_mesh("cut-off-" + source))
    # VTK cannot read NaN from text.
    write_text("nan.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
               "0 0 0 9 0 0 0 9 0 0 0 9\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n"
               "VECTORS Displacement float\n1 0 0 nan 0 0 0 0 0 0 0 0\n")
    fails(1, [path("nan.vtk"), "numbers that are not finite"], *as_mesh("nan.vtk"))
    # Collections.
    write_text("other.pvd", '<VTKFile type="UnstructuredGrid"></VTKFile>\n')
    fails(1, "not a collection", *as_mesh("other.pvd"))
    write_collection(path("empty.pvd"), [])
    fails(1, "names no files", *as_mesh("empty.pvd"))
    write_collection(path("broken.pvd"), [(0, "gone.vtu")])
    fails(1, [path("gone.vtu"), "no such file"], *as_mesh("broken.pvd"))
    write_collection(path("times.pvd"), [("later", "mesh.vtu")])
    fails(1, '"later" of a file is not a number', *as_mesh("times.pvd"))
    for attributes in ("", 'timestep="1"', 'timestep="1" part="0"'):
        write_text("twice.pvd", f'<VTKFile type="Collection"><Collection><DataSet {attributes} file="mesh.vtu"/>'
                   f'<DataSet {attributes} file="before.vtu"/></Collection></VTKFile>\n')
        Messages.warns(program, "names 2 files with the same attributes timestep and part", path("in.vti"),
                       *as_mesh("twice.pvd"), "-o", path("twice.vti"))
    write_collection(path("nested.pvd"), [(0, "one.pvd")])
    fails(1, "another .pvd file", *as_mesh("nested.pvd"))
    write_collection(path("msh.pvd"), [(0, "fe.msh")])
    fails(1, "meshio convert fe.msh", *as_mesh("msh.pvd"))
    shutil.copy(path("mesh.pvtu"), path("gone.pvtu"))
    os.rename(path("mesh_1.vtu"), path("moved.vtu"))
    fails(1, ["cannot read", path("gone.pvtu")], *as_mesh("gone.pvtu"))
    os.rename(path("moved.vtu"), path("mesh_1.vtu"))
    shutil.copytree(path("mesh"), path("gone"))
    os.remove(path("mesh/mesh_1.vtu"))
    fails(1, ["cannot read", path("mesh.vtm")], *as_mesh("mesh.vtm"))
    shutil.rmtree(path("mesh"))
    os.rename(path("gone"), path("mesh"))
    # Files with data other than meshes.
    write(vtkXMLRectilinearGridWriter(), make_point(), path("point.vtr"), **XML)
    fails(1, ["1 point and 1 cell", "three-dimensional cells"], *as_mesh("point.vtr", "u"))
    sheet = make_sheet(volume.GetBounds(), volume.GetCenter()[0] + 0.25)
    write(vtkXMLPolyDataWriter(), sheet, path("sheet.vtp"), **XML)
    write(vtkPolyDataWriter(), sheet, path("sheet.vtk"))
    for name in ("sheet.vtp", "sheet.vtk"):
        fails(1, ["4 points and 1 cell", "three-dimensional cells"],
              *as_mesh(name))
    write(vtkXMLUnstructuredGridWriter(), make_flat(), path("flat.vtu"), **XML)
    fails(1, "60 points and 4 cells, but no three-dimensional cells", *as_mesh("flat.vtu"))
    bare = vtkUnstructuredGrid()
    bare.SetPoints(to_points(places))
    write(vtkXMLUnstructuredGridWriter(), bare, path("bare.vtu"), **XML)
    fails(1, "60 points and 0 cells", *as_mesh("bare.vtu"))
    write(vtkXMLUnstructuredGridWriter(), vtkUnstructuredGrid(), path("empty.vtu"), **XML)
    fails(1, ["cannot read", "Points"], *as_mesh("empty.vtu"))
    write(vtkTableWriter(), vtkTable(), path("table.vtk"))
    fails(1, "0 points and 0 cells", *as_mesh("table.vtk"))
    write(vtkXMLMultiBlockDataWriter(), make_blocks(("a", make_flat()), ("b", sheet)),
          path("flat.vtm"), **XML)
    fails(1, "64 points and 5 cells", *as_mesh("flat.vtm"))
    # Arrays.
    known = '"Temperature" (1 component), "Reaction" (3 components), "Displacement" (3 components)'
    fails(1, ['no point array "u"', known], *as_mesh("mesh.vtu", "u"))
    fails(1, ['the point array "Temperature" has', "1 component, but displacements have 3", known],
          *as_mesh("mesh.vtu", "Temperature"))
    fails(1, ['block "left"', 'no point array "u"', known], *as_mesh("mesh.vtm", "u"))
    fails(1, ['no point array "u"', '"Temperature" (1 component)'], *as_mesh("mesh.e", "u"))
    none = make_unstructured(places, moves)
    none.GetPointData().Initialize()
    write(vtkXMLUnstructuredGridWriter(), none, path("none.vtu"), **XML)
    fails(1, "no point arrays", *as_mesh("none.vtu"))
    add_cell_array(none)
    write(vtkXMLUnstructuredGridWriter(), none, path("cells.vtu"), **XML)
    fails(1, ["no point arrays", "Cell Data to Point Data"], *as_mesh("cells.vtu"))
    write(vtkXMLMultiBlockDataWriter(), make_blocks(("bone", mesh), ("skin", none)),
          path("half.vtm"), **XML)
    fails(1, ['block "skin"', "no point arrays"], *as_mesh("half.vtm"))
    fails(1, ['no point array "Displacement"', '"Values" (1 component)'], *as_mesh("in.vti"))
    # Files of later versions of VTK that VTK 9.1 does not read.
    write_polyhedra(path("polyhedra.vtu"))
    fails(1, ["is a polyhedron", "version 2.3", "VTK 9.4", "ParaView 5.13"],
          *as_mesh("polyhedra.vtu"))
    write_hdf(path("steps.vtkhdf"), places, moves, version=(2, 0), steps=[0, 1])
    if vtkVersion().GetVTKMajorVersion() == 9 and vtkVersion().GetVTKMinorVersion() < 3:
        fails(1, ["time steps", ".vtu"], *as_mesh("steps.vtkhdf"), warnings=1)
    write_hdf(path("sheet.vtkhdf"), places, moves, kind=b"PolyData",
              without=("NumberOfCells", "NumberOfConnectivityIds", "Offsets", "Connectivity", "Types"))
    fails(1, "cannot read", *as_mesh("sheet.vtkhdf"))


def check_misuse_of_sheets():
    def sheet(name):
        return "--cut", path(name)

    fails(1, "no such file", *sheet("none.stl"))
    for name, converter in (("cut.msh", "meshio convert cut.msh cut.ply"), ("cut.off", "meshio"),
                            ("cut.vtu", "Extract Surface"), ("cut.e", "Extract Surface"),
                            ("cut", "meshio")):
        write_text(name)
        fails(1, [".vtp, .stl, .ply, .obj, .vtk", converter], *sheet(name))
    for name in ("text.vtp", "text.ply", "text.vtk"):
        write_text(name)
        fails(1, [path(name), "cannot read", "damaged or cut off"], *sheet(name))
        write_text(name, "")
        fails(1, [path(name), "cannot read", "damaged or cut off"], *sheet(name))
    for name in ("text.stl", "text.obj"):
        write_text(name)
        fails(1, path(name), *sheet(name))
        write_text(name, "")
        fails(1, path(name), *sheet(name))
    write_text("empty.stl", "solid a\nendsolid a\n")
    fails(1, ["0 points and 0 cells", "triangles"], *sheet("empty.stl"))
    for name in SHEETS:
        for part in (0.4, 0.7, 0.95):
            cut_off("cut-off-" + name, name, part)
            fails(1, path("cut-off-" + name), *sheet("cut-off-" + name))
    # Files with data other than surfaces.
    write(vtkStructuredPointsWriter(), volume, path("image.vtk"))
    fails(1, ["an image of 25 x 22 x 19 points", "triangles"], *sheet("image.vtk"))
    fails(1, ["60 points and 144 cells", "triangles"], *sheet("binary.vtk"))
    lines = vtkPolyData()
    lines.SetPoints(to_points(places))
    lines.Allocate(1)
    lines.InsertNextCell(VTK_LINE, 2, [0, 1])
    write(vtkXMLPolyDataWriter(), lines, path("lines.vtp"), **XML)
    fails(1, ["60 points and 1 cell", "triangles"], *sheet("lines.vtp"))


def deform(*arguments, expected_warnings=(), source="in.vti"):
    """Returns the values and the coverage of the deformed volume."""
    _, errors = call(program, path(source), *arguments, "-o", path("result.vti"), "--bounds",
                     "volume", "--padding", "6", "--quiet")
    warnings = errors.splitlines()
    assert len(warnings) == len(expected_warnings), errors
    for line, text in zip(warnings, expected_warnings):
        assert line.startswith("deform-volume: warning: ") and text in line, line
    result = read_vti(path("result.vti"))
    os.remove(path("result.vti"))
    return get_values(result), get_values(result, "vtkValidPointMask")


def check_same(expected, *arguments, **settings):
    for values, array in zip(expected, deform(*arguments, **settings)):
        numpy.testing.assert_array_equal(values, array)


def check_formats_of_meshes():
    """Checks that all formats give the same result. All of them store displacements in double precision, and the nodes
    exactly."""
    expected = deform(*as_mesh("mesh.vtu"))
    assert 1000 < expected[1].sum() < expected[1].size - 1000, (expected[1].sum(), expected[1].size - 1000)
    for name in ("binary.vtk", "old.vtk", "mesh.pvtu", "mesh.vtm", "mesh.vtpc", "mesh.vtpd", "one.pvd", "parts.pvd",
                 "mesh.e", "mesh.ex2", "mesh.vtkhdf"):
        check_same(expected, *as_mesh(name))
    hexahedra = deform(*as_mesh("hexahedra.vtu"))
    for name in ("mesh.vts", "structured.vtk", "mesh.vtr", "rectilinear.vtk"):
        check_same(hexahedra, *as_mesh(name))
    shutil.copy(path("mesh.vtu"), path("UPPER.VTU"))
    check_same(expected, *as_mesh("UPPER.VTU"))
    # Of a series the last step is read, and a warning states it.
    check_same(expected, *as_mesh("series.pvd"),
               expected_warnings=["series.pvd holds 3 time steps; the last one, of the time 2.5"])
    # The mesh at rest is the first step of a series.
    write(vtkXMLUnstructuredGridWriter(), make_unstructured(places + moves, moves), path("second.vtu"), **XML)
    write_collection(path("moving.pvd"), [(0.0, "mesh.vtu"), (1.0, "second.vtu")])
    check_same(deform("--mesh", path("second.vtu"), "--rest", path("mesh.vtu")), "--mesh", path("moving.pvd"), "--rest",
               path("moving.pvd"), expected_warnings=["moving.pvd holds 2 time steps; the last one, of the time 1",
                                                      "moving.pvd holds 2 time steps; the first one, of the time 0"])
    check_same(expected, *as_mesh("series.exo"),
               expected_warnings=["series.exo holds 3 time steps; the last one, of the time 1,"])
    # A pair of meshes of several formats.
    write(vtkUnstructuredGridWriter(), make_unstructured(places + moves, moves),
          path("moved.vtk"), SetFileType=2)
    pair = deform("--mesh", path("moved.vtk"), "--rest", path("mesh.vtu"))
    check_same(pair, "--mesh", path("moved.vtk"), "--rest", path("mesh.vtkhdf"))
    assert (pair[0] != expected[0]).mean() < 1e-3, (pair[0] != expected[0]).mean()  # because sums are rounded


def check_formats_of_sheets():
    pull = ("--model", "chainmail", "--pull", "8,20,25,-3,1,1,3")
    expected = deform("--cut", path("cut.vtp"), *pull)
    assert not numpy.array_equal(expected[0], deform(*pull)[0])
    for name in SHEETS:
        check_same(expected, "--cut", path(name), *pull)


FLIP = numpy.array([-1.0, -1.0, 1.0])
LPS_HEADER = "3D Slicer output. SPACE=LPS"  # as 3D Slicer writes it


def convert_volume(name):
    """Writes the volume in a format that states its world: .nii is RAS, .mhd is LPS."""
    call(program, path("in.vti"), "--lattice", "3,3,3", "--push", "0,0,0,0.0001,0,0,1000", "-o",
         path(name), "--quiet", "--bounds", "volume")


def write_flipped_meshes():
    """Writes the mesh in the other world."""
    flipped = FLIP * places
    flipped_moves = FLIP * moves
    for integer, name in ((False, "other.vtu"), (True, "bytes.vtu")):
        grid = make_unstructured(flipped, flipped_moves)
        if integer:
            grid.GetPointData().AddArray(to_vtk("Displacement",
                                                numpy.full(moves.shape, 2, numpy.uint8)))
        write(vtkXMLUnstructuredGridWriter(), grid, path(name), **XML)
    grid = make_unstructured(flipped, flipped_moves)
    write(vtkUnstructuredGridWriter(), grid, path("other.vtk"), SetFileType=2)
    write(vtkUnstructuredGridWriter(), grid, path("slicer.vtk"), SetFileType=2,
          SetHeader=LPS_HEADER)
    write(vtkXMLStructuredGridWriter(), make_structured(flipped, flipped_moves), path("other.vts"),
          **XML)
    write(vtkXMLRectilinearGridWriter(),
          make_rectilinear([sign * axis for sign, axis in zip(FLIP, axes)], flipped_moves),
          path("other.vtr"), **XML)
    write_exodus(grid, path("other.e"))
    write_hdf(path("other.vtkhdf"), flipped, flipped_moves)
    left, right = (make_unstructured(flipped, flipped_moves, some)
                   for some in (cells[:half], cells[half:]))
    write(vtkXMLMultiBlockDataWriter(), make_blocks(("left", left), ("right", right)),
          path("other.vtm"), **XML)
    # Files that state their world.
    write(vtkXMLUnstructuredGridWriter(), state_space(grid, "LPS"), path("slicer.vtu"), **XML)
    write(vtkXMLUnstructuredGridWriter(), state_space(left, "LPS"), path("left.vtu"), **XML)
    write_collection(path("mixed.pvd"), [(0, "left.vtu"), (0, "part1.vtu")])
    strange = state_space(make_unstructured(places, moves), "scanner")
    write(vtkXMLUnstructuredGridWriter(), strange, path("strange.vtu"), **XML)


def check_spaces_of_meshes():
    """Checks that a mesh deforms a volume of the other world as a mesh of the same world does. Results are equal bit
    for bit, because negation is exact."""
    write_flipped_meshes()
    expected = deform(*as_mesh("mesh.vtu"))
    hexahedra = deform(*as_mesh("hexahedra.vtu"))
    for volume_name, own, other in (("in.nii.gz", "ras", "lps"), ("in.mhd", "lps", "ras")):
        check_same(expected, *as_mesh("mesh.vtu"), source=volume_name)
        check_same(expected, *as_mesh("mesh.vtu"), "--mesh-space", own, source=volume_name)
        for name in ("other.vtu", "other.vtk", "other.vtm", "other.e", "other.vtkhdf"):
            check_same(expected, *as_mesh(name), "--mesh-space", other, source=volume_name)
        for name in ("other.vts", "other.vtr"):
            check_same(hexahedra, *as_mesh(name), "--mesh-space", other, source=volume_name)
    same = deform("--mesh", path("moved.vtk"), "--rest", path("mesh.vtu"))
    write(vtkUnstructuredGridWriter(), make_unstructured(FLIP * (places + moves), moves),
          path("other-moved.vtk"), SetFileType=2)
    check_same(same, "--mesh", path("other-moved.vtk"), "--rest", path("other.vtu"), "--mesh-space",
               "lps", source="in.nii.gz")
    # Without the option, a mesh of the other world contains no voxel of the volume.
    fails(1, "holds no voxel of the volume", *as_mesh("other.vtu"), source="in.nii.gz")
    # Displacements of an unsigned type, which cannot be negated.
    grid = make_unstructured(places, moves)
    grid.GetPointData().AddArray(to_vtk("Displacement", numpy.full(moves.shape, 2.0) * FLIP))
    write(vtkXMLUnstructuredGridWriter(), grid, path("signed.vtu"), **XML)
    check_same(deform(*as_mesh("signed.vtu")), *as_mesh("bytes.vtu"), "--mesh-space", "lps",
               source="in.nii.gz")
    # A field: its grid and its vectors are converted.
    for name, origin, sign in (("field.vti", volume.GetOrigin(), 1),
                               ("other.vti", FLIP * volume.GetOrigin(), -1)):
        field = vtkImageData()
        field.SetDimensions(*SIZE)
        field.SetSpacing(*(n * step / (m - 1) for n, step, m in
                           zip((24, 21, 18), volume.GetSpacing(), SIZE)))
        field.SetOrigin(*origin)
        field.SetDirectionMatrix(sign, 0, 0, 0, sign, 0, 0, 0, 1)
        add_arrays(field, moves if sign > 0 else FLIP * moves)
        write(vtkXMLImageDataWriter(), field, path(name), **XML)
    check_same(deform(*as_mesh("field.vti")), *as_mesh("other.vti"), "--mesh-space", "lps",
               source="in.nii.gz")


def check_files_that_say_their_space():
    """Checks that the world in a file takes precedence over the option, with a warning if the two differ."""
    expected = deform(*as_mesh("mesh.vtu"))
    for name in ("slicer.vtu", "slicer.vtk", "mixed.pvd"):
        check_same(expected, *as_mesh(name), source="in.nii.gz")
    for name in ("slicer.vtu", "slicer.vtk"):
        check_same(expected, *as_mesh(name), "--mesh-space", "lps", source="in.nii.gz")
        check_same(expected, *as_mesh(name), "--mesh-space", "ras", source="in.nii.gz",
                   expected_warnings=[f"--mesh-space ras is not used: {path(name)} states that "
                                      "it is lps"])
    check_same(expected, *as_mesh("strange.vtu"), source="in.nii.gz",
               expected_warnings=['is "scanner", which is neither LPS nor RAS'])
    # A volume whose file does not state its world.
    fails(1, ["--mesh-space lps", "does not state"], *as_mesh("mesh.vtu"), "--mesh-space", "lps")
    write(vtkXMLUnstructuredGridWriter(), state_space(make_unstructured(places, moves), "LPS"),
          path("stated.vtu"), **XML)
    check_same(expected, *as_mesh("stated.vtu"),
               expected_warnings=["stated.vtu is lps. This is not used"])
    # Wrong usage.
    fails(2, "--mesh-space", *as_mesh("mesh.vtu"), "--mesh-space", "LAS")
    fails(2, "--mesh-space requires --mesh or --cut", "--carve", "sphere:9,20,25,5", "--mesh-space",
          "lps")


def check_spaces_of_sheets():
    """Checks the world of sheets in all formats, with headers and comments as 3D Slicer writes them."""
    pull = ("--model", "chainmail", "--pull", "8,20,25,-3,1,1,3")
    expected = deform("--cut", path("cut.vtp"), *pull)
    sheet = make_sheet(volume.GetBounds(), volume.GetCenter()[0] + 0.25)
    sheet.GetPointData().Initialize()
    sheet.SetPoints(to_points(FLIP * vtk_to_numpy(sheet.GetPoints().GetData())))
    triangulation = vtkTriangleFilter()
    triangulation.SetInputData(sheet)
    triangulation.Update()
    triangles = triangulation.GetOutput()
    write(vtkXMLPolyDataWriter(), sheet, path("plain.vtp"), **XML)
    write(vtkXMLPolyDataWriter(), state_space(sheet, "LPS"), path("slicer.vtp"), **XML)
    write(vtkPolyDataWriter(), sheet, path("slicer-sheet.vtk"), SetHeader=LPS_HEADER, SetFileType=2)
    write(vtkSTLWriter(), triangles, path("slicer.stl"), SetHeader=LPS_HEADER, SetFileType=2)
    write(vtkSTLWriter(), triangles, path("slicer-ascii.stl"), SetHeader=LPS_HEADER, SetFileType=1)
    write(vtkPLYWriter(), triangles, path("slicer.ply"), AddComment="SPACE=LPS", SetFileType=2)
    write(vtkOBJWriter(), triangles, path("plain.obj"))
    with open(path("plain.obj"), encoding="ascii") as plain:
        write_text("slicer.obj", "# " + LPS_HEADER + "\n" + plain.read())
    check_same(expected, "--cut", path("plain.vtp"), *pull, "--mesh-space", "lps",
               source="in.nii.gz")
    for name in ("slicer.vtp", "slicer-sheet.vtk", "slicer.stl", "slicer-ascii.stl", "slicer.ply",
                 "slicer.obj"):
        check_same(expected, "--cut", path(name), *pull, source="in.nii.gz")
    # A model is cut in the world of the volume, too.
    model = ("--model", "fem", "--lattice", "7,7,7", "--fix", "below:8", "--pull",
             "9,20,40,4,0,0,6")
    expected = deform("--cut", path("cut.vtp"), *model, source="in.nii.gz")
    check_same(expected, "--cut", path("slicer.vtp"), *model, source="in.nii.gz")


SHEETS = write_sheets()
check_misuse_of_meshes()
check_misuse_of_sheets()
check_formats_of_meshes()
check_formats_of_sheets()
convert_volume("in.nii.gz")
convert_volume("in.mhd")
check_spaces_of_meshes()
check_files_that_say_their_space()
check_spaces_of_sheets()
