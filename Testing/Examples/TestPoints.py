# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume moves points with the volume: SimpleITK's transforms map them back to their positions.
Usage: TestPoints.py PROGRAM FOLDER"""
import json
import os
import re

import Messages
import numpy
import Readers
from MeshFiles import state_space, to_points, to_vtk
from MeshFiles import write as write_data
from Volumes import begin_test, call, make_ball, write_vti
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE, VTK_VERTEX, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkIOGeometry import vtkSTLReader, vtkSTLWriter
from vtkmodules.vtkIOPLY import vtkPLYReader, vtkPLYWriter
from vtkmodules.vtkIOXML import (vtkXMLPolyDataReader, vtkXMLPolyDataWriter, vtkXMLUnstructuredGridReader,
                                 vtkXMLUnstructuredGridWriter)

program, path = begin_test("Points")
flip = numpy.array([-1.0, -1.0, 1.0])


def write(name, text):
    with open(path(name), "w", encoding="utf-8", newline="") as file:
        file.write(text)


def read(name):
    with open(path(name), encoding="utf-8", newline="") as file:
        return file.read()


def write_geometry(name, points, space=None, vectors=None, normals=None):
    """Writes points with a vertex cell for each. vectors, normals: values of active arrays."""
    data = vtkPolyData() if name.endswith(".vtp") else vtkUnstructuredGrid()
    data.SetPoints(to_points(numpy.array(points, dtype=float).reshape(-1, 3)))
    data.AllocateExact(len(points), 1) if name.endswith(".vtp") else data.Allocate(len(points))
    for i in range(len(points)):
        data.InsertNextCell(VTK_VERTEX, 1, [i])
    data.GetPointData().AddArray(to_vtk("number", numpy.arange(len(points))))
    for values, add, title in ((vectors, data.GetPointData().SetVectors, "velocity"),
                               (normals, data.GetPointData().SetNormals, "Normals")):
        if values is not None:
            add(to_vtk(title, values))
    if space:
        state_space(data, space)
    writer = vtkXMLPolyDataWriter() if name.endswith(".vtp") else vtkXMLUnstructuredGridWriter()
    write_data(writer, data, path(name), SetDataMode=1)


def write_surface(name, points, space=None):
    """Writes triangles of three consecutive points each. A .ply file also has colors."""
    surface = vtkPolyData()
    surface.SetPoints(to_points(numpy.array(points, dtype=numpy.float32)))
    surface.AllocateExact(len(points), 3)
    for i in range(0, len(points) - 2):
        surface.InsertNextCell(VTK_TRIANGLE, 3, [i, i + 1, i + 2])
    writer = vtkSTLWriter() if name.endswith(".stl") else vtkPLYWriter()
    writer.SetInputData(surface)
    writer.SetFileName(path(name))
    if name.endswith(".stl"):
        writer.SetHeader(f"3D Slicer output. SPACE={space}" if space else "made by a test")
        writer.SetFileTypeToBinary()
    else:
        colors = numpy.arange(3 * len(points), dtype=numpy.uint8).reshape(-1, 3)
        surface.GetPointData().AddArray(to_vtk("colors", colors))
        writer.SetArrayName("colors")
        if space:
            writer.AddComment(f"SPACE={space}")
    assert writer.Write(), name


def read_geometry(name):
    readers = {"vtp": vtkXMLPolyDataReader, "vtu": vtkXMLUnstructuredGridReader, "stl": vtkSTLReader,
               "ply": vtkPLYReader}
    reader = readers[name[-3:]]()
    reader.SetFileName(path(name))
    reader.Update()
    return reader.GetOutput()


def get_points(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def make_table(points):
    return "x,y,z\n" + "".join(",".join(map(repr, point)) + "\n" for point in numpy.asarray(points).tolist())


def read_table(name):
    return numpy.array([[float(text) for text in line.split(",")[:3]] for line in read(name).splitlines()[1:]])


def make_markups(points, space="LPS", **more):
    """Returns markups as 3D Slicer writes them, with the entries that this test needs."""
    markup = {"type": "Fiducial", "coordinateSystem": space, "coordinateUnits": "mm", "locked": False,
              "controlPoints": [{"id": str(i + 1), "label": f"F-{i + 1}",
                                 "position": point, "selected": True, "positionStatus": "defined",
                                 "orientation": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0]}
                                for i, point in enumerate(numpy.asarray(points).tolist())],
              "display": {"opacity": 0.1, "color": [0.4, 1.0, 0.30000000000000004]}}
    for name, value in more.items():
        markup[name] = value
    return {"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
                       "Schema/markups-schema-v1.0.3.json#", "markups": [markup]}


def write_markups(name, markups):
    write(name, json.dumps(markups, indent=4))


def read_markups(name):
    return numpy.array([point["position"] for markup in json.loads(read(name))["markups"]
                        for point in markup["controlPoints"]])


# Misuse.
lattice = ("--lattice", "3,3,3", "--push", "9,20,25,5,0,0,200")
write_vti(make_ball(), path("ball.vti"))
some = [[3.0, 12.0, 16.0], [9.5, 20.25, 25.0]]
write("some.csv", make_table(some))
write_geometry("some.vtp", some)


def fails(expected, points, output="no.csv", code=1, more=()):
    output = path(output)
    Messages.fails(program, code, expected, path("ball.vti"), *lattice, "--points", path(points),
                   "--points-output", output, *more)
    assert not os.path.exists(output)


for arguments, words in ((("--points", path("some.csv")), "--points-output"),
                         (("--points-output", path("no.csv")), "--points"),
                         (("--points", path("some.csv"), "--points-output", path("no.csv"), "--points-output",
                           path("no2.csv")), "--points is given 1 times and --points-output 2 times")):
    Messages.fails(program, 2, words, path("ball.vti"), *lattice, "-o", path("no.vti"), *arguments)
fails("must end in .csv, as that of", "some.csv", "no.vtp", code=2)
fails("must end in .vtp, as that of", "some.vtp", "no.stl", code=2)
fails("must end in .stl, as that of", "some.stl", "no.ply", code=2)
fails("In 3D Slicer, save the points as .mrk.json", "some.fcsv", "no.fcsv", code=2)
fails("must end in .vtp, .vtu, .stl, .ply, .csv", "some.xyz", "no.xyz", code=2)
fails("--mesh-space requires", "some.csv", code=2, more=("--mesh-space", "lps"))
Messages.fails(program, 2, "would be overwritten", path("ball.vti"), *lattice, "--points", path("some.csv"),
               "--points-output", path("some.csv"))
fails("there is no such file", "missing.csv")
fails("there is no such file", "missing.vtp", "no.vtp")
for name, text, words in (
        ("empty.csv", "", "it has no points"), ("header.csv", "x,y,z,t\n\n", "it has no points"),
        ("unnamed.csv", "1,2,3\n4,5,6\n", 'its first line is "1,2,3". It must name the columns'),
        ("order.csv", "label,x,y,z\na,1,2,3\n", 'its first line is "label,x,y,z"'),
        ("two.csv", "x,y\n1,2\n", "the first three must be x,y,z"),
        ("short.csv", "x,y,z,t\n1,2,3,0\n\n1,2,3\n", "its line 4 has 3 columns, but its first line names 4"),
        ("long.csv", "x,y,z\n1,2,3,4\n", "its line 2 has 4 columns"),
        ("nan.csv", "x,y,z\r\n1,2,3\r\n1,nan,3\r\n", 'its line 3 has "nan" as y, which is not a number'),
        ("inf.csv", "x,y,z\n1,2,1e999\n", 'its line 2 has "1e999" as z'),
        ("gap.csv", "x,y,z\n,2,3\n", 'its line 2 has "" as x'),
        ("words.csv", "x,y,z\n1.5mm,2,3\n", 'its line 2 has "1.5mm" as x')):
    write(name, text)
    fails(words, name)
for name in ("some.stl", "some.ply"):
    write_surface(name, [*some, [1.0, 2.0, 3.0]])
    with open(path(name), "rb") as file:
        content = file.read()
    with open(path("broken" + name[-4:]), "wb") as file:
        file.write(content[:-5])
    fails("cannot read", "broken" + name[-4:], "no" + name[-4:])
write("broken.vtp", read("some.vtp")[:400])
write("words.vtp", "some words")
write_geometry("grid.vtu", some)
os.replace(path("grid.vtu"), path("grid.vtp"))
write_geometry("none.vtp", [])
write_geometry("nan.vtp", [*some, [1, numpy.nan, 2]])
for name, words in (("broken.vtp", "damaged or cut off"), ("words.vtp", "it is not a valid XML file"),
                    ("grid.vtp", "it does not hold polygonal data"), ("none.vtp", "it has no points"),
                    ("nan.vtp", "its point 2, counted from 0, is 1, nan, 2")):
    fails(words, name, "no.vtp")
good = make_markups(some)
point = good["markups"][0]["controlPoints"][0]
for name, markups, words in (
        ("none", {"markups": []}, "it has no points"),
        ("list", [1], 'it has no list of "markups"'),
        ("number", {"markups": [3]}, "the markup in its line 3 is not an object"),
        ("world", make_markups(some, "IJK"), 'the coordinateSystem in its line 6 is "IJK", which is neither LPS nor RAS'),
        ("units", make_markups(some, coordinateUnits=["um", "UCUM", "micrometer"]), "are not mm"),
        ("mixed", {"markups": good["markups"] + make_markups(some, "RAS")["markups"]}, "some of its markups are LPS"),
        ("object", make_markups(some, controlPoints={}), "it has no points"),
        ("words", make_markups(some, controlPoints="F"), "are not a list"),
        ("text", make_markups(some, controlPoints=["F"]), "is not an object"),
        ("flat", make_markups(some, controlPoints=[{**point, "position": [1.0, 2.0]}]),
         "has no position of three numbers"),
        ("letter", make_markups(some, controlPoints=[{**point, "position": [1.0, "a", 2.0]}]),
         "the control point in its line 10 has no position of three numbers")):
    write_markups(name + ".mrk.json", markups)
    if name == "object":
        write(name + ".mrk.json", read(name + ".mrk.json").replace("{}", "[]"))
    fails(words, name + ".mrk.json", "no.mrk.json")
whole = json.dumps(good, indent=4)
for name, text, words in (("cut", whole[:300], "damaged or cut off (Line"),
                          ("twice", '{"markups": [],\n"markups": []}', "(Line 2"),
                          ("nan", whole.replace("12.0", "NaN", 1), "damaged or cut off (Line"),
                          ("deep", "[" * 5000, "it is nested too deeply"), ("two", whole + whole, "(Line"),
                          ("void", "", "damaged or cut off")):
    write(name + ".mrk.json", text)
    fails(words, name + ".mrk.json", "no.mrk.json")


def move(volume, options, pairs, warnings=()):
    """Moves files of points, written under the same name with "moved-" before it. Returns the errors."""
    arguments = []
    for name in pairs:
        arguments += ["--points", path(name), "--points-output", path("moved-" + name)]
    _, errors = call(program, path(volume), *options, *arguments, "-q")
    assert errors.count("warning:") == len(warnings), errors
    for warning in warnings:
        assert warning in errors, f"{warning} is not in {errors}"
    Messages.check_words(errors)


# Only coordinates change, and numbers are written such that reading them gives the same double. Points outside the
# deformation do not change, character by character.
table = ('\ufeffX,"y", z,t,label,"a, b"\r\n0.1,0.30000000000000004,-0.0,0,7,"some, ""words"""\r\n\r\n'
         '"1e3", 2.50 ,"-1.2345678901234567E15",x,,-\r\n')
