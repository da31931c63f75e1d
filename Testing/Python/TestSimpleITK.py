# SPDX-License-Identifier: BSD-3-Clause
"""Compares deformvolume.sitk with SimpleITK.Resample. FOLDER contains the package.
Usage, with the Python that "Testing/packages.sh readers" installs: TestSimpleITK.py FOLDER"""
import sys

import numpy as np
import SimpleITK as sitk

sys.path.insert(0, sys.argv[1])

import deformvolume as dv  # noqa: E402
import deformvolume.sitk as ds  # noqa: E402

random = np.random.default_rng(1)
TURNED = (0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1)


def make_image(values, origin, spacing, direction=TURNED, is_vector=False):
    image = sitk.GetImageFromArray(values, isVector=is_vector)
    image.SetOrigin(origin)
    image.SetSpacing(spacing)
    image.SetDirection(direction)
    return image


def expect(kind, text, call):
    try:
        call()
    except kind as error:
        assert text in str(error), error
        return
    raise AssertionError(f'no {kind.__name__} with "{text}" was raised')


image = make_image(random.normal(size=(20, 25, 30)).astype("f4"), (-5, 7, 3), (1.5, 2.0, 2.5))
# The field is larger than the image on all sides.
field = make_image(0.7 * random.normal(size=(8, 9, 10, 3)), (-20, -10, -20), (12.0, 13.0, 14.0), is_vector=True)
fixed = make_image(np.zeros((22, 27, 18), "u1"), (-30, 56, 7), (1.9, 2.1, 1.8), (0, 1, 0, -1, 0, 0, 0, 0, 1))

expect(ValueError, "2 dimensions", lambda: ds.deform(sitk.Image(4, 4, sitk.sitkUInt8), field))
expect(ValueError, "three components", lambda: ds.deform(image, image))
expect(TypeError, "Give a Mesh or a Field", lambda: ds.deform(image, "field"))
expect(TypeError, "Euler3DTransform", lambda: ds.deform(image, sitk.Euler3DTransform()))
expect(TypeError, "complex64", lambda: ds.deform(sitk.Image(4, 4, 4, sitk.sitkComplexFloat32), field))
label_map = sitk.LabelImageToLabelMap(sitk.Cast(image, sitk.sitkUInt8))
expect(TypeError, "The image is a label map", lambda: ds.deform(label_map, field))
expect(TypeError, "The displacement field is a label map", lambda: ds.deform(image, label_map))
expect(TypeError, "The reference is a ndarray", lambda: ds.deform(image, field, reference=np.eye(4)))
flat = sitk.DisplacementFieldTransform(sitk.Image([4, 4], sitk.sitkVectorFloat64))
expect(ValueError, "2 dimensions", lambda: ds.deform(image, flat))

for pixels in (1, 2):
    vector = sitk.Image([10, 9, 8], sitk.sitkVectorUInt16, pixels)
    deformed = ds.deform(vector, field)
    assert deformed.GetPixelID() == vector.GetPixelID() and deformed.GetNumberOfComponentsPerPixel() == pixels

for reference in (None, fixed):
    for interpolation, wanted in (("linear", sitk.sitkLinear), ("nearest", sitk.sitkNearestNeighbor)):
        transform = sitk.DisplacementFieldTransform(sitk.Image(field))
        theirs = sitk.Resample(image, reference or image, transform, wanted, -9.0)
        ours = ds.deform(image, field, reference=reference, interpolation=interpolation, background=-9.0)
        assert ours.GetSize() == theirs.GetSize() and ours.GetPixelID() == theirs.GetPixelID()
        for get in ("GetOrigin", "GetSpacing", "GetDirection"):
            assert np.allclose(getattr(ours, get)(), getattr(theirs, get)(), rtol=0, atol=1e-12), get
        a, b = sitk.GetArrayFromImage(ours), sitk.GetArrayFromImage(theirs)
        # SimpleITK extends the image by half a voxel on each side.
        inside = (a != -9.0) & (b != -9.0)
        assert inside.sum() > 1000 and not ((a != -9.0) & (b == -9.0)).any()
        error = abs(a - b)[inside]
        print(interpolation, "reference" if reference else "image", inside.sum(), error.max(), (error > 1e-4).mean())
        if interpolation == "linear":
            assert error.max() < 1e-4, error.max()
        else:
            # Labels may differ at points where two voxels are equally near.
            assert (error > 0).mean() < 1e-3, (error > 0).mean()

shift = np.tile([3.0, 0.0, 0.0], (2, 2, 2, 1))

# The result of an inverse Field has the grid of the image, too.
ours = ds.deform(image, dv.Field(shift, np.diag([200.0, 200.0, 200.0, 1.0]), inverse=True))
assert ours.GetSize() == image.GetSize() and np.allclose(ours.GetOrigin(), image.GetOrigin()), ours.GetSize()

# A forward field: a shift moves the image.
box = sitk.GetImageFromArray(np.pad(np.full((4, 4, 4), 200, "u1"), 8))
moved = ds.deform(box, dv.Field(shift, np.diag([19.0, 19.0, 19.0, 1.0])))
x = moved.TransformPhysicalPointToIndex((12.0, 10.0, 10.0))
assert moved[x] == 200 and moved.GetPixelID() == sitk.sitkUInt8
dose = ds.deform(box, dv.Field(shift, np.diag([19.0, 19.0, 19.0, 1.0])), background=7.0, density=True)
assert dose.GetPixelID() == sitk.sitkFloat32 and np.isclose(sitk.GetArrayFromImage(dose).sum(), 64 * 200.0)
colors = sitk.Compose(box, box, box)
assert ds.deform(colors, dv.Field(shift, np.diag([19.0, 19.0, 19.0, 1.0])))[x] == (200, 200, 200)

# Landmarks of the fixed image move as SimpleITK's transform moves them, and back.
landmarks = random.uniform((0, 20, 10), (20, 40, 40), (50, 3))
transform = sitk.DisplacementFieldTransform(sitk.Image(field))
theirs = [transform.TransformPoint(point) for point in landmarks.tolist()]
converted = ds.make_field(transform)
ours = dv.deform_points(landmarks, converted, inverse=True).points
assert abs(ours - landmarks).max() > 0.5 and np.allclose(ours, theirs, rtol=0, atol=1e-9), abs(ours - theirs).max()
assert np.allclose(dv.deform_points(ours, converted).points, landmarks, rtol=0, atol=1e-6)
assert not ds.make_field(field, inverse=False).inverse
expect(ValueError, "three components", lambda: ds.make_field(image))
# The Field has its own memory: that of the image or of the transform is freed.
expected = sitk.GetArrayFromImage(field).transpose(2, 1, 0, 3)
for make in (sitk.Image, lambda image: sitk.DisplacementFieldTransform(sitk.Image(image))):
    converted = ds.make_field(make(field))
    others = [np.full_like(expected, -7.0) for _ in range(3)]
    assert np.array_equal(converted.vectors, expected)
print("all tests passed")
