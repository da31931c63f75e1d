# SPDX-License-Identifier: BSD-3-Clause
"""Makes a report in Markdown of a result of DeformVolumeBenchmarks: report.py RESULT.json"""
import collections
import json
import statistics
import sys


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return "unknown processor"


def table(header, rows):
    print("| " + " | ".join(header) + " |")
    print("|---" * len(header) + "|")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print()


def main(path):
    with open(path, encoding="utf-8") as file:
        result = json.load(file)
    runs = collections.defaultdict(list)
    for run in result["benchmarks"]:
        if run["run_type"] == "iteration":
            runs[run["run_name"].split("/iterations")[0]].append(run)

    def median(name, key="real_time"):
        return statistics.median(run[key] for run in runs[name])

    context = result["context"]
    repetitions = max(len(some) for some in runs.values())
    print("# Benchmarks\n")
    print(f"{processor()}, {context['num_cpus']} processors; OpenCL device: {context['device']}; "
          f"{context['date']}.")
    print(f"Medians of {repetitions} repetitions, in an order drawn by chance within one run.\n")

    print("## Deformation mapping and resampling, 189 x 305 x 229 voxels of 16 bits\n")
    rows = []
    for name in sorted(runs):
        if not name.startswith("Deform/") or not name.endswith("/default"):
            continue
        _, _, nodes, pose, _ = name.split("/")
        published = name.replace("/default", "/published")
        pairs = zip(runs[name], runs[published])
        ratio = statistics.median(b["real_time"] / a["real_time"] for a, b in pairs)
        rows.append([nodes, pose, f"{median(name):.1f}", f"{1e3 * median(name, 'mapping'):.1f}",
                     f"{1e3 * median(name, 'resampling'):.1f}", f"{median(published):.1f}",
                     f"{ratio:.2f}", f"{1e3 * median(name, 'transfer'):.1f}",
                     f"{median(name, 'bytes_per_voxel'):.1f}",
                     f"{median(name, 'mapping_builds'):.0f}",
                     f"{median(name, 'volume_uploads'):.0f}"])
    table(["nodes", "pose", "default, ms", "mapping, ms", "resampling, ms", "published, ms",
           "published by default", "transfer, ms", "device bytes per voxel",
           "mappings built for a moved mesh", "uploads for a moved mesh"], rows)

    print("## Preprocessing: the tetrahedron of each voxel\n")
    rows = [name.split("/")[1:] + [f"{median(name):.0f}"]
            for name in sorted(runs) if name.startswith("Preprocess/")]
    table(["voxels", "nodes", "ms"], rows)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
