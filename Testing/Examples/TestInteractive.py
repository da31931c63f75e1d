# SPDX-License-Identifier: BSD-3-Clause
"""deform-interactive and its twin in Python: misuse, and recorded events, which give the arrays that
the saved session gives.
Usage: TestInteractive.py PROGRAM SCRIPT FOLDER"""
import os
import re
import sys

import deformvolume
import numpy
from Baselines import read_picture
from Volumes import call, get_values, make_ball, make_folder, read_vti, write_vti
from WindowEvents import WindowEvents
from vtkmodules.vtkIOImage import vtkNIFTIImageWriter

program, script = sys.argv[1:3]
folder = make_folder(sys.argv[3], "Interactive")


def path(name):
    return os.path.join(folder, name)


ball = make_ball(dimensions=(31, 28, 25), spacing=(1.0, 1.0, 1.0))
write_vti(ball, path("ball.vti"))

# Misuse.
for code, words, arguments in (
    (2, "there is no option", ["--none"]),
    (2, "more than one volume", ["a.vti", "b.vti"]),
    (2, "needs a value", ["--replay"]),
    (2, "two numbers", ["--size", "10"]),
    (2, "need --replay", ["--screenshot", path("x.png")]),
    (2, "cannot be used together", ["--record", "a.log", "--replay", "b.log"]),
    (1, "no such file", [path("missing.vti"), "--replay", path("missing.log")]),
    (1, "no such file", [path("ball.vti"), "--replay", path("missing.log")]),
    (1, "is no session", [path("ball.vti"), "--session", path("ball.vti"), "--replay", "x.log"]),
):
    _, errors = call(program, *arguments, code=code, quiet=True)
    assert errors.startswith("deform-interactive: ") and words in errors, errors
output, _ = call(program, "--help")
assert "--screenshot" in output

# Nothing happens.
size = (400, 300)
middle = (200, 150)
WindowEvents().keys("i").wait(2).write(path("rest.log"))
call(program, path("ball.vti"), "--size", "400,300", "--replay", path("rest.log"), "--output",
     path("rest.vti"), "--screenshot", path("rest.png"))
rest = read_vti(path("rest.vti"))
assert rest.GetExtent() == (-8, 38, -8, 35, -8, 32)
covered = get_values(rest, "vtkValidPointMask") != 0
assert numpy.array_equal(get_values(rest)[covered], get_values(ball).ravel())

# All tools, in all displays, with words typed; a session that is saved, undone and opened again.
events = WindowEvents().keys("i2g").stroke(middle, (240, 170), shift=True).keys("p", (190, 130))
events.wait(1).keys("c").stroke((60, 140), (300, 140)).keys("v-").stroke((190, 180), (215, 185))
events.keys("b").mouse("MouseMoveEvent", middle).keys("m").stroke(middle).stroke((180, 140))
events.keys("s" + 60 * chr(8) + path("saved.xml") + "\r").keys("zd").wait(3).keys("d").wait(3)
events.keys("d,.f").turn(middle, (250, 150)).keys("ffff").wait(1)
events.keys("o" + path("saved.xml") + "\r").wait(5).keys("oabc" + chr(27) + "hh").wait(1)
events.write(path("all.log"))
_, errors = call(program, path("ball.vti"), "--size", "400,300", "--replay", path("all.log"),
                 "--output", path("all.vti"), "--output", path("all.xml"), "--screenshot",
                 path("all.png"))
assert not errors, errors
session = deformvolume.vtkDeformVolumeSession()
assert session.SetInputs(read_vti(path("ball.vti")))
assert session.LoadSession(path("all.xml"))
assert session.SaveVolume(path("loaded.vti"))
session.Update()
assert session.GetNumberOfActions() == 5, session.GetNumberOfActions()  # model, drag, pin, cut, carving
made, loaded = read_vti(path("all.vti")), read_vti(path("loaded.vti"))
for name in (None, "vtkValidPointMask"):
    assert numpy.array_equal(get_values(made, name), get_values(loaded, name))
    assert not numpy.array_equal(get_values(made, name), get_values(rest, name))
with open(path("all.xml"), encoding="ascii") as file:
    names = re.findall('do="([A-Za-z]+)', file.read())
for name, count in (("BeginGrab", 2), ("Hold", 2), ("Cut", 1), ("Model", 1)):
    assert names.count(name) == count, (name, names)
before, after = read_picture(path("rest.png")), read_picture(path("all.png"))
assert before.shape == after.shape == (300, 400, 3)
is_ball = before[..., 0] > before[..., 2] + 15
assert 0.05 < is_ball.mean() < 0.8
assert (numpy.abs(after - before).max(axis=2) > 30).mean() > 0.02

# The same volume in Python: the style asks for the same.
writer = vtkNIFTIImageWriter()
writer.SetInputData(ball)
writer.SetFileName(path("ball.nii"))
writer.Write()
events = WindowEvents().keys("2g").stroke((400, 300), (430, 310), shift=True).wait(1)
events.keys("c").stroke((300, 280), (500, 280)).wait(1)
events.write(path("python.log"))
call(sys.executable, script, path("ball.nii"), path("python.log"), path("python.xml"))
with open(path("python.xml"), encoding="ascii") as file:
    names = re.findall('do="([A-Za-z]+)', file.read())
for name in ("Model", "BeginGrab", "Hold", "Cut"):
    assert names.count(name) == 1, (name, names)
assert names.count("MoveGrab") == 8
