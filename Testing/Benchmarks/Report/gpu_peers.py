# SPDX-License-Identifier: BSD-3-Clause
"""Measures functions of other packages that resample a volume on a GPU if the inverse deformation is known.
Usage: gpu_peers.py [--cpu] FOLDER

torch.nn.functional.grid_sample and cupyx.scipy.ndimage.map_coordinates sample the volume of the
benchmarks at one position for each voxel of the output. The positions are on the GPU already, in the
form that each function needs. The output has as many voxels as that of DeformVolumeBenchmarks, whose
results are read from FOLDER. Without results it has as many voxels as the volume.

Writes FOLDER/gpu-peers.json in the form of Google Benchmark. Each peer is first compared with
scipy.ndimage.map_coordinates. A package that is not installed is left out with a message. If none is
installed, the status is 125. With --cpu torch uses the CPU, to test this program."""
import argparse
import json
import math
import pathlib
import statistics
import sys
import time

import numpy as np

from results import Results

VOLUME = (229, 305, 189)  # z, y, x: the order of the axes of all arrays here
POSES = ("near", "general")
FIELDS = 3  # sets of positions that are used in turn, so that no cache contains the next one
RUNS = 24
COPIED_BYTES = 256 << 20

# The same numbers as in Pose.cxx.
AMPLITUDE, FREQUENCY = 12.0, 0.02  # near identity
DEGREES, SCALE = 7.0, 1.03         # general pose


def make_volume(shape):
    """Returns waves along each axis, as BenchmarkCase.cxx makes them, with values of 16 bits."""
    z, y, x = (600.0 * np.sin(frequency * np.arange(n))
               for frequency, n in zip((0.05, 0.07, 0.11), shape))
    waves = 2000.0 + z[:, None, None] + y[:, None] + x
    return waves.astype(np.uint16).astype(np.float32)


def get_output_shape(voxels):
    """Returns the shape of the volume, scaled to a number of voxels."""
    factor = (voxels / math.prod(VOLUME)) ** (1.0 / 3.0)
    return tuple(round(factor * n) for n in VOLUME)


def rotation(degrees):
    """Returns the matrix of a rotation by an angle about x, y and z. Rows and columns are z, y, x."""
    matrix = np.identity(3)
    for axis, angle in enumerate(np.radians(degrees)):
        first, second = (2 - (axis + step) % 3 for step in (1, 2))
        turn = np.identity(3)
        turn[first, first] = turn[second, second] = math.cos(angle)
        turn[first, second], turn[second, first] = -math.sin(angle), math.sin(angle)
        matrix = matrix @ turn
    return matrix


def make_positions(pose, shape, field):
    """Returns the position in the volume for each voxel of the output: 3 x shape, in voxels of the volume."""
    phase = 0.01 * field
    # Voxels of the output relative to its center, axis by axis.
    z, y, x = np.ogrid[tuple(slice(0, n) for n in shape)]
    about = [axis - 0.5 * (n - 1) for axis, n in zip((z, y, x), shape)]
    center = [0.5 * (n - 1) for n in VOLUME]
    if pose == "near":
        at = [place + middle for place, middle in zip(about, center)]
        moved = [at[axis] - AMPLITUDE * np.sin(FREQUENCY * at[(axis + 2) % 3] + phase) for axis in range(3)]
    else:
        inverse = np.linalg.inv(SCALE * rotation((DEGREES + phase, DEGREES, DEGREES)))
        moved = [sum(inverse[row, axis] * about[axis] for axis in range(3)) + center[row]
                 for row in range(3)]
    positions = np.empty((3, *shape), np.float32)
    for axis in range(3):
        positions[axis] = moved[axis]
    return positions