write("still.csv", table)
numbers = [[0.1, 0.30000000000000004, 0.0], [1 / 3, -2e-300, 4e15]]
write_markups("still.mrk.json", make_markups(numbers, "1"))
write_geometry("still.vtp", numbers)
still = ["still.csv", "still.mrk.json", "still.vtp"]
lps = ["still.csv is lps. This is not used", "still.mrk.json is lps. This is not used"]
move("ball.vti", ("--carve", "sphere:9,20,25,3"), still, lps)
assert read("moved-still.csv") == table.replace("-0.0", "0").replace("1e3", "1000").replace("2.50", "2.5").replace(
    "-1.2345678901234567E15", "-1234567890123456.8")
assert (read_markups("moved-still.mrk.json") == numbers).all()
assert (get_points(read_geometry("moved-still.vtp")) == numbers).all()
move("ball.vti", lattice, still,
     [*lps, *(f"2 of 2 points of {path(name)} lie outside the deformation" for name in still)])
for name in still[:2]:
    assert read("moved-" + name) == read(name), name
moved = read_geometry("moved-still.vtp")
assert vtk_to_numpy(moved.GetPointData().GetArray("vtkValidPointMask")).tolist() == [0, 0]
assert vtk_to_numpy(moved.GetPointData().GetArray("number")).tolist() == [0, 1] and moved.GetNumberOfCells() == 2

