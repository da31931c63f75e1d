# SPDX-License-Identifier: BSD-3-Clause
"""Makes a report in Markdown, with plots, of what the benchmark programs wrote: report.py FOLDER.
FOLDER holds a folder of JSON files for each device; report.md and the plots are written to it."""
import os
import pathlib
import sys

import sections
from demands import DEMANDS
from results import Results
from sections import cell, table


def processor():
    """Model, number and widest vectors of the processors."""
    model, flags = "unknown processor", ""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            key, _, value = line.partition(":")
            if key.strip() == "model name":
                model = value.strip()
            elif key.strip() == "flags":
                flags = value.split()
    width = next((words for flag, words in (
        ("avx512f", "AVX-512, 16 floats"), ("avx2", "AVX2, 8 floats"), ("avx", "AVX, 8 floats"))
        if flag in flags), "vectors of 4 floats")
    return f"{model}, {os.cpu_count()} processors, {width}"


def describe(results):
    context = results.context
    words = (f"{context['device']}, driver {context['driver']}, {context['version']}, "
             f"{context['compute_units']} compute units, vectors of {context['vector_width']} "
             "floats")
    return words + f"; host {processor()}"


def demand_rows(devices):
    rows = []
    for demand in DEMANDS:
        for kind, results in devices.items():
            is_processor = results.context["device_is_processor"] == "1"
            if demand.only_on == "gpu" and is_processor:
                continue
            value = demand.value(results)
            verdict = "not measured" if value is None else \
                "met" if value <= demand.limit else "**not met**"
            rows.append([demand.words, f"{cell(demand.limit, 3)} {demand.unit}".strip(),
                         cell(value, 3), verdict, kind])
    return rows


def report(folder):
    devices = {path.name: Results(path) for path in sorted(folder.iterdir()) if path.is_dir()}
    devices = {kind: results for kind, results in devices.items() if results.runs}
    if not devices:
        sys.exit(f"report.py: {folder} holds no results")
    yield "# Benchmarks\n"
    dates = {results.context["date"] for results in devices.values()}
    yield f"Measured on {min(dates)}. What each table means: Documents/benchmarks.md.\n"
    yield table(["device", "what it is"],
                [[kind, describe(results)] for kind, results in devices.items()])
    yield "## Demands\n"
    yield ("Each number is a median over the rounds of one run, ratios are medians of ratios within "
           "rounds, and all are from the device in the last column.\n")
    yield table(["demand", "at most", "measured", "", "device"], demand_rows(devices))
    for kind, results in devices.items():
        yield f"# Device {kind}: {results.context['device']}\n"
        for section in sections.ALL:
            yield from section(results, folder, kind)
        errors = results.errors()
        if errors:
            yield "## What failed\n"
            yield table(["measurement", "message"],
                        [[name, " ".join(words.split())] for name, words in errors])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    FOLDER = pathlib.Path(sys.argv[1])
    TEXT = "\n".join(report(FOLDER))
    (FOLDER / "report.md").write_text(TEXT, encoding="utf-8")
    print(TEXT)
