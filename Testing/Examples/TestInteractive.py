# SPDX-License-Identifier: BSD-3-Clause
"""Tests deform-interactive, in C++ and in Python: misuse, and recorded events, whose replay gives the same arrays as
the saved session.
Usage: TestInteractive.py PROGRAM SCRIPT FOLDER"""
import collections
import os
import re
import sys

import deformvolume_vtk
import numpy
from Baselines import read_picture
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from WindowEvents import WindowEvents
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkNIFTIImageWriter

program, script, path = begin_test("Interactive")

ball = make_ball(dimensions=(31, 28, 25), spacing=(1.0, 1.0, 1.0))
write_vti(ball, path("ball.vti"))

# Misuse.
for code, words, arguments in (
    (2, "--none", ["--none"]),
    (2, "b.vti", ["a.vti", "b.vti"]),
    (2, "--replay", ["--replay"]),
    (2, "--size", ["--size", "1000"]),
    (2, "--size", ["--size", "1000,10"]),
    (2, "--screenshot requires --replay", ["--screenshot", path("x.png")]),
    (2, "--record excludes --replay", ["--record", "a.log", "--replay", "b.log"]),
    (1, "no such file", [path("missing.vti"), "--replay", path("missing.log")]),
    (1, "no such file", [path("ball.vti"), "--replay", path("missing.log")]),
    (1, "is not a session file", [path("ball.vti"), "--session", path("ball.vti"), "--replay", "x.log"]),
):
    _, errors = call(program, *arguments, code=code, quiet=True)
    assert errors.startswith("deform-interactive: ") and words in errors, errors
output, _ = call(program, "--help")
assert "--screenshot" in output
output, _ = call(program, "--version")
assert re.fullmatch(r"deform-interactive \d+\.\d+\.\d+\n", output), output

# A recording without tools does not change the volume.
middle = (100, 100)
WindowEvents().keys("i").wait(2).write(path("rest.log"))


def replay(name, *arguments):
    outputs = []
    for ending in (".vti", ".xml"):
        outputs += ["--output", path(name + ending)]
    _, errors = call(program, path("ball.vti"), "--size", "200,200", "--replay", path(name + ".log"),
                     *outputs, "--screenshot", path(name + ".png"), *arguments)
    assert not errors, errors
    return read_vti(path(name + ".vti"))


rest = replay("rest")
# Text and masks before the values of a volume, or as its scalars, are not the values.
text = vtkStringArray()
text.SetName("Text")
text.SetNumberOfValues(ball.GetNumberOfPoints())
ghosts = numpy_to_vtk(numpy.zeros(ball.GetNumberOfPoints(), numpy.uint8), deep=True)
ghosts.SetName("vtkGhostType")
for first, scalars in ((text, None), (ghosts, None), (ghosts, "vtkGhostType")):
    image = vtkImageData()
    image.CopyStructure(ball)
    image.GetPointData().AddArray(first)
    write_vti(image, path("none.vti"))
    _, errors = call(program, path("none.vti"), "--replay", path("rest.log"), code=1, quiet=True)
    assert errors == f"deform-interactive: cannot use {path('none.vti')}: its voxels have no numeric array\n", errors
    image.GetPointData().AddArray(ball.GetPointData().GetScalars())
    image.GetPointData().SetActiveScalars(scalars)
    write_vti(image, path("first.vti"))
    call(program, path("first.vti"), "--size", "200,200", "--replay", path("rest.log"), "--output",
         path("first-out.vti"))
    assert numpy.array_equal(get_values(read_vti(path("first-out.vti")), "Values"), get_values(rest, "Values"))


def are_equal(one, other):
    return all(numpy.array_equal(get_values(one, name), get_values(other, name))
               for name in (None, "vtkValidPointMask"))


def load(name):
    """Returns a session of a file, after it has written its volume to loaded.vti."""
    loaded = deformvolume_vtk.vtkDeformVolumeSession()
    assert loaded.SetInputs(read_vti(path("ball.vti")))
    assert loaded.LoadSession(path(name))
    assert loaded.SaveVolume(path("loaded.vti"))
    return loaded


def count_events(name):
    with open(path(name), encoding="ascii") as file:
        return collections.Counter(re.findall('do="([A-Za-z]+)', file.read()))


