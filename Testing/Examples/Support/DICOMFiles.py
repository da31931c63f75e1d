# SPDX-License-Identifier: BSD-3-Clause
"""Writes DICOM series with pydicom. cases.json lists the series that can be read, with the names of arrays
[z, y, x(, component)] that SimpleITK reads from them. wrong.json lists the series that cannot be read: [folder,
words of the error]. Usage, with the Python that "Testing/packages.sh readers" installs: DICOMFiles.py FOLDER"""
import json
import os
import shutil
import sys
import warnings

import nibabel
import numpy
import pydicom
import SimpleITK
from pydicom import uid
from Rotation import turn

warnings.simplefilter("ignore")  # warnings of pydicom about values that these files have on purpose
SimpleITK.ProcessObject.SetGlobalWarningDisplay(False)
folder = sys.argv[1]
package = os.path.join(os.path.dirname(pydicom.__file__), "data", "test_files")
random = numpy.random.default_rng(7)
cases, wrong = [], []


def path(*names):
    return os.path.join(folder, *names)


straight, oblique = numpy.eye(3), turn(2, 30) @ turn(0, -20)


def write(name, count=5, kind="int16", axes=straight, step=2.5, image=uid.CTImageStorage, change=None,
          syntax=uid.ExplicitVRLittleEndian, names="{:03}.dcm", order=range(99), description="head"):
    """Writes a series of slices of 8 columns and 6 rows, with a spacing of 0.9 and 0.7 mm. change(data, number)
    changes the data set of a slice before it is written."""
    os.makedirs(path(name), exist_ok=True)
    series = uid.generate_uid()
    for number in range(count):
        data = pydicom.Dataset()
        data.file_meta = pydicom.dataset.FileMetaDataset()
        data.file_meta.TransferSyntaxUID = syntax
        data.SOPClassUID, data.SOPInstanceUID = image, uid.generate_uid()
        data.SeriesInstanceUID, data.SeriesDescription = series, description
        data.ImagePositionPatient = [f"{x:.10g}" for x in (-10, -20, 30) + axes[:, 2] * step * number]
        data.ImageOrientationPatient = [f"{x:.10g}" for x in axes[:, :2].T.ravel()]
        data.PixelSpacing, data.Rows, data.Columns = [0.7, 0.9], 6, 8
        data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
        dtype = numpy.dtype(kind)
        data.BitsAllocated = data.BitsStored = 8 * dtype.itemsize
        data.HighBit, data.PixelRepresentation = data.BitsStored - 1, int(dtype.kind == "i")
        limits = numpy.iinfo(dtype)
        pixels = random.integers(limits.min, limits.max, (6, 8), dtype=dtype, endpoint=True)
        order_of_bytes = ">" if syntax == uid.ExplicitVRBigEndian else "<"
        data.PixelData = pixels.astype(dtype.newbyteorder(order_of_bytes)).tobytes()
        data["PixelData"].VR = "OB" if dtype.itemsize == 1 else "OW"
        if change:
            change(data, number)
        data.save_as(path(name, names.format(order[number])), enforce_file_format=True)


def read(name):
    """Returns the values and the index-to-world matrix as pydicom reads them. The values are None if pydicom has no
    decoder for them."""
    slices = [pydicom.dcmread(path(name, file)) for file in os.listdir(path(name)) if "dcm" in file
              or "IM" in file]
    slices = [data for data in slices if "PixelData" in data and data.SOPClassUID != uid.RTDoseStorage]
    row, column = numpy.array(slices[0].ImageOrientationPatient, float).reshape(2, 3)
    positions = [numpy.array(data.ImagePositionPatient, float) for data in slices]
    order = numpy.argsort(positions @ numpy.cross(row, column))
    positions = [positions[i] for i in order]
    place = numpy.eye(4)
    place[:3, 0] = row * float(slices[0].PixelSpacing[1])
    place[:3, 1] = column * float(slices[0].PixelSpacing[0])
    place[:3, 2] = (positions[-1] - positions[0]) / (len(positions) - 1)
    place[:3, 3] = positions[0]
    try:
        pixels = numpy.stack([slices[i].pixel_array for i in order])
    except RuntimeError:
        return None, place
    slopes = numpy.array([[float(slices[i].get("RescaleSlope", 1)), float(slices[i].get(
        "RescaleIntercept", 0))] for i in order]).reshape(-1, 2, *[1] * (pixels.ndim - 1))
    return pixels * slopes[:, 0] + slopes[:, 1], place


