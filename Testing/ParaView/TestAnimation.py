# SPDX-License-Identifier: BSD-3-Clause
"""Tests an animation of a deformation mesh with ten time steps in files. The animation builds one static mapping and
uploads the volume once, and each step has the voxels of a new filter. An Exodus file gives the same voxels as the
.pvd file, with both of ParaView's readers. A series goes on after filters downstream were deleted."""

import os

import deformvolume_vtk
import numpy
from paraview import simple
from vtkmodules.util import numpy_support
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkIOExodus import vtkExodusIIWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from PluginTesting import OUTPUT, arrays_of, check, fetch, load_plugin, wavelet

STEPS = 10


def displacements(points, time):
    """Returns the displacements of a step. They oscillate, so that each step differs from the previous one."""
    x, y, z = points.T
    amount = 3.0 * numpy.sin(2.0 * numpy.pi * time / STEPS + 0.3)
    return numpy.stack(
        [amount * y * y / 100.0, amount * numpy.sin(z / 8.0), 0.1 * amount + 0.0 * x], axis=1
    )


def write_series(image):
    """Writes a .pvd file of the lattice with its displacements at each step. Returns its name and the meshes."""
    lattice = deformvolume_vtk.vtkLatticeTetrahedraSource()
    lattice.SetInputData(image)
    lattice.SetNumberOfNodes(7, 7, 7)
    lattice.EqualSpacingOff()
    lattice.SetMargin(0.5)
    lattice.Update()
    meshes, entries = [], []
    for step in range(STEPS):
        mesh = vtkUnstructuredGrid()
        mesh.DeepCopy(lattice.GetOutput())
        points = numpy_support.vtk_to_numpy(mesh.GetPoints().GetData())
        vectors = numpy_support.numpy_to_vtk(displacements(points, step), deep=1)
        vectors.SetName("U")
        mesh.GetPointData().AddArray(vectors)
        writer = vtkXMLUnstructuredGridWriter()
        name = f"TestAnimation{step}.vtu"
        writer.SetFileName(os.path.join(OUTPUT, name))
        writer.SetInputData(mesh)
        writer.SetDataModeToBinary()  # ParaView 5.11 cannot read VTK's appended data
        writer.Write()
        entries.append(f'<DataSet timestep="{step * 0.5}" part="0" file="{name}"/>')
        meshes.append(mesh)
    path = os.path.join(OUTPUT, "TestAnimation.pvd")
    with open(path, "w", encoding="ascii") as file:
        file.write(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
            + "\n".join(entries)
            + "\n</Collection>\n</VTKFile>\n"
        )
    return path, meshes


def check_exodus(volume, series, seen):
    """Checks that an Exodus file gives the same voxels. seen: the voxels of each step."""
    path = os.path.join(OUTPUT, "TestAnimation.e")
    # ParaView's own writer cannot be used: that of ParaView 6.1 gives all steps of a series the time 0.
    writer = vtkExodusIIWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(series.GetClientSideObject().GetOutputPort())
    writer.WriteAllTimeStepsOn()
    check(writer.Write() == 1, "The Exodus file is not written")
    legacy = simple.ExodusIIReader(FileName=[path])
    legacy.PointVariables = legacy.PointVariables.Available
    for reader in (simple.IOSSReader(FileName=[path]), legacy):
        name = reader.GetXMLName()
        times = list(reader.TimestepValues)
        check(times == list(series.TimestepValues), f"{name} has the times {times}")
        reader.ApplyDisplacements = 0
        filter_ = simple.DeformVolume(Volume=volume, Deformation=reader)
        play(filter_)
        for step in (0, 7, 3):
            filter_.UpdatePipeline(0.5 * step)
            values = arrays_of(fetch(filter_))["RTData"]
            check(numpy.array_equal(values, seen[step]), f"{name}, step {step}: RTData differs")
        filter_.UpdatePipelineInformation()
        check("Static mappings made: 1\n" in filter_.Summary, f"{name}: {filter_.Summary}")
        simple.Delete(filter_)
        simple.Delete(reader)


def check_deleted_filters(volume, series, seen):
    """Saves data, and deletes a filter downstream, at each step, while the extent grows."""
    filter_ = simple.DeformVolume(Volume=volume, Deformation=series)
    for step in list(range(STEPS)) + [0]:
        filter_.UpdatePipeline(0.5 * step)
        simple.SaveData(os.path.join(OUTPUT, "TestAnimation.vti"), proxy=filter_, DataMode="Binary")
        cut = simple.Slice(Input=filter_)
        cut.UpdatePipeline(0.5 * step)
        simple.Delete(cut)
        del cut
    values = arrays_of(fetch(filter_))["RTData"]
    check(numpy.array_equal(values, seen[0]), "RTData differs after filters were deleted")
    simple.Delete(filter_)


def play(filter_):
    """Plays the animation, with two updates at each step, because the first one still requests the previous extent.
    After that the extent of the output contains all steps."""
    for step in range(STEPS):
        for _ in range(2):
            filter_.UpdatePipeline(0.5 * step)


def main():
    load_plugin()
    volume = wavelet(10)
    volume.UpdatePipeline()
    image = fetch(volume)
    path, meshes = write_series(image)
    series = simple.OpenDataFile(path)
    filter_ = simple.DeformVolume(Volume=volume, Deformation=series, Incremental=0)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.PlayMode = "Snap To TimeSteps"
    keeper = simple.GetTimeKeeper()
    times = [0.5 * step for step in range(STEPS)]
    check(list(keeper.TimestepValues) == times, f"ParaView has the times {list(keeper.TimestepValues)}, not {times}")

    play(filter_)
    seen = []
    # Play forward, and then jump back: errors must not accumulate.
    for step in list(range(STEPS)) + [2]:
        scene.AnimationTime = 0.5 * step
        filter_.UpdatePipeline(keeper.Time)
        got = fetch(filter_)
        fresh = deformvolume_vtk.vtkDeformVolumeFilter()
        fresh.SetInputData(image)
        fresh.SetDeformationData(meshes[step])
        fresh.SetInputArrayToProcess(0, 1, 0, 0, "U")
        fresh.SetBackgroundValue(filter_.BackgroundValue)
        # The extent of the animation is the same for all steps. The fresh filter gets that extent.
        fresh.SetOutputBoundsModeToCustomBounds()
        bounds = list(got.GetBounds())
        fresh.SetCustomBounds([edge + (0.25, -0.25)[i % 2] for i, edge in enumerate(bounds)])
        fresh.Update()
        check(fresh.GetOutput().GetExtent() == got.GetExtent(), f"step {step}: extents differ")
        for name, values in arrays_of(fresh.GetOutput()).items():
            check(numpy.array_equal(arrays_of(got)[name], values), f"step {step}: {name} differs")
        seen.append(arrays_of(got)["RTData"].copy())
    check(numpy.array_equal(seen[2], seen[-1]), "RTData of step 2 differs after the animation has gone back")
    different = {values.tobytes() for values in seen}
    check(len(different) == STEPS, f"{len(different)} of {STEPS} steps have different values")

    filter_.UpdatePipelineInformation()
    check("Static mappings made: 1\n" in filter_.Summary, filter_.Summary)
    check("Volumes sent: 1\n" in filter_.Summary, filter_.Summary)

    check_exodus(volume, series, seen)
    check_deleted_filters(volume, series, seen)


main()
