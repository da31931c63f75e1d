# SPDX-License-Identifier: BSD-3-Clause
"""The sections of the report on one device. Each function yields Markdown, or nothing if nothing was
measured, and may draw plots (Pictures)."""
from plots import STYLES, plot_bars, plot_curves

# Times in milliseconds that the authors of the method measured on a Radeon R9 270X: Rodriguez, Leon, Martin and
# Otaduy, "A parallel resampling method for interactive deformation of volumetric models". Frames: a step of ChainMail,
# mapping, resampling, and a whole frame. Edits: upper limits.
PAPER_FRAMES = {"150x242x182": (None, None, None, 16.0), "189x305x229": (11.0, 0.5, 23.5, 35.0)}
# Simulation, mapping and resampling of a mass-spring network of 2.5 million tetrahedra.
PAPER_SPRINGS = (19.0, 5.3, 21.4)
PAPER_CUT = 21.0
PAPER_CARVING = 8.0

# Frames a second that SOFA's developers measured on the CPU of a laptop, rendering included:
# springs of 4,000 nodes, and tetrahedral elements of 19,456.
SOFA_RATES = {"springs-4096": 108.0, "elements-19307": 9.2}

# 6.6 and 13.2 million voxels.
INTERACTIVE_SIZES = tuple(PAPER_FRAMES)

POSES = {"near": "near identity", "general": "general pose"}
# Labels in tables and in plots.
PEERS = {
    "reslice-affine": ("vtkImageReslice, affine (it rotates instead)", "reslice, affine"),
    "reslice-grid": ("vtkImageReslice, vtkGridTransform, inverse field given",
                     "reslice, inverse field given"),
    "reslice-grid-solved": ("vtkImageReslice, vtkGridTransform, forward field given and inverted",
                            "reslice, field inverted"),
    "probe": ("vtkProbeFilter of the mesh, then of the volume", "probe chain"),
}


# Peers on the GPU. They need the inverse deformation.
GPU_PEERS = {
    "torch/nearest/float32": "torch, grid_sample, nearest",
    "torch/linear/float32": "torch, grid_sample, bilinear",
    "torch/linear/float16": "torch, grid_sample, bilinear, half",
    "cupy/nearest/float32": "cupy, map_coordinates, order 0",
    "cupy/linear/float32": "cupy, map_coordinates, order 1",
}
# Labels of deformations, by the names of results.
DEFORMATIONS = {"2197/exact": "2,197 nodes", "512000/exact": "512,000 nodes", "field/exact": "dense field",
                "inverse/automatic": "inverse field"}


def cell(value, digits=1):
    """Formats a number of a table with `digits` significant digits, and with all digits before the point."""
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    if value == 0:
        return "0"
    magnitude = len(str(int(abs(value))))
    return f"{value:.{max(digits - magnitude, 0)}f}" if abs(value) >= 1 else f"{value:.{digits}f}"