# Everything except positions stays the same in markups. Points without a position stay the same, too.
undefined = [{**point, "positionStatus": status, "position": ""} for status in ("undefined", "missing", "preview")]
mixed = make_markups(some, "0")
mixed["markups"][0]["controlPoints"][1:1] = undefined
mixed["markups"] += make_markups(numbers[:1], "RAS", type="ROI", size=[1, 2, 3])["markups"]
write_markups("mixed.mrk.json", mixed)
move("ball.vti", (*lattice, "--volume-space", "ras"), ["mixed.mrk.json"],
     ["a markup of the type ROI", "1 of 3 points"])
result = json.loads(read("moved-mixed.mrk.json"))
ends = [result["markups"][0]["controlPoints"][i] for i in (0, -1)]
assert all(numpy.linalg.norm(numpy.subtract(end["position"], start)) > 1 for end, start in zip(ends, some)), ends
for end, start in zip(ends, some):
    end["position"] = start
assert list(result) == list(mixed) and result == mixed
assert read("moved-mixed.mrk.json").count("\n") == read("mixed.mrk.json").count("\n")

# Transforms of SimpleITK map the moved points back, in all formats and worlds.
Readers.run("Maps.py", "make", path())
Readers.run("Points.py", "make", path())
x, y, z = numpy.meshgrid(*(numpy.linspace(-0.5, 0.5, n) for n in (5, 4, 3)), indexing="ij")
steps = numpy.stack([x.ravel() * 14, y.ravel() * 15, z.ravel() * 16], axis=1) + 0.123456789


