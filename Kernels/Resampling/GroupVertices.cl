// SPDX-License-Identifier: BSD-3-Clause
// A group of cells: LANES of a row, of equal parity (BrickResampling.cl). Where its vertices lie.

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

// Cells from X on, every second one. Side: 1 where these have vertices of even x behind those of odd x. Odd:
// parity of x, y and z together. Border: whether a vertex may not be interior. Apart: whether a vertex may
// lie elsewhere as seen from the other side of a smooth cut.
typedef struct
{
  LocalRow Rows[4];
  int Side;
  int X;
  int Y;
  int Z;
  int Odd;
  int Border;
  int Apart;
} Group;

// The flags of the vertices of a group's cells.
#define GROUP_FLAGS(k) (((2u << (2 * LANES / 8)) - 1) << ((k) >> 2))

// Where the groups at place k are counted.
#define OUTPUT_OF_COLUMN(outputs, k) ((outputs) + 2 * (k) / DEFORMVOLUME_COLUMN)

static __attribute__((always_inline)) void MakeGroup(
  const RowOfCells* row, int k, int side, Group* group)
{
  const Group made = { { row->Rows[0] + k, row->Rows[1] + k, row->Rows[2] + k, row->Rows[3] + k },
    side, row->X + 2 * k + side, row->Y, row->Z, row->Odd ^ side,
    (row->Borders & GROUP_FLAGS(k)) != 0, (row->Apart & GROUP_FLAGS(k)) != 0 };
  *group = made;
}

#define VERTEX(v, slot)                                                                            \
  LOAD(group->Rows[(v) >> 1] + ((v)&1 ? ODD : group->Side) + (slot)*HALF_ROW)
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