assert rest.GetExtent() == (-8, 38, -8, 35, -8, 32), rest.GetExtent()
covered = get_values(rest, "vtkValidPointMask") != 0
assert numpy.array_equal(get_values(rest)[covered], get_values(ball).ravel())

# A recording with all tools, then displays and presets.
events = WindowEvents().keys("i2").wait(1).keys("g").stroke(middle, (120, 110), shift=True)
events.keys("p", (90, 90)).wait(1).keys("c").stroke((30, 95), (150, 95)).keys("v-")
events.stroke((95, 115), (108, 118)).keys("b").mouse("MouseMoveEvent", middle)
events.keys("m").stroke(middle).stroke((90, 95)).keys("d").wait(1).keys("d").wait(1).keys("d,.f")
events.turn(middle, (120, 100)).keys("fff,hh").wait(1).write(path("all.log"))
made = replay("all")
session = load("all.xml")
session.Update()
assert session.GetNumberOfActions() == 5, session.GetNumberOfActions()  # the model, a drag, a pin, a cut, a carving
assert are_equal(made, read_vti(path("loaded.vti"))) and not are_equal(made, rest)
counts = count_events("all.xml")
for name, count in (("BeginGrab", 2), ("Hold", 2), ("Cut", 1), ("Model", 1)):
    assert counts[name] == count, counts
before, after = read_picture(path("rest.png")), read_picture(path("all.png"))
assert before.shape == after.shape == (200, 200, 3), (before.shape, after.shape)
is_ball = before[..., 0] > before[..., 2] + 15
assert 0.05 < is_ball.mean() < 0.8, is_ball.mean()
assert (numpy.abs(after - before).max(axis=2) > 30).mean() > 0.02, (numpy.abs(after - before).max(axis=2) > 30).mean()

# The key s saves the volume and the session, each time under a new name. All actions of the session are undone.
WindowEvents().keys("iss").wait(1).write(path("given.log"))
os.chdir(path())
replay("given", "--session", path("all.xml"))
for number in (1, 2):
    load(f"ball-deformed-{number}.xml")
    saved = read_vti(path(f"ball-deformed-{number}.vti"))
    assert are_equal(saved, read_vti(path("loaded.vti"))) and not are_equal(saved, rest)
    for ending in ("xml", "vtu", "png"):
        is_written = os.path.exists(path(f"ball-deformed-{number}.{ending}"))
        assert is_written == (ending != "vtu"), ending  # ChainMail has no mesh
WindowEvents().keys("iz").wait(1).write(path("undone.log"))
assert are_equal(replay("undone", "--session", path("ball-deformed-2.xml")), rest)

# The viewer in Python gives the same volume for the same events.
get_values(ball)[get_values(ball) < 50] = 0
writer = vtkNIFTIImageWriter()
writer.SetInputData(ball)
writer.SetFileName(path("ball.nii"))
writer.Write()
# In the air beside the ball there is no tissue to grab.
events = WindowEvents().keys("2g").stroke((290, 190), (310, 200), shift=True).wait(1)
events.stroke((400, 300), (430, 310), shift=True).wait(1)
events.keys("c").stroke((300, 280), (500, 280)).wait(1)
events.write(path("python.log"))
call(sys.executable, script, path("ball.nii"), path("python.log"), path("python.xml"))
counts = count_events("python.xml")
for name in ("Model", "BeginGrab", "Hold", "Cut"):
    assert counts[name] == 1, counts

# The isosurface of a volume whose axes are left-handed is lit.
WindowEvents().keys("id").wait(2).write(path("surface.log"))
lit = []
for name, spacing in (("plain", 1.0), ("mirrored", -1.0)):
    ball.SetSpacing(1.0, 1.0, spacing)
    write_vti(ball, path(name + ".vti"))
    call(program, path(name + ".vti"), "--size", "200,200", "--replay", path("surface.log"),
         "--screenshot", path(name + ".png"))
    picture = read_picture(path(name + ".png")).astype(int)
    lit.append((picture[..., 0] > picture[..., 2] + 15).mean())
assert lit[0] > 0.1 and abs(lit[1] - lit[0]) < 0.02, lit
