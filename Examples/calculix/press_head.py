# SPDX-License-Identifier: BSD-3-Clause
"""Presses a head from its right side in CalculiX, and deforms its scan: press_head.py VOLUME FOLDER [OPTIONS]

1. deform-volume meshes the head with tetrahedra (TetGen).
2. This script writes the mesh, as ten-node tetrahedra, and a load to FOLDER/head.inp.
3. ccx, the solver of CalculiX, computes the displacements.
4. ccx2paraview converts the result, head.frd, to VTK's formats: head.pvd and a .vtu file for each increment.
5. deform-volume deforms the volume by the displacements: FOLDER/pressed.nii.gz and FOLDER/pressed.png.

Written for ch2.nii.gz of the package mricron-data. Lengths are in mm, stresses in MPa and forces in N. On Debian:
apt-get install calculix-ccx python3-vtk9; Documents/solvers.md says how to install ccx2paraview."""
import argparse
import os
import re
import shutil
import subprocess
import sys

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

# x to the right, y to the front, z to the head, as in NIfTI files.
NECK = -60.0  # nodes below this z are fixed
DENT_CENTER = numpy.array((85.0, 5.0, 5.0))  # on the skin above the ear
DENT_RADIUS = 55.0
DENT_DEPTH = -18.0  # displacement along x at the center of the dent
LANDMARKS = {"nose": (0.0, 95.0, -40.0), "crown": (0.0, -15.0, 95.0), "left ear": (-80.0, -15.0, -35.0),
             "brain": (30.0, 5.0, 5.0)}
YOUNG_MODULUS = 0.01  # MPa, a value of soft tissue
POISSON_RATIO = 0.4
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # of a tetrahedron, in the order of C3D10


