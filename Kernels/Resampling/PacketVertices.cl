// SPDX-License-Identifier: BSD-3-Clause
// A packet of cells: LANES of a row, of equal parity (BrickResampling.cl, ColumnResampling.cl). Where its vertices lie.
//
// Data: in ROW_MEMORY, a row of vertices: for even, then for odd ones the position in output voxels relative to the
// first output voxel (x, y, z; float, exact multiples of 1/256), then the values of the arrays that are
// interpolated in single precision, HALF_ROW floats each.
//
// What the host puts in front of this text:
//   ROW_MEMORY           address space of the rows: __local, or __global where local memory is too small
//   ROW_CELLS, CELL_ROWS cells along a row, and rows of cells between two planes of vertices
//   LANE_SLOTS           how many arrays have values in a row
//   LANE_ARRAYS(DO)      DO(index, type, bits, slot) for each of these: linear ones of one component, float
//                        (bits 32) or integers of 8 or 16 bits

#define HALF_ROW ((ROW_CELLS / 2 / LANES + 1) * LANES)
#define SLOTS (3 + LANE_SLOTS)
#define ODD (SLOTS * HALF_ROW)   // from an even vertex to the odd one with the same place
#define ROW (2 * ODD)
#define ROWS (CELL_ROWS + 1)
#define NOT_THERE -1e30f // x of places beyond the volume
#define NO_SOURCE 1e30f  // x of vertices without position
#define STEP (1.0f / 256.0f) // of positions, in voxels

typedef ROW_MEMORY const float* LocalRow;

// A value, by its bits, that the sum of products would not give back: -0, not finite, or so large (2^115) that the
// sum may overflow, as weights add up to the determinant, which is under 2^11.
#define IS_SPECIAL(bits) ((((bits)&0x7f800000) >= 0x79000000) | ((bits) == INT_MIN))

#if LANES > 1
// A row of cells between two rows of vertices in each of two planes. Rows: of places of even x, by bit 0: odd z,
// bit 1: odd y, as the vertices of a cell have their numbers by the parity of their structured indices
// (CellCoverage.cl). Odd: the parity of y and z together.
typedef struct
{
  LocalRow Rows[4];
  int X; // of the brick's first place
  int Y;
  int Z;
  int Odd;
  uint Borders; // as RowFlags
  uint Apart;
} RowOfCells;
#endif

// Cells from X on, every second one. Side: 1 where these have vertices of even x behind those of odd x. Odd:
// parity of x, y and z together. Border: whether a vertex may not be interior. Apart: whether a vertex may
// lie elsewhere as seen from the other side of a smooth cut.
typedef struct
{
#if LANES > 1
  LocalRow Rows[4];
#else
  LocalRow Row; // of even y and z
  int OddY;     // from there to the row of odd y
  int OddZ;     // and to the one of odd z
#endif
  int Side;
  int X;
  int Y;
  int Z;
  int Odd;
  int Border;
  int Apart;
} Packet;

#if LANES > 1
// The flags of the vertices of a packet's cells.
#define PACKET_FLAGS(k) (((2u << (2 * LANES / 8)) - 1) << ((k) >> 2))

// Where the packets at place k are counted.
#define OUTPUT_OF_SPAN(outputs, k) ((outputs) + 2 * (k) / DEFORMVOLUME_SPAN)

static __attribute__((always_inline)) void MakePacket(
  const RowOfCells* row, int k, int side, Packet* packet)
{
  const Packet made = { { row->Rows[0] + k, row->Rows[1] + k, row->Rows[2] + k, row->Rows[3] + k },
    side, row->X + 2 * k + side, row->Y, row->Z, row->Odd ^ side,
    (row->Borders & PACKET_FLAGS(k)) != 0, (row->Apart & PACKET_FLAGS(k)) != 0 };
  *packet = made;
}
#endif

// The row of a vertex of a packet's cells, and the place of that in it.
#if LANES > 1
#define ROW_OF(packet, v) ((packet)->Rows[(v) >> 1])
#else
#define ROW_OF(packet, v)                                                                           \
  ((packet)->Row + ((v) >> 1 & 1) * (packet)->OddZ + ((v) >> 2) * (packet)->OddY)
#endif
#define PLACE_OF(packet, v) (ROW_OF(packet, v) + ((v)&1 ? ODD : (packet)->Side))

#define VERTEX(v, slot) LOAD(PLACE_OF(packet, v) + (slot)*HALF_ROW)
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
