#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the tables of measured values in Documents/physics.md anew.

    python3 Testing/Kernels/validation.py FOLDER [--write]

FOLDER has the tests of the engine (build/vtk/bin). Some are run, which takes some 20 seconds, and the tables are
printed. With --write they take the place of those in the document.
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
    "TestFiniteElements": "*Scramble",
    "TestFiniteElementBeams": "*",
}


def measure(folder):
    """What the tests have recorded: {test: {name: value}}. Ends where one fails."""
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
        ["Young modulus of a bar of 8 x 8 x 8 cubes, Poisson ratio 0.25, 0.40, 0.45", "1",
         listed(lattice, [f"E, {ratio}" for ratio in ratios], 3)],
        ["Poisson ratio of the same inside", "0.25, 0.40, 0.45",
         listed(lattice, [f"nu, {ratio}" for ratio in ratios], 3)],
        ["10,000 steps of the stable one and of 1.7 of it", "stable; diverges", "stable; diverges, and says so"],
        ["Forces of a body at rest", "0", "0"],
        ["Period of a node on springs", "2 pi sqrt(m/k)",
         f"within {100 * values['PeriodOfASpring']['period']:.1g} %"],
        ["Fall of a free body", "g t (t + dt) / 2", f"within {100 * values['FreeFall']['fall']:.1g} %"],
    ])


def elements(values):
    scramble = values["Scramble"]
    bar = values["HangingBar"]
    return table(["Case", "Expected", "Measured"], [
        ["Force of a rigid rotation of 2 rad, for E h^2 = 2.8e3 N", "0",
         f"{values['RigidMotion']['force']:.0e} N"],
        ["Patch of moved nodes with an affine boundary, both laws", "error under 1e-11",
         f"{values['Patch']['error']:.0e}"],
        ["Neo-Hookean cube under tension and pressure, along one axis and two: stretches 0.6 to 2, nu 0.3, 0.45, 0.49",
         "stretches within 1e-6",
         f"within {max(values['Uniaxial']['error'], values['Equibiaxial']['error']):.0e}"],
        ["Neo-Hookean simple shear g up to 1, nu 0.3, 0.45, 0.49", "stresses mu g and mu g^2", "within 1e-8 Pa"],
        ["Hanging bar, rho g L^2 / 2 E, 40 times as long as thick", "4.9050e-04",
         f"{bar['longer, nu 0']:.4e} (nu 0), {bar['longer, nu 0.3']:.4e} (nu 0.3)"],
        ["Sideways drift of a straight bar under its weight, by its length", "0",
         f"{values['NoDrift']['drift']:.0e}"],
        [f"Nodes thrown about in 100 ways, {scramble['fewest inverted']:.0f} or more of 40 tetrahedra inverted",
         "back at rest", f"error {scramble['error']:.0e} m, {scramble['most steps']:.0f} steps at most"],
    ])


# Case, test, prefix of its names, converged values by the names.
ACCURACY = [
    ("Cantilever, 10 times as long as thick: deflection by Euler and Bernoulli's", "Cantilever", "",
     {"nu 0.3, 1": 1.0010, "nu 0.3, 2": 1.0010, "nu 0.45, 1": 0.9927, "nu 0.45, 2": 0.9927, "nu 0.49, 1": 0.9895,
      "nu 0.49, 2": 0.9895}),
    ("Cube between bonded plates that part a little: force / (E A strain)", "BondedCube", "",
     {"nu 0.3, 4": 1.0639, "nu 0.45, 4": 1.1727, "nu 0.49, 4": 1.2196}),
    ("Cook's membrane: displacement", "Cook", "", {"nu 0.3, 4": 1.4890, "nu 0.499, 4": 1.4838}),
    ("Beam of two layers, 1:100: displacement", "Bilayer", "", {"nu 0.49, 2": 279.2, "nu 0.49, 4": 279.2}),
    ("Cantilever bent far, P L^2 / E I = 5: deflection / length", "BentCantilever", "",
     {"nu 0.3, 2": 0.7219, "nu 0.49, 2": 0.718}),
    ("The same: how much shorter", "BentCantilever", "shorter, ", {"nu 0.3, 2": 0.3896}),
    ("Cube between bonded plates, pressed by 20 %: force / (E A)", "PressedCube", "",
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
    return table(["Case", "nu", "Cells across", "Here", "Converged", "Off"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="put the tables into the document")
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
