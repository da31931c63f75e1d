# SPDX-License-Identifier: BSD-3-Clause
"""Prints the section "Measured" of README.md from the results of Testing/Benchmarks/run.sh, and draws the plot of
Documents/benchmarks.md: readme.py [FOLDER [PICTURE]]. FOLDER is build/benchmarks by default; without PICTURE
nothing is drawn."""
import pathlib
import sys

from plots import plot_bars
from results import Results, format_date
from sections import PEERS, table

POSE = "near"
OURS = f"Deform/{POSE}/2197/exact"
# Rows of the table, with their labels. The plot has further rows.
IN_TABLE = {
    OURS: "DeformVolume, mesh of 2,197 nodes",
    f"Deform/{POSE}/512000/exact": "DeformVolume, mesh of 512,000 nodes",
    f"Deform/{POSE}/reslice-affine": "vtkImageReslice, a rotation instead",
    f"Deform/{POSE}/reslice-grid": "vtkImageReslice with vtkGridTransform, inverse field given",
    f"Deform/{POSE}/reslice-grid-solved": "vtkImageReslice with vtkGridTransform, forward field given",
}
# Name of the benchmark, label in the plot, name of the benchmark that it is compared with.
ROWS = [
    (OURS, "DeformVolume, 2,197 nodes", OURS),
    (f"Deform/{POSE}/512000/exact", "DeformVolume, 512,000 nodes", OURS),
    (f"Deform/{POSE}/field/exact", "DeformVolume, dense field", OURS),
] + [(f"{'Probe' if peer == 'probe' else 'Deform'}/{POSE}/{peer}", short,
      f"Probe/{POSE}/exact" if peer == "probe" else OURS)
     for peer, (_, short) in PEERS.items()]


def measured(results):
    """Yields (name, label in the plot, milliseconds, time relative to DeformVolume in the same rounds)."""
    for name, short, ours in ROWS:
        if results.median(name):
            yield name, short, results.median(name), results.ratio(name, ours)


def section(devices, picture):
    yield "## Measured\n"
    for results in devices:
        machine = results.processors if results.is_processor else results.device
        date = format_date(results.context["date"])
        yield (f"Time of one `Update()` after the mesh has moved by up to 12 voxels. The volume has 189 x 305 x 229 "
               f"voxels (13.2 million)\nof 16 bits. Machine: {machine}; {date}.\n")
        yield table(["", "ms", "relative"],
                    [[IN_TABLE[name], milliseconds, ratio if ratio != 1 else "1"]
                     for name, _, milliseconds, ratio in measured(results) if name in IN_TABLE])
    if picture:
        bars = [(short, milliseconds, short.startswith("DeformVolume"))
                for _, short, milliseconds, _ in measured(devices[0])]
        plot_bars(picture, f"One update, 13.2 million voxels\n{devices[0].processors}", "ms", bars)
    yield "[benchmarks.md](Documents/benchmarks.md) describes what is compared, and how to measure your machine."
    if all(results.is_processor for results in devices):
        yield "GPUs: [benchmarks-gpu.md](Documents/benchmarks-gpu.md)."


if __name__ == "__main__":
    if len(sys.argv) > 3:
        sys.exit(__doc__)
    FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/benchmarks")
    RESULTS = [results for path in sorted(FOLDER.iterdir()) if path.is_dir()
               for results in [Results(path)] if results.median(OURS)]
    if not RESULTS:
        sys.exit(f"readme.py: {FOLDER} contains no results of {OURS}")
    print("\n".join(section(RESULTS, pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None)))
