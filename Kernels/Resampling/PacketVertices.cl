// SPDX-License-Identifier: BSD-3-Clause
// A packet of cells: LANES cells of a row, of equal parity (BrickResampling.cl, ColumnResampling.cl), and where its
// vertices are stored.
//
// Data: rows of vertices in ROW_MEMORY. For even, then for odd vertices: the position in output voxels relative to
// the first output voxel (x, y, z; float, exact multiples of 1/256), then the values of the arrays that are
// interpolated in single precision, HALF_ROW floats each.
//
// The host defines before this text:
//   ROW_MEMORY           address space of the rows: __local, or __global if local memory is too small
//   ROW_CELLS, CELL_ROWS number of cells along a row, and of rows of cells between two planes of vertices
//   LANE_SLOTS           number of arrays with values in a row
//   LANE_ARRAYS(DO)      DO(index, type, bits, slot) for each of these: linear arrays of one component, float
//                        (bits 32) or 8- or 16-bit integers

#define HALF_ROW ((ROW_CELLS / 2 / LANES + 1) * LANES)
#define SLOTS (3 + LANE_SLOTS)
#define ODD (SLOTS * HALF_ROW)   // offset from an even vertex to the odd vertex in the same slot
#define ROW (2 * ODD)
#define ROWS (CELL_ROWS + 1)
#define NO_VERTEX -1e30f // x of slots outside the volume
#define NO_SOURCE 1e30f  // x of vertices without position
#define STEP (1.0f / 256.0f) // of positions, in voxels

typedef ROW_MEMORY const float* LocalRow;

// Whether a value, given by its bits, cannot be reproduced bit for bit by a sum of products: -0, values that are not
// finite, or values so large (2^115) that the sum may overflow. (Weights add up to the determinant, which is under
// 2^11.)
#define IS_SPECIAL(bits) ((((bits)&0x7f800000) >= 0x79000000) | ((bits) == INT_MIN))

#if LANES > 1
// A row of cells between two rows of vertices in each of two planes. Rows: slots of the vertices of even x; bit 0 of
// the index: odd z, bit 1: odd y, as vertices of a cell are numbered by the parity of their structured indices
// (CellCoverage.cl). Parity: of y + z.
typedef struct
{
  LocalRow Rows[4];
  int X; // index of the brick's first cell
  int Y;
  int Z;
  int Parity;
  uint Borders; // flags as in RowFlags
  uint Split;
} RowOfCells;
#endif

// Every second cell of a row, from X on. Side: 1 if the vertices of even x come after those of odd x. Parity: of
// x + y + z. Border: whether a vertex may not be interior. Split: whether a vertex may have different positions
// for the two sides of a smooth cut.
typedef struct
{
#if LANES > 1
  LocalRow Rows[4];
#else
  LocalRow Row; // the row of even y and z
  int OddY;     // offset from Row to the row of odd y
  int OddZ;     // offset from Row to the row of odd z
#endif
  int Side;
  int X;
  int Y;
  int Z;
  int Parity;
  int Border;
  int Split;
} Packet;

#if LANES > 1
// The flags of the vertices of a packet's cells.
#define PACKET_FLAGS(k) (((2u << (2 * LANES / 8)) - 1) << ((k) >> 2))

// The output that counts the packets at slot k.
#define OUTPUT_OF_SPAN(outputs, k) ((outputs) + 2 * (k) / DEFORMVOLUME_SPAN)

static __attribute__((always_inline)) void MakePacket(
  const RowOfCells* row, int k, int side, Packet* packet)
{
  const Packet made = { { row->Rows[0] + k, row->Rows[1] + k, row->Rows[2] + k, row->Rows[3] + k },
    side, row->X + 2 * k + side, row->Y, row->Z, row->Parity ^ side,
    (row->Borders & PACKET_FLAGS(k)) != 0, (row->Split & PACKET_FLAGS(k)) != 0 };
  *packet = made;
}
#endif

// The row of a vertex of a packet's cells, and its slots in the row.
#if LANES > 1
#define ROW_OF(packet, v) ((packet)->Rows[(v) >> 1])
#else
#define ROW_OF(packet, v)                                                                           \
  ((packet)->Row + ((v) >> 1 & 1) * (packet)->OddZ + ((v) >> 2) * (packet)->OddY)
#endif
#define SLOTS_OF(packet, v) (ROW_OF(packet, v) + ((v)&1 ? ODD : (packet)->Side))

#define VERTEX(v, slot) LOAD(SLOTS_OF(packet, v) + (slot)*HALF_ROW)
#define LOAD_VERTEX(v)                                                                             \
  const FLOATS X##v = VERTEX(v, 0), Y##v = VERTEX(v, 1), Z##v = VERTEX(v, 2);
#define LOAD_VERTICES                                                                              \
  LOAD_VERTEX(0)                                                                                   \
  LOAD_VERTEX(1)                                                                                   \
  LOAD_VERTEX(2)                                                                                   \
  LOAD_VERTEX(3)                                                                                   \
  LOAD_VERTEX(4)                                                                                   \
  LOAD_VERTEX(5)                                                                                   \
  LOAD_VERTEX(6)                                                                                   \
  LOAD_VERTEX(7)
