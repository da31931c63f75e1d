# SPDX-License-Identifier: BSD-3-Clause
"""Writes files in the formats of solvers: the .vtk files of FEBio and FEBio Studio, and the files of SOFA's
VTKExporter. Numbers have as many digits as these programs write."""

VTK_TYPES = {1: 1, 2: 3, 3: 5, 4: 10, 8: 12, 10: 24, 15: 24, 20: 25, 27: 25}  # by the number of nodes


def join(numbers, digits=6):
    return " ".join(f"{number:.{digits}g}" for number in numbers)


def write_grid(file, places, cells):
    """Writes the points, three in a line, and the cells of a legacy file. FEBio gives tetrahedra of 15 nodes and
    hexahedra of 27 nodes the cell types of 10 and 20 nodes."""
    file.write(f"DATASET UNSTRUCTURED_GRID\nPOINTS {len(places)} float\n")
    for start in range(0, len(places), 3):
        file.write(" ".join(join(place) for place in places[start:start + 3]) + " \n")
    file.write(f"\nCELLS {len(cells)} {sum(len(cell) + 1 for cell in cells)}\n")
    for cell in cells:
        file.write(f"{len(cell)} " + " ".join(str(node) for node in cell) + " \n")
    file.write(f"\nCELL_TYPES {len(cells)}\n" + "".join(f"{VTK_TYPES[len(cell)]}\n" for cell in cells))


def write_febio(path, places, moves, cells, time, title="time"):
    """Writes one state of FEBio's plot file of the type vtk: points at rest, a scalar, displacements, and stresses of
    the cells. An export of FEBio Studio differs in the title and in the points, which are deformed."""
    with open(path, "w", encoding="ascii") as file:
        file.write(f"# vtk DataFile Version 3.0\n{title} {time:g}\nASCII\n")
        write_grid(file, places, cells)
        file.write(f"\nPOINT_DATA {len(places)}\nSCALARS fluid_pressure float\nLOOKUP_TABLE default\n")
        file.write("0\n" * len(places))
        file.write("VECTORS displacement float\n" + "".join(join(move) + "\n" for move in moves))
        file.write("VECTORS reaction_forces float\n" + "0 0 0\n" * len(places))
        file.write(f"\nCELL_DATA {len(cells)}\nSCALARS part_id int\nLOOKUP_TABLE default\n" + "0\n" * len(cells))
        file.write("TENSORS stress float\n" + "1 0 0\n0 1 0\n0 0 1\n\n" * len(cells))


def write_febio_studio(path, places, moves, cells, time):
    write_febio(path, places + moves, moves, cells, time, "vtk output at time")


def find_edges(cells):
    return sorted({tuple(sorted((cell[a], cell[b]))) for cell in cells if len(cell) == 4
                   for a in range(4) for b in range(a)})


def write_sofa(path, places, cells, arrays=(), edges=True):
    """Writes a file of SOFA's VTKExporter, in the format of the suffix. VTKExporter writes edges by default, and no
    displacements. arrays: pairs of a name and of vectors at the points."""
    cells = (find_edges(cells) if edges else []) + list(cells)
    with open(path, "w", encoding="ascii") as file:
        if path.endswith(".vtk"):
            file.write("# vtk DataFile Version 2.0\nExported VTK file\nASCII\n\n")
            write_grid(file, places, cells)
            file.write(f"\nPOINT_DATA {len(places)}\n" if arrays else "")
            for name, vectors in arrays:
                file.write(f"VECTORS {name} double\n" + "\n".join(join(vector) for vector in vectors) + "\n\n")
            return
        file.write('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="BigEndian">\n  <UnstructuredGrid>\n'
                   f'    <Piece NumberOfPoints="{len(places)}" NumberOfCells="{len(cells)}">\n')
        file.write("      <PointData>\n" if arrays else "")
        for name, vectors in arrays:
            file.write(f'        <DataArray type="Float64" Name="{name}" NumberOfComponents="3" format="ascii">\n' +
                       "\n".join(join(vector) for vector in vectors) + "\n        </DataArray>\n")
        file.write("      </PointData>\n" if arrays else "")
        file.write('      <Points>\n        <DataArray type="Float32" NumberOfComponents="3" format="ascii">\n' +
                   "".join(f"\t{join(place)}\n" for place in places) + "        </DataArray>\n      </Points>\n")
        file.write('      <Cells>\n        <DataArray type="Int32" Name="connectivity" format="ascii">\n' +
                   "".join("          " + " ".join(str(node) for node in cell) + "\n" for cell in cells))
        ends = [sum(len(cell) for cell in cells[:number + 1]) for number in range(len(cells))]
        for kind, name, values in (("Int32", "offsets", ends),
                                   ("UInt8", "types", [VTK_TYPES[len(cell)] for cell in cells])):
            file.write(f'        </DataArray>\n        <DataArray type="{kind}" Name="{name}" format="ascii">\n'
                       "          " + " ".join(str(value) for value in values) + " \n")
        file.write("        </DataArray>\n      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n")
