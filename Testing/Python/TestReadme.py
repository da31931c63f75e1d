# SPDX-License-Identifier: BSD-3-Clause
"""The lines of Python in README.md, and in that of the package, as they stand there: TestReadme.py SOURCE PACKAGE, where
PACKAGE is the folder that has the package deformvolume."""
import re
import sys
import types

import numpy

sys.path.insert(0, sys.argv[2])


def read_blocks(name):
    text = open(f"{sys.argv[1]}/{name}", encoding="utf-8").read()
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run(block):
    names = {}
    exec(compile(block, "README", "exec"), names)  # pylint: disable=exec-used
    return names


# The package, with a head in place of a file.
saved = []
nibabel = types.ModuleType("nibabel")
nibabel.load = lambda name: types.SimpleNamespace(
    dataobj=numpy.ones((181, 217, 181), numpy.uint8), affine=numpy.diag([-1.0, 1.0, 1.0, 1.0])
)
nibabel.Nifti1Image = lambda array, affine: (array, affine)
nibabel.save = lambda image, name: saved.append(image)
sys.modules["nibabel"] = nibabel
of_package, of_classes = read_blocks("README.md")
result = run(of_package)["result"]
((array, affine),) = saved
assert array is result.array and array.dtype == numpy.uint8
# The front has gone back by 20 voxels in the middle, and by nothing at the sides.
front = result.coverage[90, :, 90].nonzero()[0].max(), result.coverage[1, :, 1].nonzero()[0].max()
assert front[0] in range(195, 198) and front[1] in range(214, 217), front
(of_readme,) = read_blocks("Python/README.md")
assert run(of_readme)["result"].coverage.sum() > 60**3

names = run(of_classes)
rest = names["volume"].GetOutput()
result = names["result"]
# Bent to one side by up to 5 voxels at both ends: 21 voxels on each axis become 26 or 27 on x.
assert rest.GetDimensions() == (21, 21, 21)
low, high = result.GetBounds()[:2]
assert (low, high) == (-10, 15), (low, high)
assert names["deform"].GetNumberOfCoveredVoxels() > 0.95 * 21 ** 3
assert names["deform"].GetNumberOfInvertedTetrahedra() == 0
