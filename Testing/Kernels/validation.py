#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the values in the tables of Documents/physics.md.

    python3 Testing/Kernels/validation.py FOLDER [--write]

FOLDER is the folder of the program DeformVolumeEngineTests (build/vtk/bin). Runs some of its tests, which takes about
20 seconds, and prints the tables. With --write, replaces the tables of the document.
"""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "Documents" / "physics.md"
TESTS = {
    "TestMassSpring": "*PeriodOfASpring:*FreeFall:*StableTimeStep:*NothingMovesAtRest",
    "TestMassSpringStatics": "*LatticesAreIsotropic",
    "TestFiniteElements": "*RandomPlacements",
    "TestFiniteElementBeams": "*",
}


def measure(folder):
    """Runs the tests. Returns their recorded values as {test: {name: value}}. Raises an error if a test fails."""
    values = {}
    for source, pattern in TESTS.items():
        with tempfile.TemporaryDirectory() as temporary:
            path = pathlib.Path(temporary) / "results.json"
            subprocess.run([folder / "DeformVolumeEngineTests", f"--files={source}", f"--gtest_filter={pattern}",
                            f"--gtest_output=json:{path}"], check=True, stdout=subprocess.DEVNULL)
            suites = json.loads(path.read_text(encoding="utf-8"))["testsuites"]
        for test in (test for suite in suites for test in suite["testsuite"]):
            values[test["name"]] = {name: float(value) for name, value in test.items()
                                    if isinstance(value, str) and re.fullmatch(r"-?[\d.]+(e[-+]\d+)?", value)}
    return values


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---" * len(header) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def listed(values, names, digits):
    return ", ".join(f"{values[name]:.{digits}f}" for name in names)


def springs(values):
    lattice = values["LatticesAreIsotropic"]
    ratios = ("25", "40", "45")
    return table(["Case", "Expected", "Measured"], [
        ["Young modulus of a bar of 8 x 8 x 8 cubes by the given one, for Poisson ratios of 0.25, 0.40, 0.45", "1",
         listed(lattice, [f"E, {ratio}" for ratio in ratios], 3)],
        ["Poisson ratio inside that bar", "0.25, 0.40, 0.45",
         listed(lattice, [f"nu, {ratio}" for ratio in ratios], 3)],
        ["10,000 time steps of the stable length; of 1.7 times that", "stable; diverges",
         "stable; diverges, with an error"],
        ["Forces in a body at rest", "0", "0"],
        ["Period of a node on springs", "2 pi sqrt(m/k)",
         f"within {100 * values['PeriodOfASpring']['period']:.1g} %"],
        ["Fall of a free body", "g t (t + dt) / 2", f"within {100 * values['FreeFall']['fall']:.1g} %"],
    ])


def elements(values):
    scramble = values["RandomPlacements"]
    bar = values["HangingBar"]
    return table(["Case", "Expected", "Measured"], [
        ["Largest force after a rigid rotation by 2 rad, E h^2 = 2.8e3 N", "0",
         f"{values['RigidMotion']['force']:.0e} N"],
        ["Patch test: inner nodes moved, boundary displaced by an affine map, both material models",
         "error under 1e-11",
         f"{values['Patch']['error']:.0e}"],
        ["Neo-Hookean cube under uniaxial and equibiaxial load: stretches 0.6 to 2, nu 0.3, 0.45, 0.49",
         "stretches within 1e-6",
         f"within {max(values['Uniaxial']['error'], values['Equibiaxial']['error']):.0e}"],
        ["Neo-Hookean cube under simple shear g up to 1, nu 0.3, 0.45, 0.49", "stresses mu g and mu g^2",
         "within 1e-8 Pa"],
        ["Elongation of a hanging bar, rho g L^2 / 2 E, 40 times as long as thick", "4.9050e-04",
         f"{bar['longer, nu 0']:.4e} (nu 0), {bar['longer, nu 0.3']:.4e} (nu 0.3)"],
        ["Lateral displacement of a straight bar under its weight, by its length", "0",
         f"{values['NoDrift']['drift']:.0e}"],
        [f"100 random placements of the nodes, each with {scramble['fewest inverted']:.0f} or more of 40 "
         "tetrahedra inverted",
         "returns to rest", f"error {scramble['error']:.0e} m, at most {scramble['most steps']:.0f} steps"],
    ])


# Each row: case, test, prefix of the names of its values, and the converged value for each name.
ACCURACY = [
    ("Cantilever, 10 times as long as thick: deflection by that of Euler-Bernoulli theory", "Cantilever", "",
     {"nu 0.3, 1": 1.0010, "nu 0.3, 2": 1.0010, "nu 0.45, 1": 0.9927, "nu 0.45, 2": 0.9927, "nu 0.49, 1": 0.9895,
      "nu 0.49, 2": 0.9895}),
    ("Cube between bonded plates, small extension: force / (E A strain)", "BondedCube", "",
     {"nu 0.3, 4": 1.0639, "nu 0.45, 4": 1.1727, "nu 0.49, 4": 1.2196}),
    ("Cook's membrane: displacement", "Cook", "", {"nu 0.3, 4": 1.4890, "nu 0.499, 4": 1.4838}),
    ("Beam of two layers, Young moduli 1:100: displacement", "Bilayer", "", {"nu 0.49, 2": 279.2, "nu 0.49, 4": 279.2}),
    ("Cantilever under a large load, P L^2 / E I = 5: deflection / length", "BentCantilever", "",
     {"nu 0.3, 2": 0.7219, "nu 0.49, 2": 0.718}),
    ("The same: axial displacement of the tip / length", "BentCantilever", "shorter, ", {"nu 0.3, 2": 0.3896}),
    ("Cube between bonded plates, compressed by 20 %: force / (E A)", "PressedCube", "",
     {"nu 0.49, 4": -0.300, "nu 0.49, 8": -0.300}),
]


def accuracy(values):
    rows = []
    for case, test, prefix, converged in ACCURACY:
        for name, wanted in converged.items():
            value = values[test][prefix + name]
            ratio, cells = name.split(", ")
            digits = 1 if abs(wanted) > 10 else 4
            rows.append([case, ratio.removeprefix("nu "), cells, f"{value:.{digits}f}", f"{wanted:.{digits}f}",
                         f"{100 * (value / wanted - 1):+.1f} %"])
    return table(["Case", "nu", "Cells across", "DeformVolume", "Converged", "Error"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="replace the tables of the document")
    arguments = parser.parse_args()
    values = measure(arguments.folder)
    text = DOCUMENT.read_text(encoding="utf-8")
    for make in (springs, elements, accuracy):
        made = make(values)
        begin, end = f"<!-- {make.__name__}, by validation.py -->\n", "<!-- -->\n"
        if not arguments.write:
            print(made + "\n")
        head, rest = text.split(begin)
        text = head + begin + made + "\n" + end + rest.split(end, 1)[1]
    if arguments.write:
        DOCUMENT.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
