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
    check(off(first) == 5 * cells * cells, f"a plane switches off {off(first)} tetrahedra, not {5 * cells * cells}")
    count = cut.GetPropertyValue("SwitchedOffTetrahedra")
    check(count == off(first), f"SwitchedOffTetrahedra is {count}, not {off(first)}")
    cut.SMProxy.InvokeCommand("Undo")
    check(off(active(cut)) == 0, f"after Undo {off(active(cut))} tetrahedra are switched off")
    cut.SMProxy.InvokeCommand("Redo")
    check(active(cut) == first, "after Redo the mask differs from the one before Undo")
    line = simple.Line(Point1=[0.5, -20, -20], Point2=[0.5, 20, -20])
    cut.Sheet = line
    cut.SweepVector = [0, 0, 40]
    check(active(cut) == first, "the cut by a swept line differs from the cut by a plane")
    cut.ToolPositions = [-20, 0.5, -20, -20, 0.5, 20, 20, 0.5, -20, 20, 0.5, 20]
    both = active(cut)
    check(
        off(both) == 2 * 5 * cells * cells - 5 * cells,
        f"after the cut by a tool {off(both)} tetrahedra are switched off",
    )
    cut.SMProxy.InvokeCommand("Reset")
    check(off(active(cut)) == 0, f"after Reset {off(active(cut))} tetrahedra are switched off")
    return cut


def check_smooth_cut(volume, cells):
    plane = simple.Plane()
    plane.Origin, plane.Point1, plane.Point2 = [0.5, -20, -20], [0.5, 20, -20], [0.5, -20, 20]
    cut = simple.CutVolume(Volume=volume, Sheet=plane, SmoothCut=1)
    check(off(active(cut)) == 0, f"a smooth cut switches off {off(active(cut))} tetrahedra")
    count = cut.GetPropertyValue("DividedTetrahedra")
    check(count == 5 * cells * cells, f"DividedTetrahedra is {count}, not {5 * cells * cells}")
    deform = simple.DeformVolume(Volume=volume, Deformation=bent_lattice(volume))
    whole = deform.GetPropertyValue("CoveredVoxels") if fetch(deform) else 0
    deform.Volume = cut
    closed = deform.GetPropertyValue("CoveredVoxels") if fetch(deform) else 0
    check(0 < closed == whole, f"with a closed smooth cut {closed} voxels are covered, not {whole}")


def check_carve(volume):
    carve = simple.CarveVolume(Volume=volume)
    carve.Body = "Sphere"
    carve.Body.Center, carve.Body.Radius = [0, 0, 0], 3
    small = off(active(carve))
    carve.Body.Radius = 5
    large = off(active(carve))
    check(3 * small < large < 7 * small, f"spheres of radius 3 and 5 switch off {small} and {large} tetrahedra")
    carve.Body.Center = [2, 0, -1]
    by_body = active(carve)
    tool = simple.CarveVolume(Volume=volume, ToolPositions=[2, 0, -1], ToolRadius=5)
    tool.Body = "Sphere"
    tool.Body.Radius = 1
    check(active(tool) == by_body, "a tool that does not move carves other tetrahedra than a sphere")
    for name in ("Box", "Cylinder", "Plane"):
        carve.Body = name
        check(off(active(carve)) > 0, f"{name} switches off no tetrahedra")
    surface = simple.Sphere(Radius=5, ThetaResolution=40, PhiResolution=40)
    by_surface = active(simple.CarveVolumeWithSurface(Volume=volume, Surface=surface))
    count = off(by_surface)
    check(0.9 * large < count <= large, f"the surface switches off {count} tetrahedra, the sphere {large}")
    labels = simple.Calculator(Input=volume, ResultArrayName="label", Function="floor(coordsX/4)")
    labels.UpdatePipeline()
    by_label = active(simple.CarveVolumeLabel(Volume=labels, Labels="label", Label=1))
    check(off(by_label) > 0, "the label switches off no tetrahedra")

    # One filter with three tools.
    one = simple.CarveVolume(Volume=labels)
    check(one.Labels == "", f"the default of Labels is {one.Labels}")
    check(off(active(one)) > 0, "the default body switches off no tetrahedra")
    one.Body = "None"
    check(off(active(one)) == 0, f"without a body {off(active(one))} tetrahedra are switched off")
    one.Surface = surface
    check(active(one) == by_surface, "CarveVolume and CarveVolumeWithSurface switch off other tetrahedra")
    one.Labels, one.Surface = "label", None
    check(active(one) == by_label, "CarveVolume and CarveVolumeLabel switch off other tetrahedra")
    return carve


def check_hidden(volume):
    """Checks that views and filters leave out the cells that are cut."""
    cut = simple.CutVolumeWithPlane(Volume=volume)
    middle = [list(cut.Plane.Center), list(cut.Plane.BoundingBox)]
    check(middle == [[0, 0, 0], [-10, 10] * 3], f"the default center and box of the plane are {middle}")
    cut.Plane.Center = [0, 0, 0.5]
    check(off(active(cut)) == 5 * 20 * 20, f"the plane switches off {off(active(cut))} tetrahedra")
    # The plane crosses the faces of the volume, so that a smooth cut separates its sides.
    smooth = simple.CutVolumeWithPlane(Volume=volume, SmoothCut=1)
    smooth.Plane.Center = [0, 0, 0.5]
    smooth.UpdatePipeline()
    count = smooth.GetPropertyValue("DividedTetrahedra")
    check(count == 5 * 20 * 20, f"the plane divides {count} tetrahedra")
    check(smooth.Plane.Resolution == 1, f"the plane has {smooth.Plane.Resolution} cells on each axis")
    shown = simple.Threshold(
        Input=cut, Scalars=["POINTS", "RTData"], LowerThreshold=0, UpperThreshold=1000
    )

    def count_cells():
        return fetch(shown).GetNumberOfCells()

    check(count_cells() == 20 * 20 * 19, f"{count_cells()} cells are shown, not {20 * 20 * 19}")
    cut.SmoothCut = 1
    check(count_cells() == 20 * 20 * 19, f"with a smooth cut {count_cells()} cells are shown")
    # Deform Volume leaves out some tetrahedra of these cells, and not whole cells.
    cut.Plane.Normal = [1, 0.5, 0.25]
    cut.SmoothCut = 0
    covered = []
    for is_blank in (1, 0):
        cut.BlankCells = is_blank
        deform = simple.DeformVolume(Volume=cut)
        deform.UpdatePipeline()
        covered.append(deform.GetPropertyValue("CoveredVoxels"))
    check(0 < covered[0] == covered[1] < 21**3, f"with and without BlankCells {covered} voxels are covered")
    check(count_cells() == 20**3, f"without BlankCells {count_cells()} cells are shown, not {20**3}")


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
        check(fetch(deform).GetNumberOfPoints() > 0, "the output is empty")
        check(0 < deform.GetPropertyValue("CoveredVoxels") < whole, f"the edits leave {whole} covered voxels")
    check_silent(texts)


main()
