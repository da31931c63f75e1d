# SPDX-License-Identifier: BSD-3-Clause
"""Checks the documents: targets of links exist, options in commands exist, and their Python code runs.
TestReadme.py SOURCE PACKAGE, where PACKAGE is the folder that contains the package deformvolume."""
import importlib.util
import pathlib
import re
import sys
import tempfile
import types

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkContourFilter

source = pathlib.Path(sys.argv[1])
sys.path.insert(0, sys.argv[2])


def read(path):
    return path.read_text(encoding="utf-8")


def read_blocks(name, language):
    pattern = rf"^```{language}\n(.*?)^```$"
    return re.findall(pattern, read(source / name), re.MULTILINE | re.DOTALL)


def run(block):
    names = {}
    exec(compile(block, "README", "exec"), names)  # pylint: disable=exec-used
    return names


# Links, and the anchors that GitHub makes of headings. Web pages are not visited.
documents = sorted([*source.glob("*.md"), *source.glob("Documents/*.md"), *source.glob("Python/*.md")])
assert len(documents) > 15, documents


def anchors(path):
    text = re.sub(r"^```.*?^```$", "", read(path), flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


broken = []
for document in documents:
    text = re.sub(r"^```.*?^```$", "", read(document), flags=re.MULTILINE | re.DOTALL)
    links = re.findall(r"\]\(([^()\s]+(?:\([^()\s]*\))?)\)", re.sub(r"`[^`]*`", "", text))
    for link in links:
        if re.match(r"https?://", link):
            continue
        file, _, anchor = link.partition("#")
        target = (document.parent / file).resolve() if file else document
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(f"{document.relative_to(source)}: {link}")
assert not broken, "\n".join(broken)
pages = {page.name for page in source.glob("Documents/*.md")} - {"README.md"}
unlisted = [page for page in sorted(pages) if f"({page})" not in read(source / "Documents/README.md")]
assert not unlisted, f"Documents/README.md does not list {unlisted}"

# A folder of the engine uses only the folders above it in the table of architecture.md.
engine = read(source / "Documents/architecture.md").partition("## The engine\n")[2]
table = engine.partition("| Folder |")[2].partition("\n\n")[0]
folders = re.findall(r"^\| (\w+) \|", table, re.MULTILINE)
headers = {path.name: path.parent.name for path in source.glob("Kernels/*/*.h")}
assert set(headers.values()) <= set(folders), f"architecture.md does not list {set(headers.values()) - set(folders)}"
for path in [*source.glob("Kernels/*/*.cxx"), *source.glob("Kernels/*/*.h")]:
    for header in re.findall(r'^#include "(\w+\.h)"', read(path), re.MULTILINE):
        used = headers.get(header, folders[0])
        is_above = folders.index(used) <= folders.index(path.parent.name)
        assert is_above, f"{path.relative_to(source)} includes {header} of {used}"

# The version that is cited.
version = re.search(r"project\(DeformVolume VERSION ([\d.]+)", read(source / "CMakeLists.txt"))[1]
assert f"\nversion: {version}\n" in read(source / "CITATION.cff"), version

# Options of deform-volume in commands.
program = "".join(read(path) for path in source.glob("Examples/deform-volume/*.cxx"))
for document in documents:
    for block in read_blocks(document.relative_to(source), "sh"):
        for command in re.findall(r"^deform-volume (?:.*\\\n)*.*$", block, re.MULTILINE):
            for option in re.findall(r"(?<=\s)--[a-z-]+", command):
                assert re.search(rf'{option}[",]', program), f"{document}: {option} in {command}"

# The package deformvolume. A synthetic head replaces the file.
saved = []
nibabel = types.ModuleType("nibabel")
nibabel.load = lambda name: name
nibabel.as_closest_canonical = lambda name: types.SimpleNamespace(
    shape=(181, 217, 181),
    dataobj=numpy.ones((181, 217, 181), numpy.uint8),
    affine=numpy.diag([-1.0, 1.0, 1.0, 1.0]),
)
nibabel.Nifti1Image = lambda array, affine: (array, affine)
nibabel.save = lambda image, name: saved.append(image)
sys.modules["nibabel"] = nibabel
(of_package,) = read_blocks("README.md", "python")
result = run(of_package)["result"]
((array, affine),) = saved
assert array is result.array and array.dtype == numpy.uint8
# The front has moved back by 20 voxels in the middle, and not at the sides.
front = result.coverage[90, :, 90].nonzero()[0].max(), result.coverage[1, :, 1].nonzero()[0].max()
assert front[0] in range(195, 198) and front[1] in range(214, 217), front
of_readme, of_pyvista = read_blocks("Python/README.md", "python")
assert run(of_readme)["result"].coverage.sum() > 60**3
if importlib.util.find_spec("pyvista"):
    names = run(of_pyvista)
    names["move"](0.2)
    assert names["kept"].GetNumberOfCoveredVoxels() > 65**3
else:
    compile(of_pyvista, "README", "exec")

# The C++ classes.
of_classes, of_surfaces = read_blocks("Documents/deformation.md", "python")
names = run(of_classes)
rest = names["volume"].GetOutput()
result = names["result"]
# The volume is bent to one side by up to 5 voxels at both ends: 21 voxels on each axis become 26 or 27 on x.
assert rest.GetDimensions() == (21, 21, 21), rest.GetDimensions()
low, high = result.GetBounds()[:2]
assert (low, high) == (-10, 15), (low, high)
assert names["deform"].GetNumberOfCoveredVoxels() > 0.95 * 21 ** 3
assert names["deform"].GetNumberOfInvertedTetrahedra() == 0, names["deform"].GetNumberOfInvertedTetrahedra()
# Its surface: an isosurface of the volume at rest, bent in the same way.
names["contour"] = vtkContourFilter()
names["contour"].SetInputConnection(names["volume"].GetOutputPort())
names["contour"].SetValue(0, 150)
exec(compile(of_surfaces, "README", "exec"), names)  # pylint: disable=exec-used
names["surface"].Update()
before, after = names["contour"].GetOutput().GetBounds(), names["surface"].GetOutput().GetBounds()
assert after[1] > before[1] + 2 and after[2:] == before[2:], (before, after)

# A body under gravity, and with a handle.
of_body = read_blocks("Documents/physics.md", "python")[0]
names = run(of_body)
nodes = names["body"].GetOutput()
displacements = vtk_to_numpy(nodes.GetPointData().GetArray("Displacement"))
top = nodes.FindPoint(0, 0, 10)
assert abs(displacements[top][0] - 3) < 1e-6, displacements[top]
covered = names["deform"].GetNumberOfCoveredVoxels()
assert 8000 < covered < 9000, covered  # of 9261: the body moves away from its upper side

# ChainMail with materials: the voxels of the handle take the others along.
(of_materials,) = read_blocks("Documents/chainmail.md", "python")
exec(compile(of_materials, "README", "exec"), names)  # pylint: disable=exec-used
names["chain_mail"].Update()
assert names["chain_mail"].GetNumberOfMovedVoxels() > 27 and names["chain_mail"].GetNumberOfMaterials() == 6

# The sheet of a cut.
with tempfile.TemporaryDirectory() as folder:
    (of_sheet,) = read_blocks("Documents/deform-volume.md", "python")
    sheet = pathlib.Path(folder, "sheet.vtp")
    run(of_sheet.replace("sheet.vtp", str(sheet)))
    assert sheet.exists()