def read_itk(name):
    reader = SimpleITK.ImageSeriesReader()
    series = [reader.GetGDCMSeriesFileNames(path(name), one) for one in reader.GetGDCMSeriesIDs(path(name))]
    reader.SetFileNames(max(series, key=len))
    image = reader.Execute()
    place = numpy.eye(4)
    place[:3, :3] = numpy.array(image.GetDirection()).reshape(3, 3) * image.GetSpacing()
    place[:3, 3] = image.GetOrigin()
    return SimpleITK.GetArrayFromImage(image), place


def add(name, *warned, same_values=True, same_place=True, shear=0, farthest=0):
    """Adds a series to the cases, with the matrix of pydicom. Checks that pydicom and SimpleITK agree, unless
    same_values or same_place is False."""
    values, place = read(name)
    itk_values, itk_place = read_itk(name)
    assert values is None or not same_values or numpy.array_equal(values, itk_values), name
    assert not same_place or numpy.allclose(place, itk_place, atol=1e-6), (name, place, itk_place)
    values_name = f"{len(cases)}.npy"
    numpy.save(path(values_name), itk_values)
    cases.append({"file": name, "values": values_name, "place": place.tolist(), "arguments": [],
                  "warnings": warned, "shear": shear, "farthest": farthest})


def set_fields(*slices, **fields):
    """Returns a function that sets fields of the given slices (default: all). The value None deletes a field."""
    def change(data, number):
        for name, value in fields.items():
            if (not slices or number in slices) and value is None:
                del data[name]
            elif not slices or number in slices:
                setattr(data, name, value)
    return change


# Series that can be read.
write("plain")
write("rescaled", change=set_fields(RescaleSlope=1, RescaleIntercept=-1024))
write("half", change=set_fields(RescaleSlope=0.5, RescaleIntercept=3))
write("unsigned", kind="uint16", change=set_fields(BitsStored=16))
write("bytes", kind="uint8")
write("wide", kind="uint32")
write("order", axes=oblique, order=(3, 0, 4, 1, 2), names="IM{:05}")
write("descending", step=-2.5)
write("implicit", syntax=uid.ImplicitVRLittleEndian)
write("big", syntax=uid.ExplicitVRBigEndian)
write("empty", change=set_fields(SliceThickness="", SpacingBetweenSlices="", KVP="", PatientName=""))
write("thick", change=set_fields(SliceThickness=7, SpacingBetweenSlices=9))
for name in ("plain", "rescaled", "half", "unsigned", "bytes", "wide", "order", "descending", "implicit",
             "big", "empty", "thick"):
    add(name)


def change_pet(data, number):
    data.RescaleSlope, data.RescaleIntercept = [0.25, 1.5, 1, 0.1, 3][number], [0, 0, 0, 7, -2][number]


write("pet", kind="uint16", image=uid.PositronEmissionTomographyImageStorage, change=change_pet)
add("pet")
# For images of these types GDCM reads the spacing from another field, or from none.
for name, image in (("projection", uid.ComputedRadiographyImageStorage),
                    ("capture", uid.SecondaryCaptureImageStorage)):
    write(name, image=image)
    add(name, same_place=name == "capture")
write("inverted", change=set_fields(PhotometricInterpretation="MONOCHROME1"))
add("inverted", "MONOCHROME1", same_values=False)
# Files that are not slices.
write("other")
shutil.copy(os.path.join(package, "test-SR.dcm"), path("other", "report.dcm"))
shutil.copy(os.path.join(package, "dicomdirtests", "DICOMDIR"), path("other", "DICOMDIR"))
with open(path("other", "LICENSE"), "w", encoding="utf-8") as file:
    file.write("text")
add("other", "hold no DICOM image are left out: 1, such as report.dcm")
write("planned")
shutil.copy(os.path.join(package, "rtdose.dcm"), path("planned", "dose.dcm"))
add("planned", "hold an RT Dose are left out: 1, such as dose.dcm")
write("zero")
with open(path("zero", "notes.dcm"), "w", encoding="utf-8") as file:
    file.write("")
