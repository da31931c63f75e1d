# SPDX-License-Identifier: BSD-3-Clause
"""Writes a description of the CPUs of this machine to FOLDER/machine.json, in the form of Google Benchmark, so that a
report can be made on another machine. Usage: machine.py FOLDER"""
import json
import os
import pathlib
import sys


def describe_processors():
    """Returns the model, the number and the widest vectors of the CPUs."""
    model, flags = "unknown processor", ""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            key, _, value = line.partition(":")
            if key.strip() == "model name":
                model = value.strip()
            elif key.strip() == "flags":
                flags = value.split()
    width = next((words for flag, words in (
        ("avx512f", "AVX-512, vectors of 16 floats"), ("avx2", "AVX2, vectors of 8 floats"),
        ("avx", "AVX, vectors of 8 floats"))
        if flag in flags), "vectors of 4 floats")
    return f"{model}, {os.cpu_count()} processors, {width}"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(pathlib.Path(sys.argv[1]) / "machine.json", "w", encoding="utf-8") as FILE:
        json.dump({"context": {"processors": describe_processors()}, "benchmarks": []}, FILE)
