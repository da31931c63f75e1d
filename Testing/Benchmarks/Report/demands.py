# SPDX-License-Identifier: BSD-3-Clause
"""The limits of time and memory that the report compares with. All ratios are medians of ratios within
rounds of one run. The volume has 189 x 305 x 229 voxels of 16 bits and the mesh 2,197 nodes unless
stated otherwise."""
import dataclasses
import typing

SLACK_IN_VOXELS = 3.9e6  # "from 4 million voxels": 160^3 is 4.1 million


@dataclasses.dataclass
class Demand:
    """A limit. value is a function of Results that returns the number that must not exceed limit, or None if it was not
    measured."""
    words: str
    limit: float
    value: typing.Callable
    unit: str = ""
    only_on: str = ""  # "cpu", "gpu", or "" for both


def _update_relative_to_affine(pose, nodes="2197"):
    return lambda r: r.ratio(f"Deform/{pose}/{nodes}/exact", f"Deform/{pose}/reslice-affine")


def _kernels_relative_to_published(pose):
    return lambda r: r.ratio(f"Published/{pose}/exact", f"Published/{pose}/published", "kernels")


def _fine_relative_to_coarse(pose):
    return lambda r: r.ratio(
        f"Nodes/{pose}/512000", f"Nodes/{pose}/2197", "kernels")


def _pose_relative_to_near(pose):
    return lambda r: r.ratio(f"Poses/{pose}", "Poses/near", "kernels")


def _spread_of_sizes(results):
    names = [name for name in results.names("Voxels/") if name.endswith("/exact")
             and (results.median(name, "voxels") or 0) > SLACK_IN_VOXELS]
    if len(names) < 2:
        return None
    by_first = [results.ratio(name, names[0], "kernels") for name in names]
    if None in by_first:
        return None
    # Time per voxel, in a unit that cancels out.
    relative = [ratio / results.median(name, "voxels") for name, ratio in zip(names, by_first)]
    return (max(relative) - min(relative)) / (max(relative) + min(relative))


def _resident_gigabytes(results):
    resident = results.median("Memory/1000x1000x1000/uchar/2197/exact", "resident_bytes")
    return None if resident is None else resident / 1e9


def _preprocessing(results):
    return results.median("Preprocess/301x370x316/512000", "preprocessing")


