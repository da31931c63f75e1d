# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume cuts, carves and pulls as the filters do, and reports errors of its tools.
Usage: TestTools.py PROGRAM FOLDER"""
import functools

import deformvolume_vtk
import Messages
import numpy
from MeshFiles import make_handles, make_sheet, to_vtk, write
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkSphere
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

program, path = begin_test("Tools")
volume = make_ball()
write_vti(volume, path("in.vti"))
bounds = volume.GetBounds()
middle = [0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]) for axis in range(3)]


def write_sheet(name, x):
    plane = make_sheet(bounds, x)
    write(vtkXMLPolyDataWriter(), plane, path(name), SetDataMode=1)
    return plane


sheet = write_sheet("sheet.vtp", middle[0] + 0.3)
cut = ("--cut", path("sheet.vtp"))
carve = ("--carve", f"sphere:{middle[0] + 4},{middle[1]},{middle[2]},5")
pull_text = f"{middle[0] - 6},{middle[1]},{middle[2]},3,1,-2,2.5"
pull = ("--model", "chainmail", "--pull", pull_text)


fails = functools.partial(Messages.refuses, program, path)

# Misuse.
fails(2, "sphere:X,Y,Z,RADIUS", "--carve", "cube:1,2,3,4")
fails(2, "radius", "--carve", "sphere:1,2,3,0")
fails(2, "--smooth-cut requires --cut", *carve, "--smooth-cut")
fails(2, "radius", "--model", "chainmail", "--pull", "1,2,3,4,5,6,-1")
fails(2, "at least one --pull", "--model", "chainmail")
fails(2, "--pull requires --model", *cut, "--pull", pull_text)
fails(2, "same radius", *pull, "--pull", "1,2,3,4,5,6,7")
fails(2, "--model", "--model", "jelly", "--pull", pull_text)
fails(2, "--carve sphere:1,2: expected sphere: and four numbers", "--carve", "sphere:1,2")
fails(2, "--pull 1,2: expected six or seven numbers", "--model", "chainmail", "--pull", "1,2")
fails(1, "no-such-device", *pull, "--device", "no-such-device")
fails(1, ["the --pull at 9,20,25 and the one at 9.2,20,25", "hold the same voxel"], "--model", "chainmail", "--pull",
      "9,20,25,1,0,0", "--pull", "9.2,20,25,0,1,0")
fails(2, "exactly one of", *pull, "--lattice", "5,5,5", "--push", "1,2,3,4,5,6,7")
fails(2, "--push", *cut, "--push", "1,2,3,4,5,6,7")


def deform(image, field=None):
    """Returns the output of vtkDeformVolumeFilter."""
    if field is None:
        field = vtkImageData()
        field.SetDimensions(2, 2, 2)
        field.SetOrigin(*(bounds[2 * axis] - 5 for axis in range(3)))
        field.SetSpacing(*(bounds[2 * axis + 1] - bounds[2 * axis] + 10 for axis in range(3)))
        field.GetPointData().AddArray(to_vtk("Displacement", numpy.zeros((8, 3), numpy.float32)))
    result = deformvolume_vtk.vtkDeformVolumeFilter()
    result.SetInputData(image)
    result.SetDeformationData(field)
    result.SetInputArrayToProcess(0, 1, 0, 0, "Displacement")
    result.SetOutputBoundsModeToVolumeBounds()
    result.SetBackgroundValue(-7)
    result.Update()
    return result.GetOutput()


def check(name, expected, *arguments):
    output, _ = call(program, path("in.vti"), *arguments, "-o", path(name), "--bounds", "volume",
                     "--background", "-7")
    made = read_vti(path(name))
    for array in ("Values", "vtkValidPointMask"):
        assert numpy.array_equal(get_values(made, array), get_values(expected, array)), array
    return output, get_values(made, "vtkValidPointMask")


# A cut alone does not move the volume.
cutter = deformvolume_vtk.vtkCutVolume()
cutter.SetInputData(volume)
cutter.SetSheetData(sheet)
cutter.Update()
output, covered = check("cut.vti", deform(cutter.GetOutput()), *cut)
assert f"{cutter.GetNumberOfSwitchedOffTetrahedra()} tetrahedra of the volume are off" in output
assert "cut and carve" in output
assert numpy.array_equal(get_values(read_vti(path("cut.vti")), "Values")[covered == 1],
                         get_values(volume)[covered == 1])

# A smooth cut alone does not change the volume at all.
smooth_cutter = deformvolume_vtk.vtkCutVolume()
smooth_cutter.SetInputData(volume)
smooth_cutter.SetSheetData(sheet)
smooth_cutter.SmoothCutOn()
smooth_cutter.Update()
assert smooth_cutter.GetNumberOfSwitchedOffTetrahedra() == 0, smooth_cutter.GetNumberOfSwitchedOffTetrahedra()
divided = smooth_cutter.GetNumberOfDividedTetrahedra()
assert divided == cutter.GetNumberOfSwitchedOffTetrahedra(), (divided, cutter.GetNumberOfSwitchedOffTetrahedra())
output, covered = check("smooth.vti", deform(smooth_cutter.GetOutput()), *cut, "--smooth-cut")
assert f"0 tetrahedra of the volume are off, {divided} divided" in output
assert covered.all()
assert numpy.array_equal(get_values(read_vti(path("smooth.vti")), "Values"), get_values(volume))

# A sphere that is carved out.
sphere = vtkSphere()
sphere.SetCenter(middle[0] + 4, middle[1], middle[2])
sphere.SetRadius(5)
carver = deformvolume_vtk.vtkCarveVolume()
carver.SetInputConnection(cutter.GetOutputPort())
carver.SetImplicitFunction(sphere)
carver.Update()
_, covered = check("carved.vti", deform(carver.GetOutput()), *cut, *carve)
assert 20 < (covered == 0).sum() < 1000, (covered == 0).sum()

# A volume that is cut, carved, and pulled by ChainMail.
handles, radius = make_handles(pull_text)
chain_mail = deformvolume_vtk.vtkChainMailDeformation()
chain_mail.SetInputConnection(carver.GetOutputPort())
chain_mail.SetHandlesData(handles)
chain_mail.SetHandleRadius(radius)
chain_mail.Update()
assert chain_mail.GetNumberOfMovedVoxels() > 50, chain_mail.GetNumberOfMovedVoxels()
output, _ = check("pulled.vti", deform(carver.GetOutput(), chain_mail.GetOutput()), *cut, *carve,
                  *pull)
assert f"{chain_mail.GetNumberOfMovedVoxels()} voxels moved" in output

# Pulls that contradict one another are a warning.
apart = [f"{middle[0] + side},{middle[1]},{middle[2]},{9 * side},0,0" for side in (-1, 1)]
Messages.warns(program, ["The --pull contradict one another", "Of 2, 1 moved less than given"], path("in.vti"),
               "--model", "chainmail", "--pull", apart[0], "--pull", apart[1], "-o", path("apart.vti"))

# Tools beside the volume do nothing, with a warning.
write_sheet("far.vtp", bounds[1] + 100)
_, errors = call(program, path("in.vti"), "--cut", path("far.vtp"), "-o", path("far.vti"))
assert "it does not cross the volume" in errors, errors
_, errors = call(program, path("in.vti"), "--carve", "sphere:500,500,500,3", "-o", path("far.vti"))
assert "it contains no part of the volume" in errors, errors

# A mesh deforms a volume that has been cut.
call(program, path("in.vti"), *cut, "--lattice", "9,9,9", "--push", "9,20,25,3,0,0,15", "-o",
     path("pushed.vti"))

# A part that is cut out moves into other tissue: voxels are hidden, among them all with the label 5.
places = numpy.array([volume.GetPoint(voxel) for voxel in range(volume.GetNumberOfPoints())])
limit = middle[0] + 0.3
moving, labels = vtkImageData(), vtkImageData()
for image in (moving, labels):
    image.CopyStructure(volume)
moving.GetPointData().SetVectors(to_vtk("Displacement", (places[:, :1] > limit) * [[-6.0, 0.0, 0.0]]))
near = (places[:, 0] > limit) & (places[:, 0] < limit + 3)
labels.GetPointData().SetScalars(to_vtk("Labels", numpy.where(near, 5, 1).astype(numpy.int32)))
write_vti(moving, path("moving.vti"))
write_vti(labels, path("labels.vti"))
_, errors = call(program, path("in.vti"), *cut, "--field", path("moving.vti"), "--label-volume", path("labels.vti"),
                 "--bounds", "volume", "--label-output", path("moved.vti"), "--fold-count", path("count.vti"))
assert "Parts of the result overlap" in errors and "all with the labels 5. --fold-count shows where" in errors, errors
hidden = int(errors.split(" voxels of the others")[0].split()[-1])
counts = get_values(read_vti(path("count.vti")))
assert counts.max() == 2 and counts.min() == 0 and (counts == 2).sum() == hidden > 2000, (counts.max(), hidden)
assert not (get_values(read_vti(path("moved.vti"))) == 5).any()
