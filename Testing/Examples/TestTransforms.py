# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume deforms a volume by transforms of SimpleITK as SimpleITK's resampling does.
Usage: TestTransforms.py PROGRAM FOLDER"""
import itertools
import os

import numpy
import Readers
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti

program, path = begin_test("Transforms")


def write(name, text):
    with open(path(name), "w", encoding="ascii") as file:
        file.write(text)


Readers.run("Transforms.py", path())


# A file that cannot be used is an error that states the reason, and a program that converts the file.
def fails(expected, *options, volume="moving.nii.gz", code=1):
    _, errors = call(program, path(volume), *options, "-o", path("no.vti"), code=code)
    assert errors.startswith("deform-volume: "), errors
    assert expected in errors, f"{expected} is not in {errors}"
    assert not os.path.exists(path("no.vti"))


matrix = "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
write("flirt.mat", matrix)
write("aladin.txt", matrix)
write("some.lta", "type = 0\n")
write("register.dat", "subject\n1.0\n1.0\n0.15\n" + matrix + "round\n")
write("mni.xfm", "MNI Transform File\n")
write("warp.m3z", "x")
write("TransformParameters.0.txt", "// by elastix\n\n(Transform \"AffineTransform\")\n")
write("empty.txt", "")
write("words.tfm", "some words\n")
write("broken.h5", "x")
with open(path("affine.tfm"), encoding="ascii") as file:
    one = file.read()
write("two.tfm", one + one.split("\n", 1)[1].replace("#Transform 0", "#Transform 1"))
write("thin.tfm", one.replace("AffineTransform_", "ThinPlateSplineKernelTransform_"))
# A file that is cut off.
write("cut.tfm", one[:one.index("FixedParameters")])
write("cut.txt", one[:one.index("Parameters:")])
with open(path("composite.tfm"), encoding="ascii") as file:
    several = file.read()
write("within.tfm", several[:several.index("FixedParameters")])
write("words.xyz", "some words\n")
write_vti(make_ball(), path("unknown.vti"))
for name, words in {
        "missing.h5": "there is no such file",
        "flirt.mat": "-fsl2ras -oitk",
        "aladin.txt": "c3d_affine_tool",
        "some.lta": "lta_convert --inlta",
        "register.dat": "lta_convert --inreg",
        "mni.xfm": "lta_convert --inmni",
        "warp.m3z": "mri_warp_convert --inm3z",
        "TransformParameters.0.txt": "transformix -def all",
        "empty.txt": "it is damaged, or holds no transform",
        "words.tfm": "it is damaged, or holds no transform",
        "thin.tfm": "it holds ThinPlateSplineKernelTransform_double_3_3, a type",
        "cut.tfm": 'A line "FixedParameters:" of a transform is missing',
        "cut.txt": 'A line "Parameters:" of a transform is missing',
        "within.tfm": 'A line "FixedParameters:" of a transform is missing',
        "broken.h5": "it is damaged, or holds no transform",
        "two.tfm": "it holds 2 transforms",
        "planar.tfm": "AffineTransform_double_2_2",
        "words.xyz": "a transform is a .h5",
        "spline.h5,invert": "a BSplineTransform cannot be inverted",
        "warp.nii.gz,invert": "the file InverseWarp"}.items():
    fails(words, "--transform", path(name))
fails("write FILE,invert", "--transform", f"[{path('warp.mha')},1]", code=2)  # as for ANTs
affine = ("--transform", path("affine.h5"))
fails("--volume-space", *affine, volume="unknown.vti")
fails("expected FILE or FILE,invert", "--transform", path("affine.h5,inverse"), code=2)
fails("exactly one of", *affine, "--field", path("warp.nii.gz"), code=2)
fails("exactly one of", *affine, "--lattice", "3,3,3", code=2)
fails("--push requires", *affine, "--push", "1,2,3,4,5,6,7", code=2)
fails("excludes", *affine, "--file-coordinates", code=2)
fails("excludes", "--lattice", "3,3,3", "--push", "1,2,3,4,5,6,7", "--reference", path("fixed.mha"),
      "--bounds", "volume", code=2)
fails("excludes", *affine, "--reference", path("fixed.mha"), "--padding", "2", code=2)
fails("there is no such file", *affine, "--reference", path("missing.mha"))
fails("has the grid of the volume", *affine, "--bounds", "deformed", code=2)
_, errors = call(program, path("moving.nii.gz"), *affine, "-o", path("affine.h5"), code=2)
assert "nothing to write" in errors or "must end in" in errors, errors
_, errors = call(program, path("moving.mha"), "--volume-space", "ras", *affine, "-o", path("a.vti"), "-q")
assert "states that" in errors, errors

# Errors: single precision of the field, with coordinates up to 50, and of the values, which are noise.
expected = numpy.load(path("expected.npz"))


def check(volume, name, *files, reference=None):
    options = list(itertools.chain.from_iterable(("--transform", path(file)) for file in files))
    if reference:
        options += ["--reference", path(reference)]
    # The file of labels is in the other world, if its format has one.
    labels = path("labels.mha" if volume.endswith(".nii.gz") else "labels.nii.gz")
    call(program, path(volume), *options, "-q", "-o", path("out.vti"), "--label-volume", labels,
         "--label-output", path("labels.vti"))
    image = read_vti(path("out.vti"))
    values, covered = get_values(image), get_values(image, "vtkValidPointMask") != 0
    parts = get_values(read_vti(path("labels.vti")))
    depth = expected["depth of " + name]
    assert covered[depth > 0.001].all(), (name, "voxels inside the volume are not covered")
    assert not covered[depth < -0.01].any(), (name, "voxels outside the volume are covered")
    assert (depth > 0.001).sum() > (2000 if reference else 5000), (name, (depth > 0.001).sum())
    inside = depth > 0.001
    wrong = numpy.abs(values - expected[name])[inside].max()
    # VTK's interpolator of fields moves a point by up to 2^-16 voxel, where vectors differ by up to
    # 7 mm from voxel to voxel, and values by up to 7 in 1 mm.
    allowed = 2e-5 + (49 * 2.0 ** -16 if any(file.startswith("warp") for file in files) else 0)
    assert wrong < allowed, (volume, name, files, wrong)
    # Labels are not compared where a shift of the point by 2^-16 voxel changes the nearest voxel.
    decided = inside & (expected["margin of " + name] > 0.001)
    assert numpy.array_equal(parts[decided], expected["labels of " + name][decided]), (volume, name)
    assert decided.sum() > 0.98 * inside.sum(), (name, decided.sum(), inside.sum())
    assert not parts[~covered].any(), (volume, name)


formats = ("h5", "tfm", "txt", "mat")
names = ("affine", "versor", "euler", "spline", "quadratic", "displacement", "composite", "nested", "rotations")
for name, suffix in itertools.product(names, formats):
    if os.path.exists(path(f"{name}.{suffix}")):
        # The world of the volume alternates between RAS and LPS.
        volume = ("moving.nii.gz", "moving.mha")[formats.index(suffix) % 2]
        check(volume, name, f"{name}.{suffix}")
    else:
        assert suffix not in ("h5", "tfm"), (name, suffix)
check("moving.mha", "affine", "c3d.txt")
check("moving.nrrd", "affine,invert", "affine.mat,invert")
for volume in ("moving.nii.gz", "moving.mha"):
    check(volume, "displacement", "warp.nii.gz")
    check(volume, "displacement", "warp.mha")
    check(volume, "euler+affine", "euler.h5", "affine.tfm")
    check(volume, "affine,invert+warp", "affine.mat,invert", "warp.nii.gz")
    check(volume, "warp+affine", "warp.nii.gz", "affine.mat")

# The border of --padding is filled by the transform, as with a reference image of that grid.
padded = ("-q", "-o", path("padded.vti"), "-o", path("padded.mha"))
call(program, path("moving.mha"), *affine, "--padding", "4", "--background", "9", *padded)
border = read_vti(path("padded.vti"))
call(program, path("moving.mha"), *affine, "--reference", path("padded.mha"), "--background", "9", "-q", "-o",
     path("referred.vti"))
covered = get_values(border, "vtkValidPointMask") != 0
assert covered.sum() > covered[4:-4, 4:-4, 4:-4].sum()
referred = read_vti(path("referred.vti"))
assert (get_values(referred, "vtkValidPointMask") != covered).mean() < 1e-4
numpy.testing.assert_allclose(get_values(border)[covered], get_values(referred)[covered], rtol=0, atol=1e-4)

# Results on the grid of the fixed image, in both worlds, and on a mirrored grid.
for grid, suffix in itertools.product(("fixed", "mirrored"), (".nii.gz", ".mha")):
    volume = {".nii.gz": "moving.mha", ".mha": "moving.nii.gz"}[suffix]
    check(volume, f"affine on {grid}", "affine.h5", reference=grid + suffix)
    check(volume, f"spline on {grid}", "spline.h5", reference=grid + suffix)
    check(volume, f"warp+affine on {grid}", "warp.nii.gz", "affine.mat", reference=grid + suffix)
