// SPDX-License-Identifier: BSD-3-Clause
// The split of a cell of the sampling mesh into five tetrahedra (5T). This file is valid C++ and
// OpenCL C; it precedes the text of every kernel, so both languages share one table.
//
// Vertex v of the cell at (x, y, z) has the offset DEFORMVOLUME_OFFSET_X(v), ..._Y(v), ..._Z(v), so
// v is one less than the number used in the literature. The split is mirrored from cell to cell: on
// every axis on which the structured index of the cell is odd, offsets are counted from the upper
// side of the cell. Therefore two neighboring cells have the same diagonal on their common face.
//
// The table lists the four corner tetrahedra, then the central one. In a cell of even parity
// (x + y + z even) det(b - a, c - a, d - a) of the undeformed tetrahedra is +1 +1 +1 +1 -2 times
// the volume of the voxel; in a cell of odd parity every sign is reversed.
//
// Source: Rodriguez, Leon, Martin, Otaduy, "A parallel resampling method for interactive
// deformation of volumetric models", section on the implicit sampling mesh.
#ifndef DeformVolumeFiveTetrahedra_h
#define DeformVolumeFiveTetrahedra_h

#define DEFORMVOLUME_FIVE_TETRAHEDRA                                                               \
  {                                                                                                \
    { 0, 2, 3, 6 }, { 6, 7, 3, 5 }, { 3, 1, 0, 5 }, { 0, 4, 6, 5 },                                \
    {                                                                                              \
      6, 3, 5, 0                                                                                   \
    }                                                                                              \
  }

// The axes on which the split of the cell with this structured index is mirrored, as bits in the
// order of the bits of a vertex number: v ^ mirror is the offset of vertex v.
#define DEFORMVOLUME_MIRROR(x, y, z) (((x)&1) | ((z)&1) << 1 | ((y)&1) << 2)

// The offset of a vertex of a cell on each axis, 0 or 1.
#define DEFORMVOLUME_OFFSET_X(v) ((v)&1)
#define DEFORMVOLUME_OFFSET_Y(v) ((v) >> 2 & 1)
#define DEFORMVOLUME_OFFSET_Z(v) ((v) >> 1 & 1)

#ifdef __OPENCL_VERSION__
#define OFFSET_X DEFORMVOLUME_OFFSET_X
#define OFFSET_Y DEFORMVOLUME_OFFSET_Y
#define OFFSET_Z DEFORMVOLUME_OFFSET_Z
__constant uchar Tetrahedra[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
#else
namespace deformvolume
{
/// The vertices of the five tetrahedra of a cell.
inline constexpr int FiveTetrahedra[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
}
#endif

// The byte of a cell in a mask of active tetrahedra if all five are active.
#define DEFORMVOLUME_ALL_TETRAHEDRA 31

// Entry k: the corner tetrahedron on the other side of the face of the central tetrahedron that is
// opposite its vertex k. The permutation is its own inverse: entry t is the vertex of the central
// tetrahedron that is opposite its common face with corner tetrahedron t.
#define DEFORMVOLUME_CORNER_BEHIND_FACE                                                            \
  {                                                                                                \
    2, 3, 0, 1                                                                                     \
  }

#endif