cases.append({**cases[0], "file": "zero"})
numpy.save(path("zero.npy"), read_itk("zero")[0])
cases[-1].update(values="zero.npy", warnings=["1, such as notes.dcm"])


def change_position(axis, *amounts):
    def change(data, number):
        position = [float(x) for x in data.ImagePositionPatient]
        position[axis] += amounts[number]
        data.ImagePositionPatient = position
    return change


write("nearly", change=change_position(2, 0, 0, 0, 0.1, 0))
add("nearly", "003.dcm lies 0.1 mm from where")
# A tilt of 6e-4 is removed about the middle of the volume.
write("tilted", change=change_position(1, *(0.0015 * i for i in range(5))))
half = numpy.array([0.9 * 7, 0.7 * 5, 2.5 * 4]) / 2
columns = numpy.array([[1, 0, 0], [0, 1, 6e-4], [0, 0, 1]]) / [1, 1, numpy.hypot(1, 6e-4)]
u, _, v = numpy.linalg.svd(columns)
corners = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
add("tilted", "sheared by 0.0006", shear=6e-4, same_place=False,
    farthest=numpy.linalg.norm((u @ v - columns) @ corners.T, axis=0).max())
# Files in the package pydicom, three times each: with the same pixels, at different positions.
for name in ("CT_small", "MR_small", "MR_small_RLE", "MR_small_bigendian", "MR_small_implicit",
             "MR_small_jp2klossless", "MR_small_jpeg_ls_lossless", "MR_small_padded", "693_J2KI",
             "SC_rgb_jpeg_gdcm", "SC_rgb_small_odd", "SC_rgb_rle", "JPEG2000"):
    os.makedirs(path(name))
    for number in range(3):
        data = pydicom.dcmread(os.path.join(package, f"{name}.dcm"))
        data.ImagePositionPatient, data.ImageOrientationPatient = [0, 0, 2 * number], [1, 0, 0, 0, 1, 0]
        data.PixelSpacing, data.SeriesInstanceUID, data.SOPInstanceUID = [0.5, 0.6], "1.2.3", f"1.2.{number}"
        data.save_as(path(name, f"{number}.dcm"))
    add(name, same_place=name[0] in "CM6")
# Lossless compression changes nothing.
names = [case["file"] for case in cases]
small = numpy.load(path(cases[names.index("MR_small")]["values"]))
for name in ("MR_small_RLE", "MR_small_jp2klossless", "MR_small_jpeg_ls_lossless"):
    assert numpy.array_equal(small, numpy.load(path(cases[names.index(name)]["values"]))), name


# Series that cannot be read.
def add_wrong(name, words, **options):
    write(name, **options)
    wrong.append([name, words])


os.makedirs(path("nothing"))
os.makedirs(path("text"))
shutil.copy(path("other", "LICENSE"), path("text"))
os.makedirs(path("outer", "inner"))
wrong += [[name, "the folder holds no DICOM slices"] for name in ("nothing", "text", "outer")]
write("two", count=3, description="other", names="b{:03}.dcm")
add_wrong("two", '5 slices "head" such as 000.dcm')
write("twice", count=3)
for number in range(3):
    shutil.copy(path("twice", f"00{number}.dcm"), path("twice", f"c00{number}.dcm"))
wrong.append(["twice", "the slices 000.dcm and c000.dcm lie at the same place"])
write("missing", count=8)
os.remove(path("missing", "004.dcm"))
wrong.append(["missing", "between the slices 003.dcm and 005.dcm about 1 are missing: they are 5 mm apart"])
write("missing2", count=8)
os.remove(path("missing2", "003.dcm"))
os.remove(path("missing2", "004.dcm"))
wrong.append(["missing2", "between the slices 002.dcm and 005.dcm about 2 are missing"])
add_wrong("double", "002.dcm and 003.dcm lie at the same place",
          change=change_position(2, 0, 0, 0, -2.5, 0))
add_wrong("uneven", "003.dcm lies 0.5 mm from where", change=change_position(2, 0, 0, 0, 0.5, 0))
add_wrong("aside", "003.dcm lies 0.5 mm from where", change=change_position(0, 0, 0, 0, 0.5, 0))
add_wrong("tilt", "sheared by 15.6", change=change_position(1, *(0.7 * i for i in range(5))))
os.makedirs(path("real-tilt"))
for name in ("0.dcm", "1.dcm"):
    shutil.copy(os.path.join(os.path.dirname(nibabel.__file__), "tests", "data", name), path("real-tilt"))
