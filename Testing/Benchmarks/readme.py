# SPDX-License-Identifier: BSD-3-Clause
"""Prints the section "Measured" of README.md, from what Testing/Benchmarks/run.sh measured, and draws its
plot: readme.py [FOLDER [PICTURE]]. FOLDER is build/benchmarks by default; without PICTURE nothing is drawn."""
import pathlib
import sys

from plots import plot_bars
from results import Results
from sections import PEERS, POSES, cell, table

POSE = "near"
GPU_DOCUMENT = "Documents/benchmarks-gpu.md"
OURS = f"Deform/{POSE}/2197/exact"
# Name, what it is, what it is on the plot, what it is compared with.
ROWS = [
    (OURS, "DeformVolume, a mesh of 2,197 nodes", "DeformVolume, 2,197 nodes", OURS),
    (f"Deform/{POSE}/512000/exact", "DeformVolume, a mesh of 512,000 nodes",
     "DeformVolume, 512,000 nodes", OURS),
    (f"Deform/{POSE}/field/exact", "DeformVolume, a displacement vector for each voxel",
     "DeformVolume, dense field", OURS),
] + [(f"{'Probe' if peer == 'probe' else 'Deform'}/{POSE}/{peer}", what, short,
      f"Probe/{POSE}/exact" if peer == "probe" else OURS)
     for peer, (what, short) in PEERS.items()]


def measured(results):
    """(words, label of the plot, milliseconds, times as long as DeformVolume in the same rounds)."""
    for name, what, short, ours in ROWS:
        if results.median(name):
            yield what, short, results.median(name), results.ratio(name, ours)


def section(devices, picture):
    yield "## Measured\n"
    gpus = [results for results in devices if not results.is_processor]
    for results in devices:
        machine = results.processors if results.is_processor else results.device
        yield (f"Time of one `Update()` after the mesh has moved, {POSES[POSE]}, 189 x 305 x 229 voxels of 16 "
               f"bits (13.2 million), on {machine}:\n")
        yield table(["", "ms", "times as long"],
                    [[what, milliseconds, ratio if ratio != 1 else "1"]
                     for what, _, milliseconds, ratio in measured(results)])
    if picture:
        bars = [(short, milliseconds, short.startswith("DeformVolume"))
                for _, short, milliseconds, _ in measured(devices[0])]
        plot_bars(picture, f"One update, 13.2 million voxels\n{devices[0].processors}", "ms", bars)
        yield f"![The same as bars]({picture.as_posix()})\n"
    if gpus:
        other = ""
    elif pathlib.Path(GPU_DOCUMENT).is_file():
        other = f"[{GPU_DOCUMENT}]({GPU_DOCUMENT}) has what was measured on a GPU. "
    else:
        other = "No GPU has been measured yet. "
    yield (other + "[Documents/benchmarks.md](Documents/benchmarks.md) tells what is compared and how, and how to "
           "measure your\nmachine.")


if __name__ == "__main__":
    if len(sys.argv) > 3:
        sys.exit(__doc__)
    FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/benchmarks")
    RESULTS = [results for path in sorted(FOLDER.iterdir()) if path.is_dir()
               for results in [Results(path)] if results.median(OURS)]
    if not RESULTS:
        sys.exit(f"readme.py: {FOLDER} holds no results of {OURS}")
    print("\n".join(section(RESULTS, pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None)))