def get_middle():
    """Returns the center of the volumes in LPS."""
    call(program, path("moving.mha"), *Readers.still, "-o", path("moving.vti"))
    image = Readers.read_vti(path("moving.vti"))
    return Readers.get_matrix(image) @ [*((n - 1) / 2 for n in image.GetDimensions()), 1]


start = get_middle()[:3] + steps
numpy.save(path("start.npy"), start)
outside = start[:1] + [500.0, 0, 0]
write("landmarks.csv", make_table([*start, *outside]))
for space, factor in (("LPS", 1), ("RAS", flip)):
    write_markups(f"{space}.mrk.json", make_markups(start * factor, space))
    write_geometry(f"{space}.vtp", start * factor, space)
    write_geometry(f"{space}.vtu", start * factor)
for volume, of_volume in (("moving.nii.gz", "RAS"), ("moving.mha", "LPS"), ("moving.nrrd", "LPS")):
    other = "LPS" if of_volume == "RAS" else "RAS"
    names = ["landmarks.csv", "LPS.mrk.json", "RAS.mrk.json", "LPS.vtp", "RAS.vtp", of_volume + ".vtu"]
    for transform, reference in (("affine.tfm", "fixed.mha"), ("both.h5", "fixed.mha"), ("spline.h5", "fine.nii.gz")):
        options = ("--transform", path(transform), "--reference", path(reference))
        move(volume, options, names, ["1 of 61 points"])
        move(volume, (*options, "--mesh-space", other.lower()), [other + ".vtu"])
        ends = []
        for name in [*names, other + ".vtu"]:
            if name.endswith(".csv"):
                read_ends = read_table("moved-" + name)
                assert (read_ends[-1:] == outside).all()
                read_ends = read_ends[:-1]
            elif name.endswith(".json"):
                read_ends = read_markups("moved-" + name)
            else:
                data = read_geometry("moved-" + name)
                read_ends = get_points(data)
                assert vtk_to_numpy(data.GetPointData().GetArray("vtkValidPointMask")).all()
                assert data.GetFieldData().HasArray("SPACE") == name.endswith(".vtp")
            ends.append(read_ends * (flip if name.startswith("RAS") else 1))
        numpy.save(path("starts.npy"), numpy.concatenate([start] * len(ends)))
        numpy.save(path("ends.npy"), numpy.concatenate(ends))
        Readers.run("Points.py", "check", path(), transform, "starts.npy", "ends.npy")

