# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume replaces an older file only by a complete one: a full disk and signals leave the older file
as it was, and no temporary files. Usage: TestOutputFiles.py PROGRAM FOLDER"""
import os
import shutil
import signal
import stat
import subprocess
import time
from resource import RLIMIT_FSIZE, setrlimit

import numpy
from MeshFiles import to_vtk
from Messages import check_words
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

program, path = begin_test("OutputFiles")
outputs = path("outputs")
OLD = "the older file"


def output(name):
    return os.path.join(outputs, name)


# Noise, which compression does not make smaller. The files have to be larger than those of compilers of kernels.
volume = make_ball((128, 128, 128), (1, 1, 1), (0, 0, 0))
noise = numpy.random.default_rng(2).integers(-2**15, 2**15, 128**3).astype(numpy.int16)
volume.GetPointData().SetScalars(to_vtk("Values", noise))
write_vti(volume, path("in.vti"))
sphere = vtkSphereSource()
sphere.SetCenter(64, 64, 64)
sphere.SetRadius(40)
sphere.SetThetaResolution(400)
sphere.SetPhiResolution(400)
surface_of_triangles = vtkSTLWriter()
surface_of_triangles.SetFileTypeToBinary()
for writer, suffix in ((surface_of_triangles, ".stl"), (vtkPLYWriter(), ".ply"), (vtkXMLPolyDataWriter(), ".vtp")):
    writer.SetInputConnection(sphere.GetOutputPort())
    writer.SetFileName(path("points" + suffix))
    writer.Write()
points = numpy.random.default_rng(3).uniform(1, 120, (100000, 3))
numpy.savetxt(path("points.csv"), points, "%.15g", ",", header="x,y,z", comments="")
common = (path("in.vti"), "--lattice", "3,3,3", "--push", "64,64,64,1,0,0,1000", "--bounds", "volume", "--quiet")


def write_old(names):
    shutil.rmtree(outputs, ignore_errors=True)
    os.makedirs(outputs)
    for name in names:
        with open(output(name), "w", encoding="utf-8") as file:
            file.write(OLD)


def is_old(names):
    """Whether there are only the older files."""
    return sorted(os.listdir(outputs)) == sorted(names) and all(
        os.path.getsize(output(name)) == len(OLD) for name in names)


def check_full_disk(common_arguments, *writing):
    """Checks outputs if their files cannot be as large as they must be. The limit of the size of files takes the place
    of a full disk. As only the last byte is missing, most writers notice nothing. writing: the arguments of each
    output, with the file as the last one."""
    write_old(())
    call(program, *common_arguments, *(argument for each in writing for argument in each))
    sizes = {name: os.path.getsize(output(name)) for name in os.listdir(outputs)}
    for each in writing:
        stem = os.path.basename(each[-1]).split(".")[0]
        names = [name for name in sizes if name.split(".")[0] == stem]
        limit = max(sizes[name] for name in names) - 1
        assert limit > 3e6, (each, limit)
        write_old(names)
        result = subprocess.run([program, *common_arguments, *each], capture_output=True, text=True, timeout=240,
                                check=False, preexec_fn=lambda size=limit: setrlimit(RLIMIT_FSIZE, (size, size)))
        error = (result.stderr.splitlines() or [""])[-1]
        print(error)
        assert result.returncode == 1, (each, result.returncode)
        assert error.startswith(f"deform-volume: cannot write {each[-1]}: there is no space left"), error
        check_words(error)
        assert is_old(names), [(name, os.path.getsize(output(name))) for name in os.listdir(outputs)]


def check_signal(number, name):
    """Checks an output during whose writing a signal comes."""
    for _ in range(20):
        write_old([name])
        with subprocess.Popen([program, *common, "-o", output(name)],
                              preexec_fn=lambda: signal.signal(number, signal.SIG_DFL)) as process:
            while process.poll() is None and len(os.listdir(outputs)) == 1:
                time.sleep(0.001)
            process.send_signal(number)
        print(name, process.returncode, os.listdir(outputs))
        if process.returncode == -number and is_old([name]):
            return
        # The file may have been completed before the signal.
        assert os.listdir(outputs) == [name] and os.path.getsize(output(name)) > 3e6, os.listdir(outputs)
    raise AssertionError("the signal never came while the file was written")


def check_places():
    """Checks files that are replaced, and links to them."""
    write_old(["plain.vti", "target.vti"])
    os.chmod(output("plain.vti"), 0o640)
    os.symlink("target.vti", output("link.vti"))
    os.symlink("new.vti", output("nowhere.vti"))
    call(program, *common, "-o", output("plain.vti"), "-o", output("link.vti"), "-o", output("nowhere.vti"))
    assert sorted(os.listdir(outputs)) == ["link.vti", "new.vti", "nowhere.vti", "plain.vti", "target.vti"]
    assert os.path.islink(output("link.vti")) and os.path.islink(output("nowhere.vti"))
    assert stat.S_IMODE(os.stat(output("plain.vti")).st_mode) == 0o640
    expected = get_values(read_vti(output("plain.vti")), "Values")
    for name in ("target.vti", "new.vti"):
        numpy.testing.assert_array_equal(get_values(read_vti(output(name)), "Values"), expected)


check_places()
formats = call(program, "--help", quiet=True)[0].split("--output FILE")[1].split("(the scalars)")[0]
check_full_disk(common, *(
    ("-o", output(f"{number}{suffix}"))
    for number, suffix in enumerate((".vti", ".nii", ".nii.gz", ".mha", ".mhd", ".nrrd", ".nhdr"))
    if suffix in formats), ("--jacobian", output("jacobian.nii")), ("--inverse-field", output("field.nii")), *(
    ("--points", path("points" + suffix), "--points-output", output(f"moved-{suffix[1:]}{suffix}"))
    for suffix in (".csv", ".stl", ".ply", ".vtp")))
check_full_disk((path("in.vti"), "--lattice", "60,60,60"), ("--write-mesh", output("mesh.vtu")))
for each, suffix in ((signal.SIGINT, ".nii.gz"), (signal.SIGTERM, ".vti"), (signal.SIGHUP, ".nii.gz")):
    check_signal(each, "o" + suffix)
write_old(())
