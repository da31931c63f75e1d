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
    drift = values["NoDrift"]
    scramble = values["Scramble"]
    bar = values["HangingBar"]
    return table(["Case", "Expected", "Measured"], [
        ["Force of a rigid rotation of 2 rad, for E h^2 = 2.8e3 N", "0",
         f"{values['RigidMotion']['force']:.0e} N"],
        ["Patch of moved nodes with an affine boundary", "error under 1e-12",
         f"{values['Patch']['error']:.0e}"],
        ["Bar 20 % longer: force, in N", "20,000", f"{values['Uniaxial']['force']:,.6f}"],
        ["Axial strain p/E, radial strain -nu p/E (E 1, 2; nu 0, 0.3, 0.49; p +-0.2, +-0.6)", "within 1e-4",
         f"within {values['Pressure']['error']:.1e}"],
        ["Hanging bar, rho g L^2 / 2 E, 40 times as long as thick", "0.49050",
         f"{bar['longer, nu 0']:.5f} (nu 0), {bar['longer, nu 0.3']:.5f} (nu 0.3)"],
        ["Sideways drift of a straight bar under its weight, by its length", "0",
         f"under {max(drift['drift, 2'], drift['drift, 4'], 1e-16):.0e}; {drift['drift, 3']:.1e} for 3 cells across, of "
         "which the mesh is not symmetric"],
        [f"Nodes thrown about in 100 ways, {scramble['fewest inverted']:.0f} or more of 320 tetrahedra inverted",
         "back at rest", f"error {scramble['error']:.0e} m, {scramble['most steps']:.0f} steps at most"],
        ["Elastica, P L^2 / E I = 1, 2, 5, 10: deflection", "0.3017, 0.4935, 0.7138, 0.8106",
         listed(values["Elastica"], [f"load {load}" for load in (1, 2, 5, 10)], 4) + " with 4 cells across"],
        ["The same: how much shorter", "0.0564, 0.1606, 0.3876, 0.5550",
         listed(values["Elastica"], [f"shorter, load {load}" for load in (1, 2, 5, 10)], 4) + " with 4 cells across"],
    ])


def cantilever(values):
    both = {**values["Cantilever"], **values["CantileverOfEightCells"]}
    cells = (1, 2, 4, 8)
    return table(["Cells across the thickness", *map(str, cells)],
                 [[f"nu = {ratio}", *(f"{both[f'nu {ratio}, {n}']:.3f}" for n in cells)] for ratio in ("0.3", "0.49")])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="put the tables into the document")
    arguments = parser.parse_args()
    values = measure(arguments.folder)
    text = DOCUMENT.read_text(encoding="utf-8")
    for make in (springs, elements, cantilever):
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
