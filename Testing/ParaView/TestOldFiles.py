# SPDX-License-Identifier: BSD-3-Clause
"""Tests that state files and a Python script of version 0.1 load: there is one warning for each removed setting, voxels
are the same, and a state that is saved afterwards loads without warnings. Filters that are no longer in the menu still
work. Usage: TestOldFiles.py FOLDER-OF-DATA"""

import os
import sys

from paraview import simple

from PluginTesting import (
    OUTPUT,
    arrays_of,
    check,
    check_equal_images,
    check_silent,
    deformed,
    fetch,
    load_plugin,
    messages,
    wavelet,
)

SAVED = os.path.join(OUTPUT, "TestOldFiles.pvsm")
REMOVED = {"NumberOfTimeSamples": 11, "StreamInput": 0, "WorkGroupSize": 0}
WARNINGS = [f"{name} was removed" for name in REMOVED]


def delete_sources():
    for source in reversed(list(simple.GetSources().values())):
        simple.Delete(source)


def run_script(path):
    with open(path, encoding="utf-8") as file:
        exec(compile(file.read(), path, "exec"), {"__name__": "__main__"})


def check_file(load, path, expected):
    delete_sources()
    with messages() as texts:
        load(path)
    for words in expected:
        found = [text for text in texts if words in text]
        check(len(found) == 1, f"{path}: {len(found)} messages say '{words}'")
        check(found[0].startswith("Warning: "), found[0])
    check(len(texts) == len(expected), f"{path}: " + "\n".join(texts))
    loaded = simple.FindSource("DeformVolume1")
    with messages() as texts:
        loaded.UpdatePipeline()
    check_silent(texts)
    check(loaded.Resampler == "Automatic", f"{path}: the resampler {loaded.Resampler}")
    fresh = deformed(
        simple.FindSource("Wavelet1"),
        simple.FindSource("Calculator1"),
        OutputBoundsMode="Custom Bounds",
        CustomBounds=[-6.0, 11.0, -8.0, 8.0, -8.0, 8.0],
        BackgroundValue=0,  # the default of version 0.1
    )
    expected_image = fetch(fresh)
    check(arrays_of(expected_image)["vtkValidPointMask"].sum() > 1000, "1000 voxels or fewer are covered")
    check_equal_images(fetch(loaded), expected_image, path)
    simple.Delete(fresh)
    return loaded


def load_as_before(name, now, before):
    """Saves a state, replaces the only text `now` by what an older version wrote, and loads the state. Returns the
    source of this name after an update without messages."""
    path = os.path.join(OUTPUT, f"TestOldFiles{name}.pvsm")
    simple.SaveState(path)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    check(text.count(now) == 1, f"The state does not have {now} once")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(now, before))
    delete_sources()
    with messages() as texts:
        simple.LoadState(path)
        loaded = simple.FindSource(name)
        loaded.UpdatePipeline()
    check_silent(texts)
    return loaded


def check_edits(path):
    """Tests a state with a volume that is cut by a sheet, and carved by a body, a surface and a label, each by its own
    filter."""
    delete_sources()
    with messages() as texts:
        simple.LoadState(path)
        image = fetch(simple.FindSource("CarveLabel"))
        deform = simple.FindSource("Deform")
        deform.UpdatePipeline()
    check_silent(texts)
    array = image.GetCellData().GetArray("ActiveTetrahedra")
    values = [array.GetValue(i) & 31 for i in range(array.GetNumberOfTuples())]
    off = sum(5 - bin(value).count("1") for value in values)
    check(off == 7656, f"{off} tetrahedra are off; with version 0.1 there were 7656")
    check(deform.BackgroundValue == 0.0, f"the background is {deform.BackgroundValue}")
    check(simple.FindSource("Carve").Labels == "", "a label is carved that was not chosen")


def check_elements():
    """Tests a state and a script with the former name of Finite Element Deformation."""
    delete_sources()
    lattice = simple.TetrahedralLattice(NumberOfNodes=[3, 3, 3])
    handle = simple.DeformationHandle(RestPosition=[1, 1, 1], Position=[1, 1, 2])
    simple.FiniteElementDeformation(
        registrationName="Elements", RestMesh=lattice, Handles=handle, HandleRadius=10, YoungModulus=5000
    )
    loaded = load_as_before("Elements", 'type="FiniteElementDeformation"', 'type="CorotationalDeformation"')
    check(loaded.SMProxy.GetXMLName() == "CorotationalDeformation", loaded.SMProxy.GetXMLName())
    check(loaded.YoungModulus == 5000, f"the Young modulus is {loaded.YoungModulus}")
    check(loaded.HeldNodes >= 27, f"{loaded.HeldNodes} nodes are held")
    written = simple.CorotationalDeformation(RestMesh=simple.FindSource("TetrahedralLattice1"))
    check(written.Mode == "Converged", f"the mode is {written.Mode}")


def check_plane():
    """Tests a state in which Cut Volume With Plane has the plane of ParaView."""
    delete_sources()
    volume = wavelet()
    volume.UpdatePipeline()
    cut = simple.CutVolumeWithPlane(registrationName="Cut", Volume=volume)
    cut.Plane.Center, cut.Plane.Resolution = [0, 0, 2.5], 50
    loaded = load_as_before("Cut", 'group="internal_sheets" type="CuttingPlane"',
                            'group="extended_sources" type="BoundedPlaneSource"')
    plane = loaded.Plane
    check([*plane.Center, plane.Resolution] == [0, 0, 2.5, 50], f"the plane has {plane.Center}, {plane.Resolution}")
    check(loaded.SwitchedOffTetrahedra == 5 * 20 * 20, f"{loaded.SwitchedOffTetrahedra} tetrahedra are off")


def main():
    load_plugin()
    check_plane()
    check_elements()
    check_edits(os.path.join(sys.argv[1], "State-0.1-edits.pvsm"))
    state, script = (os.path.join(sys.argv[1], name) for name in ("State-0.1.pvsm", "Script-0.1.py"))
    check_file(run_script, script, WARNINGS)
    loaded = check_file(simple.LoadState, state, WARNINGS + ["Resampler is 1"])
    for name, default in REMOVED.items():
        check(getattr(loaded, name) == default, f"{name} is {getattr(loaded, name)}")
    simple.SaveState(SAVED)
    check_file(simple.LoadState, SAVED, [])


main()
