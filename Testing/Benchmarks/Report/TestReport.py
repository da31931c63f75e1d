# SPDX-License-Identifier: BSD-3-Clause
"""Makes reports of results with missing, failed and truncated parts. The results are synthetic numbers for the
benchmarks that DeformVolumeBenchmarks lists. Usage: TestReport.py DeformVolumeBenchmarks"""
import contextlib
import io
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import gpu_peers
    import report
    import sections
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(125)

import numpy as np

COUNTERS = (
    "kernels mapping resampling transfer preprocessing voxels output_voxels device_bytes_per_voxel mapping_builds "
    "volume_uploads resident_bytes "
    "resident_bytes_per_voxel step moved simulation nodes device_bytes update bytes_per_second").split()
ROUNDS = 3
OTHER_NAMES = (
    [f"Memory/189x305x229/ushort/2197/{resampler}" for resampler in ("exact", "mesh-rasterization")]
    + [f"GpuPeer/{pose}/{peer}" for pose in sections.POSES for peer in sections.GPU_PEERS]
    + ["GpuPeer/copy/torch", "GpuPeer/copy/cupy", "Device/copy"]
    # DeformVolumeBenchmarks does not have these with ParaView's VTK.
    + [f"Session/at-rest/{event}" for event in ("drag", "cut", "carve")])
DRAWN = []


def draw_nothing(path, *_arguments):
    DRAWN.append(path)


sections.plot_bars = sections.plot_curves = draw_nothing


def list_names(program):
    lines = subprocess.run([program, "--benchmark_list_tests"], check=True, capture_output=True, text=True).stdout
    return list(dict.fromkeys(line.split("/iterations:")[0] for line in lines.splitlines()))


def make_runs(names):
    return [{"name": f"{name}/iterations:1/manual_time", "real_time": 10.0 + number + 100.0 * turn,
             "resampler_in_use": 2.0, **{counter: 0.01 * (1 + number + turn) for counter in COUNTERS}}
            for turn in range(ROUNDS) for number, name in enumerate(names)]


def write(folder, kind, runs, is_processor="0"):
    (folder / kind).mkdir()
    context = {"date": "2000-01-01", "device": "A device", "device_is_processor": is_processor, "driver": "1",
               "version": "OpenCL", "compute_units": "1", "vector_width": "4", "gpu_peers": "torch and cupy",
               "processors": "Some processors"}
    (folder / kind / "all.json").write_text(json.dumps({"context": context, "benchmarks": runs}))


def make_report(folder, *document):
    with contextlib.redirect_stdout(io.StringIO()) as text:
        report.main(folder, *document)
    return text.getvalue()


def report_on(runs, is_processor="0"):
    with tempfile.TemporaryDirectory() as folder:
        write(pathlib.Path(folder), "gpu", runs, is_processor)
        return make_report(pathlib.Path(folder))


def missing_sections(text):
    for line in text.splitlines():
        if line.startswith("Not measured: "):
            return set(line[len("Not measured: "):-1].split(", "))
    return set()


def check_parts(names):
    """Checks that each measurement appears in the report, and that the report lists missing sections."""
    everything = set(sections.ON_GPUS | sections.ALL)
    runs = make_runs(names)
    text = report_on(runs)
    assert not missing_sections(text), missing_sections(text)
    assert missing_sections(report_on(make_runs(["Unknown"]))) == everything
    assert not missing_sections(report_on(runs, "1"))
    for name in names:
        its_runs = [run for run in runs if run["name"].split("/iterations:")[0] == name]
        others = [run for run in runs if run not in its_runs]
        assert report_on(others) != text, f"{name} is nowhere in the report"
        # A report without the benchmarks with which this one is compared.
        report_on(its_runs)


