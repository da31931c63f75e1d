# SPDX-License-Identifier: BSD-3-Clause
"""Tests cutting and carving in ParaView: by a sheet, by the functions of widgets, by a surface and by a label, with
undo and redo, hidden cells in views, and the output of Deform Volume."""

from paraview import simple

from PluginTesting import bent_lattice, check, check_silent, fetch, load_plugin, messages, wavelet


def active(proxy):
    """Returns the active tetrahedra of the output, as a list of bytes."""
    array = fetch(proxy).GetCellData().GetArray("ActiveTetrahedra")
    return bytes(array.GetValue(i) for i in range(array.GetNumberOfTuples()))


def off(mask):
    return sum(5 - bin(byte & 31).count("1") for byte in mask)


def check_cut(volume, cells):
    plane = simple.Plane()
    plane.Origin, plane.Point1, plane.Point2 = [0.5, -20, -20], [0.5, 20, -20], [0.5, -20, 20]
    cut = simple.CutVolume(Volume=volume, Sheet=plane)
    first = active(cut)
    check(off(first) == 5 * cells * cells, f"a plane cuts {off(first)}")
    count = cut.GetPropertyValue("SwitchedOffTetrahedra")
    check(count == off(first), f"{count} are reported")
    cut.SMProxy.InvokeCommand("Undo")
    check(off(active(cut)) == 0, "undo leaves a cut")
    cut.SMProxy.InvokeCommand("Redo")
    check(active(cut) == first, "redo is another cut")
    line = simple.Line(Point1=[0.5, -20, -20], Point2=[0.5, 20, -20])
    cut.Sheet = line
    cut.SweepVector = [0, 0, 40]
    check(active(cut) == first, "what a line sweeps is another cut")
    cut.ToolPositions = [-20, 0.5, -20, -20, 0.5, 20, 20, 0.5, -20, 20, 0.5, 20]
    both = active(cut)
    check(off(both) == 2 * 5 * cells * cells - 5 * cells, f"the tool cuts to {off(both)}")
    cut.SMProxy.InvokeCommand("Reset")
    check(off(active(cut)) == 0, "reset leaves a cut")
    return cut


def check_smooth_cut(volume, cells):
    plane = simple.Plane()
    plane.Origin, plane.Point1, plane.Point2 = [0.5, -20, -20], [0.5, 20, -20], [0.5, -20, 20]
    cut = simple.CutVolume(Volume=volume, Sheet=plane, SmoothCut=1)
    check(off(active(cut)) == 0, "a smooth cut switches something off")
    count = cut.GetPropertyValue("DividedTetrahedra")
    check(count == 5 * cells * cells, f"{count} tetrahedra are divided")
    deform = simple.DeformVolume(Volume=volume, Deformation=bent_lattice(volume))
    whole = deform.GetPropertyValue("CoveredVoxels") if fetch(deform) else 0
    deform.Volume = cut
    closed = deform.GetPropertyValue("CoveredVoxels") if fetch(deform) else 0
    check(0 < closed == whole, f"of {whole} voxels {closed} are left at a smooth cut that is closed")


def check_carve(volume):
    carve = simple.CarveVolume(Volume=volume)
    carve.Body = "Sphere"
    carve.Body.Center, carve.Body.Radius = [0, 0, 0], 3
    small = off(active(carve))
    carve.Body.Radius = 5
    large = off(active(carve))
    check(3 * small < large < 7 * small, f"spheres of radius 3 and 5 carve {small} and {large}")
    carve.Body.Center = [2, 0, -1]
    by_body = active(carve)
    tool = simple.CarveVolume(Volume=volume, ToolPositions=[2, 0, -1], ToolRadius=5)
    tool.Body = "Sphere"
    tool.Body.Radius = 1
    check(active(tool) == by_body, "a tool that does not move carves another sphere")
    for name in ("Box", "Cylinder", "Plane"):
        carve.Body = name
        check(off(active(carve)) > 0, f"{name} carves nothing")
    surface = simple.Sphere(Radius=5, ThetaResolution=40, PhiResolution=40)
    by_surface = active(simple.CarveVolumeWithSurface(Volume=volume, Surface=surface))
    count = off(by_surface)
    check(0.9 * large < count <= large, f"the surface carves {count}, not {large}")
    labels = simple.Calculator(Input=volume, ResultArrayName="label", Function="floor(coordsX/4)")
    labels.UpdatePipeline()
    by_label = active(simple.CarveVolumeLabel(Volume=labels, Labels="label", Label=1))
    check(off(by_label) > 0, "the label carves nothing")

    # One filter with three tools.
    one = simple.CarveVolume(Volume=labels)
    check(one.Labels == "", f"the labels are at first {one.Labels}")
    check(off(active(one)) > 0, "the body carves nothing at first")
    one.Body = "None"
    check(off(active(one)) == 0, "no body carves")
    one.Surface = surface
    check(active(one) == by_surface, "the surface carves something else")
    one.Labels, one.Surface = "label", None
    check(active(one) == by_label, "the label carves something else")
    return carve


def check_hidden(volume):
    """Checks that views and filters leave out the cells that are cut."""
    cut = simple.CutVolumeWithPlane(Volume=volume)
    middle = [list(cut.Plane.Center), list(cut.Plane.BoundingBox)]
    check(middle == [[0, 0, 0], [-10, 10] * 3], f"the plane is put to {middle}")
    cut.Plane.Center = [0, 0, 0.5]
    check(off(active(cut)) == 5 * 20 * 20, f"the plane cuts {off(active(cut))}")
    shown = simple.Threshold(
        Input=cut, Scalars=["POINTS", "RTData"], LowerThreshold=0, UpperThreshold=1000
    )

    def count_cells():
        return fetch(shown).GetNumberOfCells()

    check(count_cells() == 20 * 20 * 19, f"{count_cells()} cells are shown")
    cut.SmoothCut = 1
    check(count_cells() == 20 * 20 * 19, f"a smooth cut shows {count_cells()} cells")
    # Deform Volume leaves out some tetrahedra of these cells, and not whole cells.
    cut.Plane.Normal = [1, 0.5, 0.25]
    cut.SmoothCut = 0
    covered = []
    for is_blank in (1, 0):
        cut.BlankCells = is_blank
        deform = simple.DeformVolume(Volume=cut)
        deform.UpdatePipeline()
        covered.append(deform.GetPropertyValue("CoveredVoxels"))
    check(0 < covered[0] == covered[1] < 21**3, f"{covered} voxels are left")
    check(count_cells() == 20**3, "cells are still hidden")


def main():
    load_plugin()
    with messages() as texts:
        volume = wavelet()
        check_smooth_cut(volume, 20)
        volume.UpdatePipeline()
        check_hidden(volume)
        cut = check_cut(volume, 20)
        carve = check_carve(volume)
        carve.Volume = cut
        carve.Body = "Sphere"
        carve.Body.Center, carve.Body.Radius = [0, 0, 0], 3
        deform = simple.DeformVolume(Volume=volume, Deformation=bent_lattice(volume))
        whole = deform.GetPropertyValue("CoveredVoxels") if fetch(deform) else 0
        deform.Volume = carve
        check(fetch(deform).GetNumberOfPoints() > 0, "no output")
        check(0 < deform.GetPropertyValue("CoveredVoxels") < whole, "there is no hole")
    check_silent(texts)


main()
