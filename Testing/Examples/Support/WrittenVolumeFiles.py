# SPDX-License-Identifier: BSD-3-Clause
"""Reads with SimpleITK, pynrrd and nibabel the files that deform-volume has written, and compares with written.json.
Usage, with the Python that "Testing/packages.sh readers" installs: WrittenVolumeFiles.py FOLDER"""
import json
import os
import sys

import nibabel
import nrrd
import numpy
import SimpleITK

folder = sys.argv[1]
flip = numpy.diag([-1.0, -1.0, 1.0, 1.0])


def read_itk(name):
    image = SimpleITK.ReadImage(name)
    place = numpy.eye(4)
    place[:3, :3] = numpy.array(image.GetDirection()).reshape(3, 3) * image.GetSpacing()
    place[:3, 3] = image.GetOrigin()
    return SimpleITK.GetArrayFromImage(image), place


def read_nrrd(name):
    values, header = nrrd.read(name)
    assert header["space"] == "left-posterior-superior", header["space"]
    directions = header["space directions"]
    place = numpy.eye(4)
    place[:3, :3] = directions[~numpy.isnan(directions).any(axis=1)].T
    place[:3, 3] = header["space origin"]
    values = numpy.moveaxis(values, 0, 3) if values.ndim == 4 else values
    return values.transpose(2, 1, 0, *range(3, values.ndim)), place


def read_nifti(name, source, padding):
    image = nibabel.load(name)
    header = image.header
    assert header.get_xyzt_units()[0] == "mm", header.get_xyzt_units()[0]
    assert numpy.isnan(header["scl_slope"]) or header["scl_slope"] in (0, 1)
    if ".nii" in source:
        # The file has both forms of the source, with their codes.
        old = nibabel.load(os.path.join(folder, source)).header
        for code in ("sform_code", "qform_code"):
            assert header[code] == old[code], (name, header[code], old[code])
        if header["qform_code"]:
            scale = {1: 1000, 2: 1, 3: 0.001, 0: 1}[int(old["xyzt_units"]) & 7]
            expected = old.get_qform()
            expected[:3] *= scale
            expected[:3, 3] -= expected[:3, :3] @ ([padding] * 3)
            assert numpy.allclose(header.get_qform(), expected, rtol=1e-6, atol=1e-6 * scale), name
    values = numpy.asanyarray(image.dataobj)
    if values.dtype.fields:
        values = numpy.stack([values[name] for name in values.dtype.names], axis=-1)
    if values.ndim == 5:
        values = values[:, :, :, 0]
        assert SimpleITK.ReadImage(name).GetNumberOfComponentsPerPixel() == values.shape[3], name
    return values.transpose(2, 1, 0, *range(3, values.ndim)), image.affine


def compare(name, values, place, expected, expected_place):
    change = numpy.linalg.inv(expected_place) @ place
    corners = numpy.array([[x, y, z, 1] for z in (0, values.shape[0] - 1) for y in (0, values.shape[1] - 1)
                           for x in (0, values.shape[2] - 1)])
    assert values.dtype == expected.dtype, (name, values.dtype, expected.dtype)
    assert numpy.array_equal(values, expected), name
    assert numpy.abs(corners @ (change.T - numpy.eye(4))).max() < 1e-4, (name, change)


with open(os.path.join(folder, "written.json"), encoding="utf-8") as file:
    for case in json.load(file):
        expected, place = numpy.load(os.path.join(folder, case["values"])), numpy.array(case["place"])
        in_ras = flip @ place if case["ras"] is False else place
        in_lps = flip @ place if case["ras"] else place
        for name in case["outputs"]:
            if ".again.nii" in name or "shifted.nii" in name:
                compare(name, *read_nifti(name, case["file"], case["padding"]), expected, in_ras)
            else:
                compare(name, *read_itk(name), expected, in_lps)
            if name.endswith("nrrd") or name.endswith("nhdr"):
                compare(name, *read_nrrd(name), expected, in_lps)
