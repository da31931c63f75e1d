# SPDX-License-Identifier: BSD-3-Clause
"""Compares the tables of presets in Documents/physics.md and in the panels of ParaView with those of the code:
TestMaterialPresets.py SOURCES"""
import pathlib
import re
import sys

from deformvolume_vtk import vtkElasticDeformation, vtkFiniteElementDeformation

sources = pathlib.Path(sys.argv[1])
text = (sources / "Documents" / "physics.md").read_text(encoding="utf-8")
table = re.search(r"^\| `MaterialPreset` \|.*\n\|[-|]+\n((?:\|.*\n)+)", text, re.MULTILINE).group(1)
rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
numbers = range(vtkElasticDeformation.CUSTOM, vtkElasticDeformation.BONE + 1)
assert len(rows) == len(numbers) == 8, rows

for number, (name, *values, source, remark) in zip(numbers, rows):
    assert name.split(",")[0] == vtkElasticDeformation.GetMaterialPresetName(number), name
    assert getattr(vtkElasticDeformation, name.split(",")[0].upper()) == number, name
    assert remark, name
    written = [float(value.replace(",", "")) for value in values]
    if number == vtkElasticDeformation.CUSTOM:
        plain = vtkFiniteElementDeformation()
        of_code = [plain.GetYoungModulus(), plain.GetPoissonRatio(), plain.GetDensity()]
        assert not source, source
    else:
        of_code = [0.0] * 3
        assert vtkElasticDeformation.GetMaterialPresetValues(number, of_code)
        assert source == vtkElasticDeformation.GetMaterialPresetSource(number), source
        # The source is in the list at the end, with its year.
        author, year = source.split()[0], source.split()[-1]
        assert re.search(rf"{author}\b[^;]*\b{year},\s\"", text.split("## Sources")[1]), source
        # Check the units: no tissue is softer than 0.1 kPa, lighter than fat or heavier than bone.
        assert 100 <= of_code[0] <= 3e10 and 0 <= of_code[1] < 0.495 and 900 <= of_code[2] <= 2000, of_code
    assert written == of_code, f"{name}: {written} in the document, {of_code} in the code"

# Panels have the numbers of presets instead of names.
panel = (sources / "Plugin" / "MaterialFromVolume.xml").read_text(encoding="utf-8")
names = re.search(r"and a tissue: ([^.]*)\.", panel).group(1)
wanted = [f"{number} {rows[number][0].lower()}" for number in numbers[1:]]
assert [" ".join(name.split()) for name in names.split(",")] == wanted, names