# Surfaces: with a comment that states their world, or in that of the volume. The output has the same triangles, colors
# and comment, in single precision.
for volume, of_volume in (("moving.nii.gz", flip), ("moving.mha", 1)):
    ends = []
    for suffix in (".stl", ".ply"):
        for name, space, factor in (("RAS", "RAS", flip), ("LPS", "LPS", 1), ("none", None, of_volume)):
            write_surface(name + suffix, start * factor, space)
            move(volume, ("--transform", path("affine.tfm"), "--reference", path("fixed.mha")), [name + suffix])
            before = read_geometry(name + suffix)
            after = read_geometry("moved-" + name + suffix)
            assert (vtk_to_numpy(before.GetPolys().GetData()) == vtk_to_numpy(after.GetPolys().GetData())).all()
            with open(path("moved-" + name + suffix), "rb") as file:
                assert (f"SPACE={space}".encode() in file.read()) == (space is not None), name + suffix
            if suffix == ".ply":
                colors = [vtk_to_numpy(data.GetPointData().GetArray("RGB")) for data in (before, after)]
                assert (colors[0] == colors[1]).all() and len(colors[0]) == len(start)
            ends.append(get_points(after) * factor)
    for end in ends:
        numpy.save(path("starts.npy"), start)
        numpy.save(path("ends.npy"), end)
        Readers.run("Points.py", "check", path(), "affine.tfm", "starts.npy", "ends.npy")

# Vectors are multiplied by the inverse of the transform's matrix, and normals by its transpose.
parameters = re.findall(r"^Parameters: (.*)", read("affine.tfm"), re.M)[0].split()
matrix = numpy.array(parameters[:9], dtype=float).reshape(3, 3)
random = numpy.random.default_rng(3)
vectors = random.normal(size=start.shape)
normals = vectors[::-1] / numpy.linalg.norm(vectors[::-1], axis=1, keepdims=True)
expected = normals @ matrix
for space, factor in (("LPS", 1), ("RAS", flip)):
    write_geometry("turned.vtp", start * factor, space, vectors * factor, normals * factor)
    for volume in ("moving.nii.gz", "moving.mha"):
        move(volume, ("--transform", path("affine.tfm"), "--reference", path("fixed.mha")), ["turned.vtp"])
        arrays = read_geometry("moved-turned.vtp").GetPointData()
        assert numpy.abs(vtk_to_numpy(arrays.GetVectors()) * factor - vectors @ numpy.linalg.inv(matrix).T).max() < 1e-4
        assert numpy.abs(vtk_to_numpy(arrays.GetNormals()) * factor
                         - expected / numpy.linalg.norm(expected, axis=1, keepdims=True)).max() < 1e-4