wrong.append(["real-tilt", "sheared by 0.3 degrees"])
for name, words, fields in (
        ("orientation", "differ in their orientation", {"ImageOrientationPatient": [0, 1, 0, 1, 0, 0]}),
        ("spacing", "differ in the spacing", {"PixelSpacing": [0.7, 0.8]}),
        ("rows", "differ in size", {"Rows": 5, "PixelData": bytes(5 * 8 * 2)}),
        ("position", "no position", {"ImagePositionPatient": None}),
        ("direction", "no orientation", {"ImageOrientationPatient": None}),
        ("parallel", "has no two directions", {"ImageOrientationPatient": [1, 0, 0, 1, 0, 0]}),
        ("no-spacing", "no valid pixel spacing", {"PixelSpacing": None}),
        ("empty-spacing", "no valid pixel spacing", {"PixelSpacing": ""}),
        ("no-distance", "no valid pixel spacing", {"PixelSpacing": [0, 0]}),
        ("short", "missing, damaged, or not complete", {"PixelData": bytes(20)}),
        ("frames", "several frames", {"NumberOfFrames": 3, "PixelData": bytes(3 * 6 * 8 * 2)})):
    add_wrong(name, words, change=set_fields(2, **fields))
add_wrong("all-spacing", "no valid pixel spacing",
          change=set_fields(PixelSpacing=None, ImagerPixelSpacing=[0.7, 0.9]))
add_wrong("table", "table of values (modality LUT", change=set_fields(ModalityLUTSequence=[pydicom.Dataset()]))
add_wrong("signed12", "inverted values (MONOCHROME1) of 12 bits", change=set_fields(
    PhotometricInterpretation="MONOCHROME1", BitsStored=12, HighBit=11))
add_wrong("nan", "no position", change=lambda data, number: data.add_new(0x00200032, "UN", rb"nan\0\0 "))
# Numbers with a comma in place of the decimal point, which pydicom does not write.
for name, words, fields, number in (("comma", "no valid pixel spacing", {"PixelSpacing": [1.25, 1]}, b"1.25\\1"),
                                    ("comma-position", "no position", {"ImagePositionPatient": [0, 0, 1.25]}, b"1.25")):
    add_wrong(name, words, change=set_fields(2, **fields))
    with open(path(name, "002.dcm"), "rb+") as file:
        content = file.read()
        assert content.count(number) == 1, name
        file.seek(0)
        file.write(content.replace(number, number.replace(b".", b",")))
add_wrong("sheared-rows", "sheared by 0.57", change=set_fields(
    ImageOrientationPatient=[1, 0, 0, 0.01, 1, 0]))
add_wrong("one", "it has one slice, 000.dcm", count=1)
# An enhanced image, a dose, a file that is compressed as a whole, and a truncated file.
for name, words in (("liver_1frame", "no position"), ("rtdose_1frame", "is an RT Dose"),
                    ("image_dfl", "deflated"), ("MR_truncated", "it is not complete")):
    os.makedirs(path(name))
    shutil.copy(os.path.join(package, f"{name}.dcm"), path(name))
    wrong.append([name, words])
# GDCM terminates the program if a file ends within an element.
for name, source, sizes in (
        ("cut", "plain", (140, 200, 500, -50, -1)), ("big-cut", "big", (600, -1)),
        ("implicit-cut", "implicit", (600, -1)), ("packed-cut", "MR_small_RLE", (-9, -1))):
    last = sorted(os.listdir(path(source)))[-1]
    with open(path(source, last), "rb") as file:
        whole = file.read()
    for size in sizes:
        shutil.copytree(path(source), path(f"{name}{size}"))
        with open(path(f"{name}{size}", last), "wb") as file:
            file.write(whole[:size])
        wrong.append([f"{name}{size}", f"{last}: it is not complete"])

for name, content in (("cases.json", cases), ("wrong.json", wrong)):
    with open(path(name), "w", encoding="utf-8") as file:
        json.dump(content, file)
