# SPDX-License-Identifier: BSD-3-Clause
"""Prints tables of the numbers that compilers for GPUs report for each kernel, for Testing/gpu-compilers.sh.

usage: gpu_tables.py FOLDER (nvidia | amd | intel | oclgrind) TARGET...

FOLDER/texts/double and FOLDER/texts/single contain the programs that KernelTexts has written, and
FOLDER/VENDOR/TARGET the output of the compilers. Kernels with equal numbers share a row. For oclgrind
the targets are the updates whose counts are in FOLDER/oclgrind: FORM-DEFORMATION.
"""

import collections
import os
import re
import sys

# Size of work-groups of kernels that KernelTexts did not launch: the size that WorkDevice uses.
ITEMS = 64

# Limits of a multiprocessor of NVIDIA's GPUs: warps, groups, and bytes of shared memory; and the bytes of shared memory
# that the system uses for each group. Source: "CUDA C++ Programming Guide", compute capabilities.
NVIDIA = {
    "sm_70": (64, 32, 96 << 10, 0),
    "sm_75": (32, 16, 64 << 10, 0),
    "sm_80": (64, 32, 164 << 10, 1024),
    "sm_86": (48, 16, 100 << 10, 1024),
    "sm_89": (48, 24, 100 << 10, 1024),
    "sm_90": (64, 32, 228 << 10, 1024),
}
# Limits of a compute unit of AMD's GPUs: SIMDs, waves of each SIMD, groups of several waves, work-items of a wave,
# bytes of local memory. Source: LLVM's AMDGPUBaseInfo.cpp.
AMD = {
    "gfx906": (4, 10, 16, 64, 64 << 10),
    "gfx90a": (4, 8, 16, 64, 64 << 10),
    "gfx1030": (2, 16, 16, 32, 64 << 10),
}

Use = collections.namedtuple("Use", "items local")