# A forward field moves points to the same positions as SimpleITK does.
def save_ends(*options, warnings=()):
    move("moving.nii.gz", options, ["landmarks.csv"], ["1 of 61 points", *warnings])
    numpy.save(path("end.npy"), read_table("moved-landmarks.csv")[:-1])


save_ends("--field", path("forward.mha"))
Readers.run("Points.py", "field", path(), "forward.mha", "end.npy", "start.npy", "0.001")
# The inverse field that deform-volume writes maps moved points back. Its vectors are rounded to 1/512 voxel on each
# axis. Between voxels it is exact because the deformation is linear.
save_ends("--field", path("linear.mha"), "--inverse-field", path("inverse.mha"),
          warnings=["The inverse field is 0 at"])
Readers.run("Points.py", "field", path(), "inverse.mha", "start.npy", "end.npy", "0.006")

# Points follow the mesh of a lattice or a simulation: displacements of points at the centroids of tetrahedra are
# interpolated between those of the nodes.
def check_middles(name, options):
    mesh = read_geometry("mesh.vtu")
    size = mesh.GetCell(0).GetNumberOfPoints()
    cells = vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, size)
    nodes = get_points(mesh)
    # The shape functions at the centroid of tetrahedra of four and of ten nodes.
    weights = numpy.array([0.25] * 4 if size == 4 else [-0.125] * 4 + [0.25] * 6)[:, None]
    middles = (weights * nodes[cells]).sum(axis=1)
    ends = (weights * (nodes + vtk_to_numpy(mesh.GetPointData().GetArray("Displacement")))[cells]).sum(axis=1)
    assert numpy.abs(ends - middles).max() > 0.5, numpy.abs(ends - middles).max()
    write("middles.csv", make_table(middles))
    move("moving.mha", options, ["middles.csv"])
    assert numpy.abs(read_table("moved-middles.csv") - ends).max() < 1e-5, name
    return len(nodes)


middle = get_middle()[:3]
place = ",".join(map(str, middle))
write("sheet.obj", "".join("v {} {} {}\n".format(*(middle + [0.3, y, z])) for y, z in
                           ((0, -60), (60, -60), (60, 60), (0, 60))) + "f 1 2 3 4\n")
model = ("--model", "fem", "--fix", "below:5", "--pull", place + ",3,0,2")
numbers = []
for name, options in (("fem", model), ("cut", (*model, "--cut", path("sheet.obj"))),
                      ("push", ("--push", place + ",4,3,-2,100"))):
    options = ("--lattice", "6,6,6", *options)
    call(program, path("moving.mha"), *options, "--write-mesh", path("mesh.vtu"), "-o", path("moved.vti"), "-q")
    numbers.append(check_middles(name, options))
assert numbers[1] > numbers[0] > numbers[2], numbers
check_middles("mesh", ("--mesh", path("mesh.vtu"), "--displacement", "Displacement"))
# With --keep no point is outside, and points far from the mesh do not move.
move("moving.mha", ("--mesh", path("mesh.vtu"), "--displacement", "Displacement", "--keep", "5"), ["landmarks.csv"])
assert (read_table("moved-landmarks.csv")[-1:] == outside).all()

# With ChainMail the displacement of the pulled voxel is that of the pull.
voxel = Readers.get_matrix(Readers.read_vti(path("moving.vti"))) @ [20, 18, 16, 1]
write("voxel.csv", make_table([voxel[:3]]))
move("moving.mha", ("--model", "chainmail", "--pull", ",".join(map(str, voxel[:3])) + ",3,0,2"), ["voxel.csv"])
assert numpy.abs(read_table("moved-voxel.csv") - voxel[:3] - [3, 0, 2]).max() < 1e-5