def _count(value):
    return None if value is None else f"{value:,.0f}"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---" * len(header) + "|"]
    lines += ["| " + " | ".join(cell(value, 3) for value in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def device(results, _pictures, _kind):
    rate = results.median("Device/copy", "bytes_per_second")
    if not rate:
        return
    voxels = 189 * 305 * 229
    yield "## Memory bandwidth\n"
    yield (f"A kernel that copies 256 MiB reads and writes {rate / 1e9:.1f} GB/s together. For "
           "189 x 305 x 229 voxels of 16 bits, reading the volume and writing the result and its "
           f"mask (5 bytes per voxel) takes {5e3 * voxels / rate:.2f} ms at that rate, and "
           f"{21e3 * voxels / rate:.2f} ms with links of 16 bytes per voxel. No resampling can be faster.\n")


def _least_milliseconds(results, name):
    """Returns the time in which the device copies as many bytes as a resampling must read and write: the volume, the
    result and its mask."""
    rate = results.median("Device/copy", "bytes_per_second")
    voxels, output = (results.median(name, key) for key in ("voxels", "output_voxels"))
    return 1e3 * (2.0 * voxels + 3.0 * output) / rate if rate and voxels and output else None


def gpu(results, _pictures, _kind):
    rows = []
    for pose, words in POSES.items():
        for deformation, what in DEFORMATIONS.items():
            name = f"Deform/{pose}/{deformation}"
            time = results.milliseconds(name, "kernels")
            if not time:
                continue
            least = _least_milliseconds(results, name)
            rows.append([words, what, time, results.ratio(name, f"Deform/{pose}/2197/exact", "kernels"),
                         least, least and time / least, results.milliseconds(name, "transfer"),
                         results.median(name)])
    if rows:
        yield "## GPU: mapping and resampling of 189 x 305 x 229 voxels of 16 bits\n"
        yield ("The copy moves the bytes that any resampling has to read and write: the volume once, the result and "
               "its mask once.\n")
        yield table(["pose", "deformation", "mapping + resampling, ms", "relative to 2,197 nodes",
                     "copy, ms", "relative to the copy", "transfer, ms", "Update(), ms"], rows)


def gpu_peers(results, pictures, kind):
    if not any(results.median(name) for name in results.names("GpuPeer/")):
        return
    yield "## Peers on the GPU\n"
    copies = [f"{name.split('/')[-1]} {1e-9 * rate:,.0f} GB/s" for name in results.names("GpuPeer/copy/")
              for rate in [results.median(name, "bytes_per_second")] if rate]
    yield (f"Measured with {results.context['gpu_peers']}. The peers get the inverse deformation: a position for each "
           "voxel of the output, which is on the GPU already. They read and write values of 32 bits, and no mask. "
           "With \"half\", values and positions have 16 bits, so a position is wrong by a tenth of a voxel or more. "
           "DeformVolume gets the forward deformation (except with the inverse field), and reads and writes 16 bits "
           "and a mask. The last columns are the time of mapping and resampling of DeformVolume relative to that of "
           "the peer, per voxel of the output. They are quotients of medians, because DeformVolume ran in another "
           "process. With an inverse field the output has as many voxels as the field has vectors."
           + (f" A copy on the device reads and writes, together: {', '.join(copies)}." if copies else "")
           + "\n")
    for pose, words in POSES.items():
        ours = {what: results.milliseconds(f"Deform/{pose}/{deformation}", "kernels")
                for deformation, what in DEFORMATIONS.items()}
        # With an inverse field the output has the size of the field.
        outputs = {what: results.median(f"Deform/{pose}/{deformation}", "output_voxels")
                   for deformation, what in DEFORMATIONS.items()}
        published = results.milliseconds(f"Published/{pose}/published", "kernels")
        bars = [(f"DeformVolume, {what}", time, True) for what, time in ours.items()
                if time and what != DEFORMATIONS["inverse/automatic"]]
        bars += [("published kernel, 2,197 nodes", published, False)] if published else []
        rows = []
        for name in results.names(f"GpuPeer/{pose}/"):
            what = GPU_PEERS["/".join(name.split("/")[2:])]
            time = results.median(name)
            if not time:
                continue
            voxels = results.median(name, "output_voxels")
            rows.append([what, voxels / 1e6, time,
                         1e-9 * results.median(name, "bytes_per_second")]
                        + [value and outputs[mine] and value / outputs[mine] * voxels / time
                           for mine, value in ours.items()])
            bars.append((what, time, False))
        if not rows:
            continue
        yield f"{words[0].upper()}{words[1:]}:\n"
        yield table(["peer", "million voxels of the output", "ms", "GB/s at least"]
                    + [f"DeformVolume, {what}, relative" for what in ours], rows)
        image = f"{kind}-kernels-{pose}.png"
        plot_bars(pictures.folder / image, f"Mapping and resampling, 13.2 million voxels, {words}\n"
                  f"{results.device}", "ms", bars)
        yield pictures.show(image, f"Mapping and resampling, {words}")


def comparison(results, pictures, kind):
    for pose, words in POSES.items():
        rows, bars = [], []
        for name in results.names(f"Deform/{pose}/"):
            parts = name.split("/")
            if len(parts) != 4:
                continue
            resampler = STYLES.get(parts[3], ["Automatic"])[0]
            rows.append([parts[2], resampler, results.median(name)]
                        + [results.milliseconds(name, key)
                           for key in ("mapping", "resampling", "transfer")]
                        + [results.ratio(name, f"Deform/{pose}/reslice-affine"),
                           results.median(name, "device_bytes_per_voxel"),
                           results.median(name, "mapping_builds"),
                           results.median(name, "volume_uploads")])
            if results.median(name):
                bars.append((f"{resampler}, {parts[2]}", results.median(name), True))
        if not rows:
            continue
        yield f"## Table 1: 189 x 305 x 229 voxels of 16 bits, {words}\n"
        yield table(["deformation", "resampler", "Update(), ms", "mapping, ms", "resampling, ms",
                     "transfer, ms", "Update() relative to affine vtkImageReslice", "device bytes per voxel",
                     "static mappings built", "uploads of the volume"], rows)
        rows = []
        for peer, (what, short) in PEERS.items():
            group = "Probe" if peer == "probe" else "Deform"
            ours = f"Probe/{pose}/exact" if peer == "probe" else f"Deform/{pose}/2197/exact"
            name = f"{group}/{pose}/{peer}"
            if results.median(name):
                rows.append([what, results.median(name), results.ratio(ours, name)])
                bars.append((short, results.median(name), False))
        if rows:
            yield f"Peers over the same output, {words}, 2,197 nodes:\n"
            yield table(["peer", "Update(), ms", "DeformVolume, relative"], rows)
        if not bars:
            continue
        image = f"{kind}-peers-{pose}.png"
        plot_bars(pictures.folder / image, f"Whole update, 13.2 million voxels, {words}\n"
                  f"{results.device}", "ms", bars)
        yield pictures.show(image, f"Whole updates, {words}")


def published(results, _pictures, _kind):
    rows = [[words] + [results.milliseconds(name, "kernels") for name in names]
            + [results.ratio(*names, "kernels")]
            for pose, words in POSES.items()
            for names in [[f"Published/{pose}/{method}" for method in ("exact", "published")]]
            if names[0] in results.runs]
    if rows:
        yield "## The published method: 189 x 305 x 229 voxels of 16 bits, 2,197 nodes\n"
        yield ("Mapping and resampling on the device. The published method first maps all vertices, and then resamples "
               "all cells, with one work-item for each.\n")
        yield table(["pose", "mapping + resampling, ms", "published, ms", "relative"], rows)


def poses(results, _pictures, _kind):
    rows = [[name.split("/")[1], results.milliseconds(name, "kernels"), results.median(name),
             results.ratio(name, "Poses/near", "kernels")] for name in results.names("Poses/")]
    if rows:
        yield "## Poses: 189 x 305 x 229 voxels of 16 bits, 2,197 nodes\n"
        yield table(["pose", "mapping + resampling, ms", "Update(), ms",
                     "relative to near identity"], rows)


def nodes(results, _pictures, _kind):
    rows = []
    for name in results.names("Nodes/"):
        _, pose, number = name.split("/")
        rows.append([pose, number, results.milliseconds(name, "kernels"), results.median(name),
                     results.ratio(name, f"Nodes/{pose}/2197", "kernels")])
    if rows:
        yield "## Nodes: 189 x 305 x 229 voxels of 16 bits\n"
        yield table(["pose", "nodes", "mapping + resampling, ms", "Update(), ms",
                     "relative to 2197"], rows)


def tight_meshes(results, _pictures, _kind):
    rows = []
    for name in results.names("TightMesh/"):
        _, number, kind = name.split("/")
        if kind == "boundary":
            without = f"TightMesh/{number}/without"
            rows.append([number, results.median(name), results.median(without),
                         results.ratio(name, without)])
    if rows:
        yield "## Meshes as large as a body of 100 x 100 x 100 voxels\n"
        yield ("Update() in which all nodes move, with and without the cells that the boundary of the mesh "
               "crosses.\n")
        yield table(["nodes", "Update(), ms", "without these cells, ms", "ratio"], rows)


def _chosen(results, name):
    """Returns the resampler that SetResamplerToAutomatic() has chosen, by its number in
    vtkDeformVolumeFilter::Resamplers."""
    return {0: "Exact", 2: "MeshRasterization"}.get(results.median(name, "resampler_in_use"), "-")


def tetrahedra(results, pictures, kind):
    counts = list(dict.fromkeys(name.split("/")[1] for name in results.names("Tetrahedra/")))
    rows, curves = [], {}
    for count in counts:
        row = [count]
        for resampler in STYLES:
            name = f"Tetrahedra/{count}/{resampler}"
            time = results.milliseconds(name, "kernels")
            row += [time, results.median(name)]
            if time:
                x, y = curves.setdefault(resampler, ([], []))
                x.append(int(count))
                y.append(time)
        rows.append(row + [_chosen(results, f"Tetrahedra/{count}/automatic")])
    if not rows:
        return
    yield "## Figure 7: time by the number of tetrahedra of the deformation mesh\n"
    yield table(["tetrahedra"] + [f"{name}: {what}" for name, _, _ in STYLES.values()
                                  for what in ("mapping + resampling, ms", "Update(), ms")]
                + ["choice of Automatic"], rows)
    if not curves:
        return
    image = f"{kind}-tetrahedra.png"
    plot_curves(pictures.folder / image, "189 x 305 x 229 voxels, near identity\n"
                + results.device,
                ("tetrahedra of the deformation mesh", "mapping + resampling, ms"), curves)
    yield pictures.show(image, "Time by the number of tetrahedra")


def voxels(results, pictures, kind):
    rows, curves = [], {}
    for name in results.names("Voxels/"):
        _, dimensions, resampler = name.split("/")
        count = results.median(name, "voxels")
        if not count:
            continue
        time = 1e9 * results.median(name, "kernels") / count
        rows.append([dimensions, f"{count / 1e6:.1f}", STYLES[resampler][0],
                     results.milliseconds(name, "kernels"), f"{time:.2f}",
                     1e6 * results.median(name) / count])
        x, y = curves.setdefault(resampler, ([], []))
        x.append(count / 1e6)
        y.append(time)
    if not rows:
        return
    yield "## Figure 8: time by the number of voxels, near identity, 2,197 nodes\n"
    yield table(["dimensions", "million voxels", "resampler", "mapping + resampling, ms",
                 "mapping + resampling, ns per voxel", "Update(), ns per voxel"], rows)
    image = f"{kind}-voxels.png"
    ours = [time for count, time in zip(*curves.get("exact", ((), ()))) if count > 3.9]
    middle = 0.5 * (min(ours) + max(ours)) if ours else None
    plot_curves(pictures.folder / image, "Near identity, 2,197 nodes\n" + results.device,
                ("million voxels", "mapping + resampling, ns per voxel"), curves,
                (0.8 * middle, 1.2 * middle) if middle else None)
    yield pictures.show(image, "Time per voxel by the number of voxels")


def preprocessing(results, _pictures, _kind):
    rows = [name.split("/")[1:] + [results.median(name)] for name in results.names("Preprocess/")]
    if rows:
        yield "## Preprocessing: the static mapping, once for a volume and a mesh at rest\n"
        yield table(["voxels", "nodes", "ms"], rows)


def memory(results, _pictures, _kind):
    rows = []
    for name in results.names("Memory/"):
        _, dimensions, scalars, nodes, resampler = name.split("/")
        resident = results.median(name, "resident_bytes")
        rows.append([dimensions, scalars, nodes, STYLES[resampler][0],
                     results.median(name, "device_bytes_per_voxel"),
                     results.median(name, "resident_bytes_per_voxel"),
                     f"{resident / 1e9:.2f}" if resident else "failed"])
    if rows:
        yield "## Memory: one update in a process of its own\n"
        yield table(["voxels", "type", "nodes", "resampler", "device bytes per voxel",
                     "resident bytes per voxel", "highest resident memory of the process, GB"], rows)


def incremental(results, _pictures, _kind):
    rows = [[words, results.median(name), results.milliseconds(name, "kernels"),
             results.ratio(name, "Incremental/near")]
            for name, words in (("Incremental/near", "all"),
                                ("Incremental/local-edit", "those in a box that touches 5 % of the blocks"),
                                ("Incremental/local-edit-at-side", "such a box on a side of the volume"))
            if name in results.runs]
    if rows:
        yield "## Edits: a part of 512,000 nodes moves, 189 x 305 x 229 voxels\n"
        yield table(["nodes that move", "Update(), ms", "mapping + resampling, ms", "Update() relative to all"], rows)


def readback(results, _pictures, _kind):
    rows = [[moves, words, results.median(name), results.milliseconds(name, "kernels"),
             results.milliseconds(name, "transfer"), results.milliseconds(name, "reading")]
            for pose, moves in (("near", "all"), ("local-edit", "those in a box that touches 5 % of the blocks"))
            for way, words in (("at-once", "is copied in the update"),
                               ("unread", "stays on the device, and is not read"),
                               ("later", "stays on the device, and is read after the update"))
            for name in [f"Readback/{pose}/{way}"] if name in results.runs]
    if rows:
        yield "## OutputOnDevice: 189 x 305 x 229 voxels of 16 bits, 2,197 nodes\n"
        yield table(["nodes that move", "output", "Update() and reading, ms", "mapping + resampling, ms",
                     "transfer in Update(), ms", "reading, ms"], rows)


def live(results, _pictures, _kind):
    rows = [[words, results.median(name), results.milliseconds(name, "kernels"),
             results.ratio(name, "Live/all-move")]
            for name, words in (
                ("Live/all-move", "all nodes move"),
                ("Live/some-move", "the nodes in a box of 1/100 of the volume move"),
                ("Live/some-move-logged", "the same, logged"),
                ("Live/few-move", "nodes move in 14 of 285 bricks"),
                ("Live/nothing", "nothing; the mesh is marked as modified"),
                ("Live/split", "2,000 tetrahedra get 1,000 new nodes"),
                ("Live/split-logged", "the same, logged"),
                ("Live/masks", "tetrahedra in 2 x 30 x 30 cells are switched off, as many others on"),
                ("Live/masks-logged", "the same, logged"),
                ("Live/split-and-masks", "new nodes and masks together"),
                ("Live/split-and-masks-logged", "the same, logged"),
                ("Live/another-mesh", "a rest position: the static mapping is rebuilt"))
            if name in results.runs]
    if rows:
        yield "## Live: changes between two frames, 512,000 nodes, 189 x 305 x 229 voxels\n"
        yield table(["what changes", "Update(), ms", "mapping + resampling, ms",
                     "Update() relative to all move"], rows)


def chain_mail(results, _pictures, _kind):
    rows = []
    for dimensions in INTERACTIVE_SIZES:
        for part, words in (("part", "what has moved"), ("whole", "the whole volume")):
            name = f"ChainMail/{dimensions}/{part}"
            if name in results.runs:
                rows.append([dimensions, _count(results.median(name, "moved")),
                             results.milliseconds(name, "step"), words,
                             results.milliseconds(name, "mapping"),
                             results.milliseconds(name, "resampling"), results.median(name)])
        if rows and rows[-1][0] == dimensions:
            step, mapping, resampling, frame = PAPER_FRAMES[dimensions]
            rows.append([f"{dimensions}, published", None, step, "the whole volume", mapping, resampling,
                         frame])
    if rows:
        yield "## ChainMail: frames of a drag\n"
        yield table(["voxels", "voxels moved", "step, ms", "resampled", "mapping, ms",
                     "resampling, ms", "frame: step and Update(), ms"], rows)
    rows = [[_count(results.median(name, "moved")), results.median(name)]
            for name in results.names("ChainMailStep/")]
    if rows:
        yield "## ChainMail: steps of a drag through 189 x 305 x 229 voxels\n"
        yield table(["voxels moved", "step, ms"], rows)


PHYSICS = (
    ("springs-2431", "springs, a step"), ("springs-507584", "springs, a step"),
    ("springs-2197-60Hz", "springs, the steps of 1/60 s"),
    ("springs-2197-60Hz-half", "the same, SamplingFactor 2"),
    ("elements-117", "finite elements"), ("elements-3193", "finite elements"),
    ("elements-19307", "finite elements"))


def physics(results, _pictures, _kind):
    rows = []
    for body, words in PHYSICS:
        name = f"Physics/{body}/frame"
        if name not in results.runs:
            continue
        frame = results.median(name)
        rows.append([words, _count(results.median(name, "nodes")),
                     _count(results.median(name, "tetrahedra")),
                     *(results.milliseconds(name, part)
                       for part in ("simulation", "mapping", "resampling")),
                     frame, frame and 1000.0 / frame,
                     (results.median(name, "device_bytes") or 0.0) / 2**20])
        if body == "springs-507584":
            rows.append(["springs, published", "512,000", "2.5 million", *PAPER_SPRINGS,
                         sum(PAPER_SPRINGS), 1000.0 / sum(PAPER_SPRINGS), None])
    if rows:
        yield "## Physics: frames of simulated bodies\n"
        yield table(["simulation", "nodes", "tetrahedra", "simulation, ms", "mapping, ms",
                     "resampling, ms", "frame: step and Update(), ms", "frames a second",
                     "device memory of the filter, MiB"], rows)
    rows = []
    for body, words in (("springs-2197", "springs in a cube"), ("springs-4096", "springs in a cube"),
                        ("springs-512000", "springs in a cube"), ("elements-19307", "finite elements")):
        name = f"Physics/{body}/frame"
        seconds = results.median(name, "simulation")
        if seconds:
            published = SOFA_RATES.get(body)
            rows.append([words, _count(results.median(name, "nodes")), 1e3 * seconds, 1.0 / seconds, published,
                         published and 1.0 / seconds / published])
    if rows:
        yield "Simulations alone:\n"
        yield table(["simulation", "nodes", "step, ms", "steps a second", "SOFA, published", "relative to SOFA"], rows)


SESSIONS = (
    ("at-rest", "at rest"), ("chain-mail", "ChainMail"), ("springs-343", "springs, 343 nodes"),
    ("elements-117", "finite elements, 117 nodes"), ("elements-665", "finite elements, 665 nodes"))


def session(results, _pictures, _kind):
    rows = [[words, event, results.median(f"Session/{body}/{event}", "moved") or None,
             *(results.milliseconds(f"Session/{body}/{event}", part)
               for part in ("simulation", "resampling")), results.median(f"Session/{body}/{event}")]
            for body, words in SESSIONS for event in ("drag", "cut", "carve")
            if f"Session/{body}/{event}" in results.runs]
    if rows:
        yield "## Sessions: time from an event to the output, 181 x 217 x 181 voxels\n"
        yield table(["body", "event", "voxels moved by ChainMail", "event and step, ms", "resampling, ms",
                     "total, ms"], rows)


def edits(results, _pictures, _kind):
    rows = [[dimensions, words, results.median(f"Edit/{dimensions}/{name}"), paper]
            for dimensions in INTERACTIVE_SIZES
            for name, words, paper in (
                ("sheet", "a cut by a sheet of 200 triangles through the whole volume", PAPER_CUT),
                ("tool", "a cut by a step of a tool that touches 1 % of the bricks", None),
                ("sphere", "a sphere with a radius of 20 voxels is carved out", PAPER_CARVING),
                ("nothing", "nothing", None))
            if f"Edit/{dimensions}/{name}" in results.runs]
    if rows:
        yield "## Cutting and carving\n"
        yield table(["voxels", "edit", "Update(), ms", "published, at most, ms"], rows)


def masks(results, _pictures, _kind):
    rows = [[mask, words, results.median(name), results.milliseconds(name, "kernels"),
             results.milliseconds(name, "transfer")]
            for group, mask in (("active", "active tetrahedra, 13.1 MB"), ("blanked", "blanked points, 13.2 MB"))
            for change, words in (
                ("first", "the first mask: a ball with a radius of 20 voxels is off"),
                ("ball", "the ball is at another place"),
                ("box", "the ball is on again, and a box of 20 x 20 x 20 is off"),
                ("noise", "everything: a random half is off"),
                ("nothing", "nothing; the array is marked as modified"))
            for name in [f"Masks/{group}/{change}"] if name in results.runs]
    if rows:
        yield "## Masks of 189 x 305 x 229 voxels; 2,197 nodes do not move\n"
        yield ("The output stays on the device, so the transfer is that of the mask and includes its comparison with "
               "the last one. On a CPU there is only the comparison.\n")
        yield table(["mask", "what changes", "Update(), ms", "mapping + resampling, ms", "transfer, ms"], rows)


def given(results, _pictures, _kind):
    rows = [[words, results.median(name), results.milliseconds(name, "kernels"),
             results.difference(name, "Given/same-grid")]
            for name, words in (
                ("Given/same-grid", "the same grid, other displacements"),
                ("Given/shared-arrays", "another grid that shares its arrays"),
                ("Given/two-meshes", "a deformed mesh, modified, and a mesh at rest"),
                ("Given/dense-field", "no mesh: a displacement for each voxel"))
            if name in results.runs]
    if rows:
        yield "## Forms of the deformation: 512,000 nodes, 189 x 305 x 229 voxels, near identity\n"
        yield table(["input", "Update(), ms", "mapping + resampling, ms",
                     "Update() minus that with the same grid, ms"], rows)


# Names of the sections, for the list of what was not measured.
ALL = {
    "the memory bandwidth": device,
    "table 1": comparison,
    "the published method": published,
    "poses": poses,
    "nodes": nodes,
    "tight meshes": tight_meshes,
    "figure 7": tetrahedra,
    "figure 8": voxels,
    "preprocessing": preprocessing,
    "memory": memory,
    "edits": incremental,
    "live": live,
    "ChainMail": chain_mail,
    "physics": physics,
    "sessions": session,
    "cutting and carving": edits,
    "masks": masks,
    "forms of the deformation": given,
}
# Additional sections for GPUs, before those of ALL.
ON_GPUS = {
    "kernels on the GPU": gpu,
    "peers on the GPU": gpu_peers,
    "OutputOnDevice": readback,
}
