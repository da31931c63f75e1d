#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Links all kernels with the linker of the Python package, and loads them, as PoCL does.

    link_kernels.py SOURCES PROGRAM DRIVER LINKER FOLDER

SOURCES: the folder Kernels. PROGRAM: KernelTexts. DRIVER: PoCL of the package pocl-binary-distribution. LINKER: the
folder of the program ld. FOLDER: a folder for temporary files.

PROGRAM deforms volumes by links, runs and fields, with and without a cut, with arrays of all types. Its driver compiles
and links the kernels for CPUs and for graphics cards. This script checks that
- each function of the sources that begins with __kernel has been linked;
- each library was made by this linker, and can be loaded: the C library and libm have all of its symbols.
Otherwise it fails, and names the kernels.
"""

import ctypes
import os
import re
import shutil
import struct
import subprocess
import sys

SOURCES, PROGRAM, DRIVER, LINKER, FOLDER = map(os.path.abspath, sys.argv[1:])


def find_kernels():
    """The names of all kernels in the sources."""
    names = set()
    for folder, _, files in os.walk(SOURCES):
        for file in files:
            if not file.endswith((".cl", ".h", ".cxx")):
                continue
            with open(os.path.join(folder, file), encoding="utf-8") as stream:
                text = stream.read()
            # Kernels that macros define: the first argument is the name.
            for macro, body in re.findall(r"#define (\w+)\(NAME\b((?:[^\n]*\\\n)*[^\n]*)", text):
                if re.search(r"__kernel\b[^(]*\bvoid NAME\(", body):
                    names.update(re.findall(rf"^{macro}\((\w+)", text, re.MULTILINE))
            names.update(re.findall(r"__kernel\b(?:\s*__attribute__\(.*\))?\s*void\s+(\w+)\(", text))
    names.discard("NAME")
    return names


def link(device):
    """Starts PROGRAM, whose driver compiles and links the kernels of a device. Returns the process."""
    work = os.path.join(FOLDER, device)
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work + "/texts")
    environment = dict(os.environ, POCL_CACHE_DIR=work + "/cache", OCL_ICD_VENDORS="/nowhere")
    for name in ("DEFORMVOLUME_DEVICE", "DEFORMVOLUME_LINKER", "DEFORMVOLUME_KERNEL_PROCESSOR"):
        environment.pop(name, None)
    return subprocess.Popen([PROGRAM, work + "/texts", device, "linked", DRIVER, LINKER], env=environment)


def check(device):
    """Checks the libraries of a device. Returns the name of the kernel of each library."""
    work = os.path.join(FOLDER, device)
    with open(work + "/texts/kernels.txt", encoding="utf-8") as stream:
        wanted = [line.split()[1] for line in stream]
    linked = []
    for folder, _, files in os.walk(work + "/cache"):
        for file in files:
            if not file.endswith(".so"):
                continue
            path = os.path.join(folder, file)
            with open(path, "rb") as stream:
                header = stream.read(64)
            # Unlike other linkers, this linker writes no sections.
            if struct.unpack_from("<H", header, 60)[0] != 0:
                sys.exit(f"{path} was made by another linker.")
            try:
                ctypes.CDLL(path, mode=os.RTLD_NOW)
            except OSError as error:
                sys.exit(f"{path} cannot be loaded: {error}")
            linked.append(file[: -len(".so")])
    # A kernel that several programs contain is linked once for each program.
    missing = {name for name in wanted if linked.count(name) < wanted.count(name)}
    if missing:
        sys.exit(f"Not linked in each program of device {device}: {sorted(missing)}")
    return linked


def main():
    kernels = find_kernels()
    devices = ("processor", "double")
    if any([process.wait() for process in [link(device) for device in devices]]):
        sys.exit("The kernels cannot be linked.")
    linked = [name for device in devices for name in check(device)]
    missing = kernels - set(linked)
    if missing:
        sys.exit(
            f"Not linked: {sorted(missing)}. Add to Testing/Kernels/KernelTexts.cxx a deformation that uses these "
            "kernels."
        )
    print(f"{len(kernels)} kernels linked and loaded, as {len(linked)} libraries")


main()