class Torch:
    """torch.nn.functional.grid_sample, which needs positions from -1 to 1, x first."""
    name = "torch"
    cases = (("nearest", "float32"), ("linear", "float32"), ("linear", "float16"))
    mode = "grid-constant"  # scipy's name for its behavior outside the volume

    def __init__(self, on_processor):
        import torch
        self.torch = torch
        self.device = "cpu" if on_processor else "cuda"
        if not on_processor and not torch.cuda.is_available():
            raise ImportError("torch finds no GPU")
        self.version = torch.__version__
        self.machine = "the processors" if on_processor else torch.cuda.get_device_name()

    def load(self, volume, precision):
        volume = self.torch.from_numpy(volume).to(self.device)
        return volume.to(getattr(self.torch, precision))[None, None]

    def place(self, positions, shape, precision):
        positions = self.torch.from_numpy(positions).to(self.device)
        axes = [positions[axis] * (2.0 / (shape[axis] - 1)) - 1.0 for axis in (2, 1, 0)]
        return self.torch.stack(axes, -1).to(getattr(self.torch, precision))[None]

    def sample(self, volume, positions, interpolation, _output):
        return self.torch.nn.functional.grid_sample(
            volume, positions, mode={"linear": "bilinear"}.get(interpolation, interpolation),
            padding_mode="zeros", align_corners=True)

    def make_output(self, _shape):
        """Returns None: grid_sample allocates its output itself, from memory that torch keeps."""

    def make_copy(self, size):
        source = self.torch.ones(size // 4, device=self.device)
        target = self.torch.empty_like(source)
        return lambda: target.copy_(source)

    def fetch(self, samples):
        return samples[0, 0].float().cpu().numpy()

    def measure(self, call):
        """Returns the milliseconds of a call on the device."""
        if self.device == "cpu":
            begin = time.perf_counter()
            call()
            return 1e3 * (time.perf_counter() - begin)
        begin, end = (self.torch.cuda.Event(enable_timing=True) for _ in range(2))
        begin.record()
        call()
        end.record()
        end.synchronize()
        return begin.elapsed_time(end)


class Cupy:
    """cupyx.scipy.ndimage.map_coordinates, which needs positions in voxels, z first."""
    name = "cupy"
    cases = (("nearest", "float32"), ("linear", "float32"))
    mode = "constant"

    def __init__(self, on_processor):
        if on_processor:
            raise ImportError("cupy does not run on a CPU")
        import cupy
        import cupyx.scipy.ndimage
        self.cupy = cupy
        self.map_coordinates = cupyx.scipy.ndimage.map_coordinates
        if not cupy.cuda.is_available():
            raise ImportError("cupy finds no GPU")
        self.version = cupy.__version__
        name = cupy.cuda.runtime.getDeviceProperties(cupy.cuda.Device().id)["name"]
        self.machine = name.decode()

    def load(self, volume, _precision):
        return self.cupy.asarray(volume)

    def place(self, positions, _shape, _precision):
        return self.cupy.asarray(positions)

    def sample(self, volume, positions, interpolation, output):
        self.map_coordinates(volume, positions, output=output, order=int(interpolation == "linear"),
                             mode=self.mode, cval=0.0, prefilter=False)
        return output

    def make_output(self, shape):
        return self.cupy.empty(shape, self.cupy.float32)

    def make_copy(self, size):
        source = self.cupy.ones(size // 4, self.cupy.float32)
        target = self.cupy.empty_like(source)
        return lambda: self.cupy.copyto(target, source)

    def fetch(self, samples):
        return self.cupy.asnumpy(samples)

    def measure(self, call):
        begin, end = (self.cupy.cuda.Event() for _ in range(2))
        begin.record()
        call()
        end.record()
        end.synchronize()
        return self.cupy.cuda.get_elapsed_time(begin, end)


def check(peer, interpolation, precision):
    """Compares a peer with scipy, on random values between 0 and 1."""
    import scipy.ndimage
    shape, output = (11, 12, 9), (13, 17, 19)
    random = np.random.default_rng(5)
    volume = random.random(shape, np.float32)
    # Positions inside and outside. They are not near a voxel or the middle between two, where rounding would decide.
    cells = np.stack([random.integers(-2, n + 2, output) for n in shape])
    offsets = random.uniform(0.05, 0.45, cells.shape) * random.choice((-1, 1), cells.shape)
    positions = (cells + offsets).astype(np.float32)
    expected = scipy.ndimage.map_coordinates(
        volume, positions, order=int(interpolation == "linear"), mode=peer.mode, cval=0.0)
    samples = peer.fetch(peer.sample(
        peer.load(volume, precision), peer.place(positions, shape, precision), interpolation,
        peer.make_output(output)))
    if samples.shape != expected.shape:
        raise RuntimeError(f"its output has the shape {samples.shape}, not {expected.shape}")
    # The position on each axis, which is at most the number of voxels, is rounded a few times. Values of neighboring
    # voxels differ by less than 1.
    tolerance = (8 * max(shape) + 8) * float(np.finfo(precision).eps)
    difference = float(np.abs(samples - expected).max())
    if not difference <= tolerance:
        raise RuntimeError(f"it differs from scipy.ndimage.map_coordinates by {difference:.3g}, "
                           f"more than {tolerance:.3g}")
    return difference


def measure(peer, calls):
    """Returns the milliseconds of each call. A call before each measured one keeps the device busy until the host has
    prepared the measured one."""
    for call in calls:
        call()
    times = []
    for run in range(RUNS):
        calls[(run - 1) % len(calls)]()
        times.append(peer.measure(calls[run % len(calls)]))
    return times


class Writer:
    """Collects the runs in the form of Google Benchmark."""

    def __init__(self):
        self.runs = []
        self.failed = False

    def add(self, name, times, make_counters):
        for milliseconds in times:
            self.runs.append({"name": f"{name}/iterations:1/manual_time", "run_type": "iteration",
                              "iterations": 1, "real_time": milliseconds, "time_unit": "ms",
                              **make_counters(1e-3 * milliseconds)})
        print(f"{name}: {statistics.median(times):.4g} ms", flush=True)

    def fail(self, name, error):
        self.failed = True
        message = f"{type(error).__name__}: {error}"
        self.runs.append({"name": f"{name}/iterations:1/manual_time", "run_type": "iteration",
                          "error_occurred": True, "error_message": message})
        print(f"gpu_peers.py: {name}: {message}", file=sys.stderr, flush=True)


def measure_copy(peer, writer):
    name = f"GpuPeer/copy/{peer.name}"
    try:
        times = measure(peer, [peer.make_copy(COPIED_BYTES)])
        writer.add(name, times, lambda seconds: {"bytes_per_second": 2.0 * COPIED_BYTES / seconds})
    except Exception as error:  # whatever a library throws
        writer.fail(name, error)


def measure_case(peer, pose, case, fields, writer):
    """Measures a peer in a case. fields: sets of positions, which are used in turn."""
    name = f"GpuPeer/{pose}/{peer.name}/{'/'.join(case)}"
    interpolation, precision = case
    shape = fields[0].shape[1:]
    try:
        difference = check(peer, *case)
        print(f"{name}: differs from scipy by at most {difference:.2g}", flush=True)
        volume = peer.load(make_volume(VOLUME), precision)
        placed = [peer.place(field, VOLUME, precision) for field in fields]
        output = peer.make_output(shape)
        times = measure(peer, [
            lambda positions=positions: peer.sample(volume, positions, interpolation, output)
            for positions in placed])
        # The least number of bytes: the volume and the positions are read once, and the output is written once.
        size = np.dtype(precision).itemsize
        moved = size * (math.prod(VOLUME) + 4 * math.prod(shape))
        writer.add(name, times, lambda seconds: {
            "output_voxels": math.prod(shape), "bytes_per_second": moved / seconds})
    except Exception as error:  # whatever a library throws
        writer.fail(name, error)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--cpu", action="store_true", help="run torch on the CPU, to test this program")
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER")
    options = parser.parse_args()
    if not options.folder.is_dir():
        parser.error(f"{options.folder} is not a folder")
    writer = Writer()
    peers = []
    for kind in (Torch, Cupy):
        try:
            peers.append(kind(options.cpu))
        except ImportError as error:
            print(f"gpu_peers.py: {kind.name} is left out: {error}", file=sys.stderr)
        except Exception as error:  # whatever a library throws
            writer.fail(f"GpuPeer/{kind.name}", error)
    if not peers and not writer.failed:
        return 125
    results = Results(options.folder)
    for peer in peers:
        measure_copy(peer, writer)
    for pose in POSES:
        voxels = results.median(f"Deform/{pose}/2197/exact", "output_voxels")
        shape = get_output_shape(voxels or math.prod(VOLUME))
        fields = [make_positions(pose, shape, field) for field in range(FIELDS)]
        for peer in peers:
            for case in peer.cases:
                measure_case(peer, pose, case, fields, writer)
    words = ", ".join(f"{peer.name} {peer.version} on {peer.machine}" for peer in peers)
    with open(options.folder / "gpu-peers.json", "w", encoding="utf-8") as file:
        json.dump({"context": {"gpu_peers": words}, "benchmarks": writer.runs}, file, indent=2)
    return int(writer.failed)


if __name__ == "__main__":
    sys.exit(main())
