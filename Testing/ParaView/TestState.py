# SPDX-License-Identifier: BSD-3-Clause
"""Tests that a state, saved as .pvsm and as a Python script and loaded in a new process, has the same properties and
voxels as before."""

import json
import os
import subprocess
import sys

import numpy
from paraview import simple, smstate

from PluginTesting import (
    OUTPUT,
    PLUGIN,
    arrays_of,
    bent_lattice,
    check,
    deformed,
    fetch,
    load_plugin,
    wavelet,
)

STATE = os.path.join(OUTPUT, "TestState.pvsm")
SCRIPT = os.path.join(OUTPUT, "TestStateScript.py")
EXPECTED = os.path.join(OUTPUT, "TestState")

PROPERTIES = {
    "DisplacementScale": 0.75,
    "OutsideMode": "Extrapolate",
    "OutputBoundsMode": "Custom Bounds",
    "CustomBounds": [-12.0, 13.0, -9.0, 9.0, -10.0, 11.0],
    "Padding": 1,
    "BoundsGranularity": 8,
    "OutputSpacingMode": "Custom Spacing",
    "CustomSpacing": [0.5, 1.0, 2.0],
    "SamplingFactor": "Every Second Voxel",
    "BackgroundValue": -7.5,
    "CategoricalArrays": ["RTData"],
    "Resampler": "Exact",
    "Interpolation": "Linear",
    "OpenSplits": 1,
    "Incremental": 0,
    "Device": "cpu",
    "MemoryLimit": 5e9,
}


def get_properties(filter_):
    result = {}
    for name in PROPERTIES:
        value = getattr(filter_, name)
        result[name] = value if isinstance(value, (int, float, str)) else list(value)
    result["DisplacementArray"] = list(filter_.DisplacementArray)
    return result


def check_restored(kind):
    """Checks properties and voxels in the new process."""
    filters = [
        source for source in simple.GetSources().values() if source.GetXMLName() == "DeformVolume"
    ]
    check(len(filters) == 1, f"{kind}: expected one filter, not {len(filters)}")
    filter_ = filters[0]
    with open(EXPECTED + ".json", encoding="utf-8") as file:
        expected = json.load(file)
    got = get_properties(filter_)
    for name, value in expected.items():
        check(got[name] == value, f"{kind}: {name} is {got[name]}, not {value}")
    filter_.UpdatePipeline()
    voxels = arrays_of(fetch(filter_))
    for name, values in numpy.load(EXPECTED + ".npz").items():
        check(numpy.array_equal(voxels[name], values), f"{kind}: {name} differs")
    for proxy, value in (("TetGenMesher", 250.0), ("TetrahedralLattice", 3.0)):
        made = [item for item in simple.GetSources().values() if item.GetXMLName() == proxy]
        check(len(made) == 1, f"{kind}: expected one {proxy}, not {len(made)}")
        other = made[0].Isovalue if proxy == "TetGenMesher" else made[0].Margin
        check(other == value, f"{kind}: {proxy} has the value {other}, not {value}")


def save():
    volume = wavelet(8)
    mesh = bent_lattice(volume)
    filter_ = deformed(volume, mesh, **PROPERTIES)
    # A value that ParaView's domain would not choose by default.
    check(
        get_properties(filter_)["CustomBounds"] == PROPERTIES["CustomBounds"],
        f"CustomBounds is {get_properties(filter_)['CustomBounds']}",
    )
    simple.TetGenMesher(Input=volume, AutomaticIsovalue=0, Isovalue=250.0, Labels=[1.0, 5.0])
    simple.TetrahedralLattice(Margin=3.0)
    with open(EXPECTED + ".json", "w", encoding="utf-8") as file:
        json.dump(get_properties(filter_), file)
    numpy.savez(EXPECTED + ".npz", **arrays_of(fetch(filter_)))
    simple.SaveState(STATE)
    with open(SCRIPT, "w", encoding="utf-8") as file:
        file.write(smstate.get_state())


def main():
    load_plugin()
    if len(sys.argv) > 1:
        if sys.argv[1] == "pvsm":
            simple.LoadState(STATE)
        else:
            with open(SCRIPT, encoding="utf-8") as file:
                exec(compile(file.read(), SCRIPT, "exec"), {"__name__": "__main__"})
        check_restored(sys.argv[1])
        return
    save()
    for kind in ("pvsm", "python"):
        program = [os.environ["DEFORMVOLUME_PVPYTHON"], __file__, kind]
        done = subprocess.run(program, capture_output=True, text=True, timeout=200, check=False)
        print(done.stdout, done.stderr)
        check(done.returncode == 0, f"{kind}: the new process returns {done.returncode}")
    check(os.path.basename(PLUGIN) == "DeformVolume.so", PLUGIN)


main()