def check_failures(names):
    runs = [{"name": name, "error_occurred": True, "error_message": "no\nmemory"} for name in names]
    text = report_on(runs)
    assert all(f"| {name} | no memory |" in text for name in names)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write(folder, "gpu", make_runs(names))
        (folder / "gpu" / "cut-off.json").write_text('{"context": {')
        assert "| cut-off.json | it is empty or cut off" in make_report(folder)


def check_ratio():
    """Checks that ratios are medians of the ratios within rounds, and not ratios of medians."""
    runs = []
    for ours, published in ((0.002, 0.010), (0.004, 0.040), (0.300, 0.300)):
        for name, time in (("Deform/near/2197/exact", ours), ("Published/near/exact", ours),
                           ("Published/near/published", published)):
            runs.append({"name": name, "real_time": 1.0, "kernels": time, "voxels": 1e6, "output_voxels": 2e6})
    runs.append({"name": "Device/copy", "real_time": 1.0, "bytes_per_second": 8e9})
    lines = report_on(runs).splitlines()
    # 8 million bytes are read and written, in 1 ms.
    assert "| near identity | 2,197 nodes | 4.00 | 1.00 | 1.00 | 4.00 | - | 1.00 |" in lines
    assert "| near identity | 4.00 | 40.0 | 0.200 |" in lines


def check_document(names):
    with tempfile.TemporaryDirectory() as folder:
        results, documents = (pathlib.Path(folder) / name for name in ("results", "documents"))
        results.mkdir()
        documents.mkdir()
        write(results, "cpu", make_runs(names), "1")
        try:
            make_report(results, documents / "gpu.md")
        except SystemExit as error:
            assert "no results of a GPU" in str(error)
        else:
            raise AssertionError("a document without a GPU was written")
        write(results, "gpu", make_runs(names))
        DRAWN.clear()
        make_report(results, documents / "gpu.md")
        text = (documents / "gpu.md").read_text()
        # The text before and after the report does not change.
        (documents / "gpu.md").write_text("Before\n" + text + "After\n")
        DRAWN.clear()
        make_report(results, documents / "gpu.md")
        assert (documents / "gpu.md").read_text() == "Before\n" + text + "After\n"
        (documents / "other.md").write_text("By hand\n")
        try:
            make_report(results, documents / "other.md")
        except SystemExit as error:
            assert "between which to write" in str(error)
        else:
            raise AssertionError("a document without the lines was overwritten")
        assert (documents / "other.md").read_text() == "By hand\n"
        assert "| cpu |" not in text and "A device" in text and "Some processors" in text
        assert DRAWN
        for path in DRAWN:
            assert path.parent == documents / "images" and f"](images/{path.name})" in text, path


def check_positions():
    """Checks that the positions of the peers are those of the inverse general pose, and near identity."""
    shape = gpu_peers.get_output_shape(27.5e6)
    assert abs(np.prod(shape) - 27.5e6) < 0.01 * 27.5e6, (abs(np.prod(shape) - 27.5e6), 0.01 * 27.5e6)
    matrix = gpu_peers.SCALE * gpu_peers.rotation((7.0, 7.0, 7.0))
    small = (5, 7, 6)
    positions = gpu_peers.make_positions("general", small, 0)
    center = 0.5 * (np.array(gpu_peers.VOLUME) - 1.0)
    for voxel in np.ndindex(small):
        moved = matrix @ (positions[(slice(None), *voxel)] - center) + 0.5 * (np.array(small) - 1.0)
        assert np.allclose(moved, voxel, atol=1e-4), voxel
    near = gpu_peers.make_positions("near", gpu_peers.VOLUME, 0)
    for axis, index in enumerate(np.indices(gpu_peers.VOLUME, np.float32, True)):
        displacement = near[axis] - index
        assert 11.0 < np.abs(displacement).max() <= gpu_peers.AMPLITUDE + 1e-4


NAMES = list(dict.fromkeys(list_names(sys.argv[1]) + OTHER_NAMES))
check_parts(NAMES)
check_failures(NAMES)
check_ratio()
check_document(NAMES)
check_positions()