def read(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read()


def round_up(value, step):
    return (value + step - 1) // step * step


def find_least(limits):
    """Returns the least number and its name."""
    return min((number, name) for name, number in limits.items() if number is not None)


def describe_occupancy(count, most, limit):
    return f"{count} of {most}" + (f" ({limit})" if count < most else "")


def describe_nvidia(target, registers, local, use):
    """Returns the occupancy: the number of warps of a multiprocessor, and what limits it."""
    most, groups, memory, own = NVIDIA[target]
    warps = round_up(use.items, 32) // 32
    # A multiprocessor has four parts. Each part has a quarter of the registers for its warps.
    by_registers = 4 * ((1 << 14) // round_up(32 * max(registers, 1), 256))
    held = round_up(local + own, 128)
    least, name = find_least(
        {
            "registers": by_registers // warps,
            "local memory": memory // held if held else None,
            "groups": min(groups, most // warps),
        }
    )
    return describe_occupancy(least * warps, most, name)


def read_nvidia(folder, target, program):
    """Returns the numbers of each kernel from the output of ptxas.

    ptxas lists the spills of called functions behind the kernel that calls them first.
    """
    found = {}
    kernel = None
    path = f"{folder}/nvidia/{target}/{program}.log"
    for line in read(path).splitlines() if os.path.exists(path) else []:
        begin = re.search(r"Compiling entry function '(\w+)'", line)
        if begin:
            kernel = begin.group(1)
            numbers = found[kernel] = dict.fromkeys(
                ("registers", "stack", "stores", "loads", "shared"), 0
            )
        spills = re.search(
            r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line
        )
        if spills and kernel:
            numbers["stack"] = max(numbers["stack"], int(spills.group(1)))
            numbers["stores"] += int(spills.group(2))
            numbers["loads"] += int(spills.group(3))
        used = re.search(r"Used (\d+) registers", line)
        if used and kernel:
            stack = re.search(r"(\d+) bytes cumulative stack", line)
            shared = re.search(r"(\d+) bytes smem", line)
            numbers["registers"] = int(used.group(1))
            numbers["stack"] = max(numbers["stack"], int(stack.group(1)) if stack else 0)
            numbers["shared"] = int(shared.group(1)) if shared else 0
    return {name: tuple(numbers.values()) for name, numbers in found.items()}


def make_nvidia_cell(target, numbers, use):
    registers, stack, stores, loads, shared = numbers
    occupancy = describe_nvidia(target, registers, shared + use.local, use)
    return f"{registers}; {stack}; {stores} + {loads}; {occupancy}", shared


def read_amd(folder, target, program):
    """Returns the numbers of each kernel from the metadata that LLVM writes at the end of the assembly."""
    found = {}
    path = f"{folder}/amd/{target}/{program}.s"
    text = read(path) if os.path.exists(path) else ""
    # The comments of a kernel follow its descriptor.
    occupancies = dict(
        re.findall(r"\.amdhsa_kernel (\w+)\n.*?; Occupancy: (\d+)", text, re.DOTALL)
    )
    metadata = text[text.find(".amdgpu_metadata") :]
    for block in re.split(r"\n  - ", metadata.partition("amdhsa.kernels:")[2])[1:]:
        # Entries of arguments are indented further, and do not match.
        entries = dict(re.findall(r"^(?:    )?\.(\w+): +(\S+)", block, re.MULTILINE))
        if "name" not in entries:
            continue
        found[entries["name"]] = (
            int(entries["vgpr_count"]),
            int(entries["sgpr_count"]),
            int(entries["private_segment_fixed_size"]),
            int(entries["vgpr_spill_count"]),
            int(entries["sgpr_spill_count"]),
            int(entries["group_segment_fixed_size"]),
            int(occupancies[entries["name"]]),
        )
    return found


def make_amd_cell(target, numbers, use):
    vectors, scalars, scratch, spilled, spilled_scalars, shared, by_registers = numbers
    simds, most, groups, lanes, memory = AMD[target]
    waves = round_up(use.items, lanes) // lanes
    local = shared + use.local
    least, name = find_least(
        {
            "registers": by_registers * simds // waves,
            "local memory": memory // round_up(local, 512) if local else None,
            "groups": simds * most if waves == 1 else min(groups, simds * most // waves),
        }
    )
    occupancy = describe_occupancy(least * waves, simds * most, name)
    cell = f"{vectors} + {scalars}; {scratch}; {spilled} + {spilled_scalars}; {occupancy}"
    return cell, shared


def read_intel(folder, target, program):
    """Returns the numbers of each kernel from the output of ocloc, which lists only kernels with spills."""
    path = f"{folder}/intel/{target}/{program}.log"
    if not os.path.exists(path):
        return {}
    text = read(path)
    if "Build succeeded" not in text:
        return {}
    found = collections.defaultdict(lambda: ("", 0, 0))
    for name, width, registers, spilled in re.findall(
        r"kernel (\w+)\s+compiled SIMD(\d+) allocated (\d+) regs and spilled around (\d+)", text
    ):
        found[name] = (width, int(registers), int(spilled))
    return found


def make_intel_cell(_target, numbers, _use):
    width, registers, spilled = numbers
    return (f"SIMD{width}, {registers}; {spilled}" if width else "fits"), 0


VENDORS = {
    "nvidia": (
        read_nvidia,
        make_nvidia_cell,
        "registers; bytes of stack; bytes of spill stores + loads, those of called functions with "
        "them; warps at once on a multiprocessor, and what limits them",
    ),
    "amd": (
        read_amd,
        make_amd_cell,
        "VGPRs + SGPRs; bytes of scratch; spilled VGPRs + SGPRs; waves at once on a compute unit, "
        "and what limits them",
    ),
    "intel": (
        read_intel,
        make_intel_cell,
        "width, registers; spilled registers; \"fits\" where the compiler reports no spills",
    ),
}


# Instructions of LLVM that cost nothing, or are a part of another instruction.
FREE = re.compile(r"getelementptr|bitcast|phi|alloca|freeze|addrspacecast|call llvm\.lifetime")


def print_counts(folder, runs, voxels):
    print("Of one whole update, by kernel: instructions of LLVM and how many a voxel of the volume,")
    print("loads and stores of private memory among them, and bytes of global memory a voxel.")
    print("Functions are not inlined; addresses and copies between registers are not counted.\n")
    print("| Form | Deformation | Kernel | Launches | Instructions | A voxel | Of private memory | Global bytes a voxel |")
    print("|---|---|---|---|---|---|---|---|")
    for run in runs:
        form, _, shape = run.partition("-")
        counts = collections.defaultdict(lambda: [0, 0, 0, 0])
        kernel = None
        for line in read(f"{folder}/oclgrind/{run}.txt").partition("later:")[2].splitlines():
            begin = re.search(r"Instructions executed for kernel '(\w+)'", line)
            if begin:
                kernel = counts[begin.group(1)]
                kernel[0] += 1
            entry = re.match(r" +(\d+) - ([^(]+?)\s*(?:\((\d+) bytes\))?(?:\(\))?$", line)
            if not entry or FREE.match(entry.group(2)):
                continue
            number, name, size = int(entry.group(1)), entry.group(2), int(entry.group(3) or 0)
            kernel[1] += number
            kernel[2] += number if name.endswith("private") else 0
            kernel[3] += size if name.endswith("global") else 0
        for name, (launches, instructions, private, size) in sorted(counts.items()):
            print(
                f"| {form} | {shape} | {name} | {launches} | {instructions:,} | {instructions / voxels:.0f} "
                f"| {private / instructions:.0%} | {size / voxels:.0f} |"
            )


def print_table(folder, vendor, targets):
    read_numbers, make_cell, legend = VENDORS[vendor]
    rows = collections.defaultdict(list)
    for precision in ("double", "single"):
        list_path = f"{folder}/texts/{precision}/kernels.txt"
        for line in read(list_path).splitlines() if os.path.exists(list_path) else []:
            name, kernel, items, local = line.split()
            use = Use(int(items) or ITEMS, int(local))
            program = f"{precision}.{name}"
            cells = []
            static = 0
            for target in targets:
                errors = f"{folder}/{vendor}/{target}/{program}.errors"
                numbers = read_numbers(folder, target, program)
                if isinstance(numbers, collections.defaultdict) or kernel in numbers:
                    cell, shared = make_cell(target, numbers[kernel], use)
                    cells.append(cell)
                    static = max(static, shared)
                elif os.path.exists(errors):
                    cells.append("does not compile")
                else:
                    cells.append("")
            if any(cells):
                purpose = name.partition("-")[2] + (", single" if precision == "single" else "")
                rows[(kernel, use.items, static + use.local, *cells)].append(purpose)
    print(f"Cells: {legend}.\n")
    heads = ["Kernel", "Programs", "Group", "Local memory", *targets]
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads))
    for row in sorted(rows, key=lambda row: (row[0], rows[row])):
        kernel, items, local, *cells = row
        columns = [kernel, "<br>".join(sorted(set(rows[row]))), str(items), str(local), *cells]
        print("| " + " | ".join(columns) + " |")


if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[2] not in (*VENDORS, "oclgrind"):
        sys.exit(__doc__)
    if sys.argv[2] == "oclgrind":
        print_counts(sys.argv[1], sys.argv[3:], 16**3)
    else:
        print_table(*sys.argv[1:3], sys.argv[3:])