def call(*command, folder=None):
    """Runs a program, and returns its output."""
    print("$", *command, flush=True)
    result = subprocess.run([str(word) for word in command], cwd=folder, text=True, check=False,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if result.returncode != 0:
        sys.exit(f"{result.stdout[-1000:]}\n{command[0]} failed with the exit code {result.returncode}")
    return result.stdout


def find_program(name, advice):
    path = shutil.which(name)
    if not path:
        sys.exit(f"press_head.py: there is no program {name}: {advice}")
    return os.path.abspath(path)


def read_tetrahedra(path):
    """Returns the positions of the nodes, and the four nodes of each tetrahedron."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    cells = vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 4)
    return vtk_to_numpy(mesh.GetPoints().GetData()).astype(float), cells


def add_middle_nodes(positions, cells):
    """Makes ten-node tetrahedra, because linear tetrahedra are too stiff. The new nodes lie in the middle of edges."""
    edges = numpy.sort(cells[:, EDGES], axis=2)
    unique, middle = numpy.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    all_positions = numpy.concatenate((positions, positions[unique].mean(axis=1)))
    return all_positions, numpy.hstack((cells, len(positions) + middle.reshape(-1, 6)))


def find_surface(cells):
    """Returns the nodes of the boundary faces, which belong to one tetrahedron only."""
    # Each row: three corners of a face, and the nodes in the middle of its edges.
    faces = numpy.concatenate([cells[:, face] for face in
                               ((0, 1, 2, 4, 5, 6), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 2, 3, 6, 9, 7))])
    _, first, count = numpy.unique(numpy.sort(faces[:, :3], axis=1), axis=0, return_index=True,
                                   return_counts=True)
    return numpy.unique(faces[first[count == 1]])


def write_set(file, name, nodes):
    """Writes a set of nodes. CalculiX counts from 1, and reads at most 16 numbers in a line."""
    file.write(f"*NSET, NSET={name}\n")
    for start in range(0, len(nodes), 16):
        file.write(", ".join(str(node + 1) for node in nodes[start:start + 16]) + "\n")


def write_input(path, positions, cells):
    """Writes the input of CalculiX. Returns the nodes of the landmarks."""
    surface = find_surface(cells)
    neck = numpy.flatnonzero(positions[:, 2] < NECK)
    depth = DENT_DEPTH * (1.0 - numpy.sum((positions - DENT_CENTER) ** 2, axis=1) / DENT_RADIUS ** 2)
    pressed = surface[depth[surface] * DENT_DEPTH > 0.0]
    landmarks = {name: int(numpy.linalg.norm(positions - position, axis=1).argmin())
                 for name, position in LANDMARKS.items()}
    if len(neck) < 3 or len(pressed) < 3:
        sys.exit(f"press_head.py: the mesh has {len(neck)} nodes below z = {NECK} and {len(pressed)} nodes in the "
                 "dent, but needs at least 3 of both. The volume must be a head at the position of ch2.nii.gz")
    with open(path, "w", encoding="ascii") as file:
        file.write("*NODE, NSET=ALL\n")
        for node, position in enumerate(positions, 1):
            file.write(f"{node}, " + ", ".join(f"{number:.9g}" for number in position) + "\n")
        file.write("*ELEMENT, TYPE=C3D10, ELSET=HEAD\n")
        for element, cell in enumerate(cells, 1):
            file.write(f"{element}, " + ", ".join(str(node + 1) for node in cell) + "\n")
        for name, nodes in (("NECK", neck), ("LANDMARKS", sorted(landmarks.values()))):
            write_set(file, name, nodes)
        file.write(f"*MATERIAL, NAME=TISSUE\n*HYPERELASTIC, NEO HOOKE\n{YOUNG_MODULUS / (4 * (1 + POISSON_RATIO)):.9g}, "
                   f"{6 * (1 - 2 * POISSON_RATIO) / YOUNG_MODULUS:.9g}\n"
                   "*SOLID SECTION, ELSET=HEAD, MATERIAL=TISSUE\n"
                   "*BOUNDARY\nNECK, 1, 3\n"
                   # Large displacements, in at least four increments.
                   "*STEP, NLGEOM\n*STATIC\n0.25, 1.0, 0.001, 0.25\n"
                   "*BOUNDARY\n" +
                   "".join(f"{node + 1}, 1, 1, {depth[node]:.9g}\n" for node in pressed) +
                   "*NODE PRINT, NSET=LANDMARKS\nU\n"
                   "*NODE FILE\nU\n*END STEP\n")
    return landmarks


def read_printed(path):
    """Returns the displacements at the last time in a .dat file, by node. Nodes are counted from 0."""
    with open(path, encoding="ascii") as file:
        last = file.read().split("displacements")[-1]
    rows = re.findall(r"^ +(\d+)" + r" +(-?\d\.\d+E[-+]\d+)" * 3 + "$", last, flags=re.MULTILINE)
    return {int(row[0]) - 1: numpy.array(row[1:], dtype=float) for row in rows}


parser = argparse.ArgumentParser(description="Presses a head from its right side in CalculiX, and deforms its scan.")
parser.add_argument("volume", help="scan of the head, in a format of deform-volume")
parser.add_argument("folder", help="folder for all files that are written")
parser.add_argument("--edge-length", type=float, default=20.0,
                    help="edge length of the tetrahedra, in mm (default: %(default)s)")
parser.add_argument("--deform-volume", default="deform-volume", help="path of this program, if it is not in PATH")
arguments = parser.parse_args()
deform_volume = find_program(arguments.deform_volume, "build this project, or give its path with --deform-volume")
ccx = find_program("ccx", "install CalculiX (Debian: calculix-ccx)")
ccx2paraview = find_program("ccx2paraview", "pip install ccx2paraview, beside VTK's Python package")
volume = os.path.abspath(arguments.volume)
os.makedirs(arguments.folder, exist_ok=True)


def path(name):
    return os.path.join(os.path.abspath(arguments.folder), name)


call(deform_volume, volume, "--tetgen", "--pieces", "largest", "--edge-length", arguments.edge_length, "--write-mesh",
     path("head.vtu"))
nodes, tetrahedra = add_middle_nodes(*read_tetrahedra(path("head.vtu")))
os.remove(path("head.vtu"))  # ccx2paraview uses this name, too
landmark_nodes = write_input(path("head.inp"), nodes, tetrahedra)
call(ccx, "-i", "head", folder=path(""))
call(ccx2paraview, path("head.frd"), "vtu")
print(call(deform_volume, volume, "--mesh", path("head.pvd"), "--displacement", "U", "-o", path("pressed.nii.gz"),
           "--view", "0.6,1,0.1", "--image", path("pressed.png")))
printed = read_printed(path("head.dat"))
for landmark, landmark_node in landmark_nodes.items():
    print(f"{landmark} (node {landmark_node + 1}) moves by "
          + ", ".join(f"{move:.2f}" for move in printed[landmark_node]) + " mm")