DEMANDS = [
    Demand("Update() relative to affine vtkImageReslice, near identity", 0.5, _update_relative_to_affine("near")),
    Demand("Update() relative to affine vtkImageReslice, general pose", 0.9, _update_relative_to_affine("general")),
    Demand("mapping and resampling relative to the published kernel, near identity", 1 / 13,
           _kernels_relative_to_published("near"), only_on="cpu"),
    Demand("mapping and resampling relative to the published kernel, near identity", 0.1,
           _kernels_relative_to_published("near"), only_on="gpu"),
    Demand("mapping and resampling relative to the published kernel, general pose", 1 / 9,
           _kernels_relative_to_published("general"), only_on="cpu"),
    Demand("mapping and resampling relative to the published kernel, general pose", 0.1,
           _kernels_relative_to_published("general"), only_on="gpu"),
    Demand("mapping and resampling, 512,000 nodes relative to 2,197, near identity", 1.2,
           _fine_relative_to_coarse("near")),
    Demand("mapping and resampling, 512,000 nodes relative to 2,197, general pose", 1.2,
           _fine_relative_to_coarse("general")),
    Demand("mapping and resampling, rotated by 45 degrees about each axis, relative to near identity", 2.5,
           _pose_relative_to_near("rotated-45")),
    Demand("mapping and resampling, scaled by 1.5, relative to near identity", 1.8,
           _pose_relative_to_near("scale-1.5")),
    Demand("mapping and resampling, a third of the volume folded over the rest, relative to near "
           "identity", 3.0, _pose_relative_to_near("folded")),
    Demand("time per voxel, from 4 million voxels to the largest volume: relative deviation from the middle",
           0.2, _spread_of_sizes),
    Demand("device memory, 512,000 nodes (links of 16 bytes per voxel)", 20.0,
           lambda r: r.median("Deform/near/512000/exact", "device_bytes_per_voxel"),
           "bytes per voxel", "cpu"),
    Demand("device memory, 2,197 nodes (runs)", 6.0,
           lambda r: r.median("Deform/near/2197/exact", "device_bytes_per_voxel"),
           "bytes per voxel", "cpu"),
    Demand("1000 x 1000 x 1000 voxels of 8 bits, 2,197 nodes: resident memory of the process", 8.0,
           _resident_gigabytes, "GB"),
    Demand("preprocessing of 301 x 370 x 316 voxels with 512,000 nodes", 3.0, _preprocessing, "s"),
    Demand("mapping and resampling after an edit that touches 5 % of the blocks, relative to a full pass, "
           "512,000 nodes", 0.15,
           lambda r: r.ratio("Incremental/local-edit", "Incremental/near", "kernels")),
    Demand("Update() after an edit that touches 5 % of the blocks, relative to a full one, 512,000 nodes", 0.15,
           lambda r: r.ratio("Incremental/local-edit", "Incremental/near")),
    Demand("mapping and resampling after such an edit on a side of the volume, relative to a full pass", 0.15,
           lambda r: r.ratio("Incremental/local-edit-at-side", "Incremental/near", "kernels")),
    Demand("Update() after such an edit on a side of the volume, relative to a full one", 0.15,
           lambda r: r.ratio("Incremental/local-edit-at-side", "Incremental/near")),
    Demand("Update() after 2,000 tetrahedra got 1,000 new nodes and masks changed in 2 x 30 x 30 "
           "cells, both logged, relative to a full one, 512,000 nodes", 0.15,
           lambda r: r.ratio("Live/split-and-masks-logged", "Live/all-move")),
    Demand("Update() after nodes moved in 14 of 285 bricks, not logged", 4.0,
           lambda r: r.median("Live/few-move"), "ms"),
    Demand("Update() relative to its mapping and resampling, 512,000 nodes that all move", 1.04,
           lambda r: r.ratio_to_counter("Given/same-grid", "kernels")),
    Demand("Update() with another grid that shares its arrays, minus that with the same grid, 512,000 "
           "nodes", 3.0, lambda r: r.difference("Given/shared-arrays", "Given/same-grid"), "ms"),
    Demand("Update() with a deformed mesh, modified, and one at rest, minus that with the same grid, "
           "512,000 nodes", 12.0, lambda r: r.difference("Given/two-meshes", "Given/same-grid"),
           "ms"),
    Demand("Update() relative to its mapping and resampling, a displacement for each voxel", 1.25,
           lambda r: r.ratio_to_counter("Given/dense-field", "kernels")),
    Demand("a cut by a sheet of 200 triangles through 13.2 million voxels", 250.0,
           lambda r: r.median("Edit/189x305x229/sheet"), "ms"),
    Demand("a cut by a tool that touches 1 % of the bricks of 13.2 million voxels", 15.0,
           lambda r: r.median("Edit/189x305x229/tool"), "ms"),
    Demand("an update of vtkCutVolume with nothing new", 1.0,
           lambda r: r.median("Edit/189x305x229/nothing"), "ms"),
    Demand("upload of a first mask of active tetrahedra, 13 MB", 3.0,
           lambda r: r.milliseconds("Masks/active/first", "transfer"), "ms", "gpu"),
    Demand("upload of a mask of active tetrahedra, 13 MB, all of which changes", 3.0,
           lambda r: r.milliseconds("Masks/active/noise", "transfer"), "ms", "gpu"),
    Demand("a step of ChainMail that moves 100,000 of 13.2 million voxels", 20.0,
           lambda r: r.milliseconds("ChainMail/189x305x229/part", "step"), "ms"),
    Demand("a frame of ChainMail: such a step, and the volume deformed", 60.0,
           lambda r: r.median("ChainMail/189x305x229/part"), "ms"),
    Demand("a step of springs, 508,000 nodes and 2.4 million tetrahedra", 60.0,
           lambda r: r.milliseconds("Physics/springs-507584/frame", "simulation"), "ms"),
    Demand("a step of springs, 4,096 nodes", 1000.0 / 1080.0,
           lambda r: r.milliseconds("Physics/springs-4096/frame", "simulation"), "ms"),
    Demand("finite elements, a frame of 117 nodes", 2.0,
           lambda r: r.milliseconds("Physics/elements-117/frame", "simulation"), "ms"),
    Demand("finite elements, a frame of 3,193 nodes", 60.0,
           lambda r: r.milliseconds("Physics/elements-3193/frame", "simulation"), "ms"),
    Demand("finite elements, a frame of 19,307 nodes", 1000.0 / 27.6,
           lambda r: r.milliseconds("Physics/elements-19307/frame", "simulation"), "ms"),
    Demand("a mouse move in a session, ChainMail moves 50,000 of 7.1 million voxels", 100.0,
           lambda r: r.median("Session/chain-mail/drag"), "ms"),
    Demand("a mouse move in a session, finite elements of 117 nodes", 100.0,
           lambda r: r.median("Session/elements-117/drag"), "ms"),
    Demand("a mouse move in a session, finite elements of 665 nodes", 100.0,
           lambda r: r.median("Session/elements-665/drag"), "ms"),
    Demand("a cut in a session, at rest", 50.0, lambda r: r.median("Session/at-rest/cut"), "ms"),
    Demand("a cut in a session, ChainMail", 50.0, lambda r: r.median("Session/chain-mail/cut"), "ms"),
    # This is the benchmark of the volume with the most rounds.
    Demand("mapping and resampling of 13.2 million voxels, near identity", 1.0,
           lambda r: r.milliseconds("Nodes/near/2197", "kernels"), "ms", "gpu"),
    Demand("mapping and resampling of 13.2 million voxels, general pose", 1.5,
           lambda r: r.milliseconds("Nodes/general/2197", "kernels"), "ms", "gpu"),
]
