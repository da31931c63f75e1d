/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file
 * DeformVolume in C: what other languages call. The library is libdeformvolume.so, and all of its
 * names begin with dv_.
 *
 * Errors. Functions that can fail return DV_OK or another status. dv_last_error() then has a text
 * that says what is wrong and what to do about it. No C++ exception leaves the library.
 *
 * Texts are UTF-8 and end with a zero.
 *
 * Threads. All functions may be called from several threads at once, but not for one object
 * (volume, mesh, ...) from two threads at once.
 */
#ifndef deformvolume_h
#define deformvolume_h

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

/** @def DV_EXPORT
 * Marks a function that the library exports. */
#if defined(_WIN32)
#define DV_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define DV_EXPORT __attribute__((visibility("default")))
#else
#define DV_EXPORT
#endif

/* ---- Versions and errors ---- */

/** The version of this interface. It grows with every change that programs which were compiled
 * before do not survive. A change that only adds functions, or members at the end of structures
 * that begin with their size, leaves it. */
#define DV_ABI_VERSION 1

  /** The DV_ABI_VERSION that the library was built with. Programs that load the library at run time
   * compare it with their own before they call anything else. */
  DV_EXPORT int32_t dv_abi_version(void);

  /** The version of DeformVolume, such as "0.2.0". The text lives as long as the process. */
  DV_EXPORT const char* dv_version(void);

  /** What functions return. */
  enum
  {
    /** All went well. */
    DV_OK = 0,
    /** dv_last_error() has the reason. */
    DV_ERROR = 1,
    /** A progress callback asked for the end. */
    DV_ABORTED = 2
  };

  /** Why the last function of this thread that returned DV_ERROR failed. Empty where none has
   * failed. The text belongs to the library, and stays until the next function of this thread
   * fails. */
  DV_EXPORT const char* dv_last_error(void);

  /* ---- Devices and drivers ---- */

  /** What dv_device_flags() is a sum of. */
  enum
  {
    /** A processor, by a driver for processors. */
    DV_DEVICE_PROCESSOR = 1,
    /** A renderer in software, or an interpreter: slow. */
    DV_DEVICE_EMULATED = 2,
    /** A device with double precision. */
    DV_DEVICE_DOUBLE = 4
  };

  /** Adds an OpenCL driver that the system does not list, such as PoCL from a Python package. path:
   * the absolute path of the driver's library, which is loaded and stays loaded. The same path
   * again does nothing. Devices of drivers that were added come before equal ones of the system.
   * Indices of devices may change. PoCL 3.0 of the Python package pocl-binary-distribution chooses
   * processors for its kernels that do not fit its built-in functions: its choice is set right, in
   * its own memory. It is left alone where the environment variable DEFORMVOLUME_KERNEL_PROCESSOR
   * is "driver".
   * Fails where the path is not absolute, where the library cannot be loaded, where it is no
   * OpenCL driver, or where the variable has a value other than "auto" and "driver". */
  DV_EXPORT int32_t dv_add_driver(const char* path);

  /** The folder of a program "ld", with which PoCL links kernels where it is a driver of
   * dv_add_driver(), and the "ld" on the PATH does not work: without one it would end the process.
   * To be called before a device is used. The environment variable DEFORMVOLUME_LINKER changes
   * that: "system" never takes the program, "own" always does for such drivers. While kernels are
   * compiled, the folder is in the environment variable COMPILER_PATH of this process.
   * Fails where the path is not absolute. */
  DV_EXPORT int32_t dv_set_linker(const char* folder);

  /** The number of OpenCL devices, the best first; 0 where there is none. The first call starts the
   * drivers, which may take some tenths of a second. */
  DV_EXPORT int32_t dv_device_count(void);

  /** The name of a device, "device (platform)", 0 <= index < dv_device_count(). Null, with an
   * error, where there is no such device. The text belongs to the library, and stays until the next
   * call of this function from this thread. */
  DV_EXPORT const char* dv_device_name(int32_t index);

  /** What a device is: a sum of DV_DEVICE_... -1, with an error, where there is no such device. */
  DV_EXPORT int32_t dv_device_flags(int32_t index);

  /* ---- Deforming a volume ---- */

  /**
   * A deformer has one volume, its arrays, one deformation and the settings of the output. What has
   * been set stays until it is set again, so that a program sets only what changes, and dv_deform()
   * computes again only what depends on it.
   *
   * Without a deformation all of the volume stays where it is, which resamples it on another grid.
   *
   *   dv_create, dv_set_volume, dv_set_arrays, dv_set_mesh, dv_set_displacements,
   *   dv_output_grid, dv_deform, dv_destroy
   *
   * Coordinates. All points and vectors are in world coordinates, and all lengths in one unit, for
   * instance mm. A grid says where its points lie.
   *
   * Memory. Pointers are read during the call only, unless it is said that they are borrowed:
   * memory that is borrowed must be there, unchanged, until the same function is called again with
   * other memory, until dv_set_volume() with another grid, or until dv_destroy(). Where its values
   * have changed, the function is called again. Memory is aligned as its type wants it.
   *
   * Structures begin with struct_size, their size in bytes as the program knows them: set it to
   * sizeof the structure. Members that are not set must be 0. Of lists of structures struct_size of
   * the first one counts.
   *
   * Errors. A function that fails leaves the deformer as it was, but for dv_deform(): then the
   * contents of the output are undefined. The deformer can be used again in any case.
   */
  typedef struct dv_deformer dv_deformer;

  /** Types of elements. */
  enum
  {
    DV_INT8 = 0,    /**< int8_t */
    DV_UINT8 = 1,   /**< uint8_t */
    DV_INT16 = 2,   /**< int16_t */
    DV_UINT16 = 3,  /**< uint16_t */
    DV_INT32 = 4,   /**< int32_t */
    DV_UINT32 = 5,  /**< uint32_t */
    DV_INT64 = 6,   /**< int64_t */
    DV_UINT64 = 7,  /**< uint64_t */
    DV_FLOAT32 = 8, /**< float */
    DV_FLOAT64 = 9  /**< double */
  };

  /** A grid of points. The point with the index (i, j, k) lies at
   *   origin + direction * (spacing[0] * i, spacing[1] * j, spacing[2] * k). */
  typedef struct dv_grid
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** First and last index on x, y and z: the grid has these and all between them. */
    int32_t extent[6];
    /** Where the index (0, 0, 0) lies, whether the extent has it or not. */
    double origin[3];
    /** The step from index to index on each axis, not 0. Negative steps are allowed. */
    double spacing[3];
    /** A 3 x 3 matrix, row by row. Its columns are the axes. It must have an inverse. */
    double direction[9];
  } dv_grid;

  /** An array over the points of a volume: tuples of components elements, x varying fastest, then
   * y, then z. */
  typedef struct dv_array
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The values. Borrowed. */
    const void* data;
    /** The type of the elements, DV_INT8 to DV_FLOAT64. */
    int32_t type;
    /** Elements of a tuple, 1 or more. */
    int32_t components;
    /** Not 0: the values are labels. They are never mixed: each comes from one voxel. */
    int32_t categorical;
    /** Not 0: the values are amounts per unit of volume, such as a dose or an activity. Those of
     * the output are divided by the Jacobian, so that their sum times the volume of a voxel is
     * kept. They are floats, or doubles where the type is DV_FLOAT64. Voxels that show the volume
     * inside out have the background. What folds hide is missing from the sum. The warnings of
     * dv_report tell how much that is. Not with labels, DV_NEAREST or incremental. */
    int32_t density;
    /** The value of output voxels that the deformed volume does not cover, rounded and clamped to
     * the range of the type of the output. */
    double background;
  } dv_array;

  /** Makes a deformer, to be destroyed with dv_destroy(). */
  DV_EXPORT int32_t dv_create(dv_deformer** deformer);
  /** Destroys a deformer. Null is allowed. */
  DV_EXPORT void dv_destroy(dv_deformer* deformer);

  /** Chooses the device. name: that of a device as dv_device_name() has it, or a part of one;
   * "cpu" or "gpu"; null or "" for the best device, which is the default. Fails where there is no
   * such device. */
  DV_EXPORT int32_t dv_set_device(dv_deformer* deformer, const char* name);

  /** How many bytes may be used on the device; 0: what it has available. */
  DV_EXPORT int32_t dv_set_memory_limit(dv_deformer* deformer, uint64_t bytes);

  /** The grid of the volume at rest: two points or more on each axis. With another grid than before
   * arrays and masks are forgotten. */
  DV_EXPORT int32_t dv_set_volume(dv_deformer* deformer, const dv_grid* grid);

  /** The arrays of the volume. Their data are borrowed. count may be 0: then only the arrays that
   * dv_request names can be made. */
  DV_EXPORT int32_t dv_set_arrays(dv_deformer* deformer, int32_t count, const dv_array* arrays);

  /** Which voxels of the volume there are: one byte a voxel, not 0 where the voxel is left out.
   * Null: all are there. Borrowed. */
  DV_EXPORT int32_t dv_set_blanked(dv_deformer* deformer, const uint8_t* blanked);

  /* Cuts and carvings. Tetrahedra are those of the implicit mesh between the voxels: five for each
   * cell of eight neighbouring voxels (Documents/glossary.md). Arrays of cells have one tuple a
   * cell, one cell less than voxels on each axis, x varying fastest. vtkCutVolume, vtkCarveVolume
   * and the functions under 'Cutting and carving' make these arrays. All are borrowed; null: there
   * is no such mask. */

  /** The active tetrahedra. active: one byte a cell, bit i is set where tetrahedron i is active.
   * Null: all are. */
  DV_EXPORT int32_t dv_set_active_tetrahedra(dv_deformer* deformer, const uint8_t* active);

  /** A carved volume with a smooth boundary. distances: one float a voxel, its signed distance to
   * the boundary of what has been carved out, negative inside it, in any unit. Samples where it is
   * negative are left out. */
  DV_EXPORT int32_t dv_set_boundary_distances(dv_deformer* deformer, const float* distances);

  /** A smooth cut. crossed: one byte a cell, bit i is set where the sheet crosses tetrahedron i.
   * distances: one float a voxel, its signed distance from the sheet. Both or none. Not with
   * inverse fields. */
  DV_EXPORT int32_t dv_set_smooth_cut(
    dv_deformer* deformer, const uint8_t* crossed, const float* distances);

  /** A deformation mesh at rest. Types of cells and the order of their points are VTK's: tetrahedra
   * (10), voxels (11), hexahedra (12), wedges (13), pyramids (14), prisms (15, 16), quadratic cells
   * (24 to 27, 29, 31 to 33, 37) and Lagrange cells (71 to 73). All are split into tetrahedra
   * between their points, and polyhedra (42), where that does not fill them, round a point of their
   * own. Bezier cells are an error; cells of other types are ignored, with a warning. */
  typedef struct dv_mesh
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** Points of the mesh. */
    int64_t number_of_points;
    /** Three numbers a point, in world coordinates. */
    const void* points;
    /** The type of points: DV_FLOAT32 or DV_FLOAT64. */
    int32_t point_type;
    /** Must be 0. */
    int32_t reserved;
    /** Cells of the mesh. */
    int64_t number_of_cells;
    /** The numbers of the points of each cell, one after the other. */
    const int64_t* connectivity;
    /** The type of each cell, as VTK numbers them. Null: all cells are tetrahedra. The members
     * below are null then, too. */
    const uint8_t* types;
    /** number_of_cells + 1 numbers: where the points of each cell begin in connectivity, and where
     * the last ones end. */
    const int64_t* offsets;
    /** Null, or three numbers a cell: the degrees of Lagrange cells along their axes. The numbers
     * of other cells are ignored. */
    const int32_t* degrees;
    /** The faces of polyhedra, one polyhedron after the other, in the order of the cells: the
     * number of its faces, and for each face the number of its points, and the points in order
     * round it. Null where there are no polyhedra. */
    const int64_t* faces;
    /** How many numbers faces has. */
    int64_t number_of_face_values;
  } dv_mesh;

  /** The deformation mesh, in place of the field or mesh before. It has no displacements then. */
  DV_EXPORT int32_t dv_set_mesh(dv_deformer* deformer, const dv_mesh* mesh);

  /** How far the points of the mesh have moved: count vectors of three numbers, one for each point,
   * in world coordinates. type: DV_FLOAT32 or DV_FLOAT64. A vector that is not finite is an error
   * of dv_deform(), where a cell uses its point; so is one that is longer than 16,383 output
   * voxels. */
  DV_EXPORT int32_t dv_set_displacements(
    dv_deformer* deformer, int32_t type, int64_t count, const void* displacements);

  /** A displacement field: one vector for each point of a grid of its own, linear between them. */
  typedef struct dv_field
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The grid of the field. */
    const dv_grid* grid;
    /** Three numbers a point, in world coordinates, x varying fastest. Borrowed. */
    const void* vectors;
    /** The type of vectors: DV_FLOAT32 or DV_FLOAT64. */
    int32_t type;
    /** 0: a vector leads from a point of the volume to where it goes. Else it leads from a point of
     * the output to the point of the volume that is seen there. */
    int32_t inverse;
  } dv_field;

  /** The displacement field, in place of the mesh or field before. */
  DV_EXPORT int32_t dv_set_field(dv_deformer* deformer, const dv_field* field);

  /** What becomes of voxels outside the mesh or the field. */
  enum
  {
    /** They are left out. */
    DV_OUTSIDE_DISCARD = 0,
    /** They follow the nearest part of the mesh or of the field. */
    DV_OUTSIDE_EXTRAPOLATE = 1,
    /** They stay; within fade_distance they follow the boundary in part. */
    DV_OUTSIDE_KEEP = 2
  };

  /** What becomes of voxels outside. mode: DV_OUTSIDE_DISCARD, the default, and so on.
   * fade_distance: in world units, 0 or more; it counts with DV_OUTSIDE_KEEP only. */
  DV_EXPORT int32_t dv_set_outside(dv_deformer* deformer, int32_t mode, double fade_distance);

  /** The grid of the output, such as that of the fixed image of a registration: any extent, spacing
   * and direction, turned or mirrored. Null, the default: the output has the origin, the direction
   * and the spacing of the volume, and what dv_set_output() says. */
  DV_EXPORT int32_t dv_set_reference(dv_deformer* deformer, const dv_grid* grid);

  /** How large the output is without a reference grid. */
  enum
  {
    /** As large as the deformed volume. */
    DV_BOUNDS_DEFORMED = 0,
    /** As large as the volume at rest. */
    DV_BOUNDS_VOLUME = 1,
    /** As large as dv_output::custom_bounds. */
    DV_BOUNDS_CUSTOM = 2
  };

  /** How large the output is without a reference grid, and its spacing. */
  typedef struct dv_output
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** DV_BOUNDS_DEFORMED, DV_BOUNDS_VOLUME or DV_BOUNDS_CUSTOM. */
    int32_t bounds_mode;
    /** How many voxels the output has more on each side; negative: less. */
    int32_t padding;
    /** The bounds in world coordinates: x min, x max, y min, y max, z min, z max. */
    double custom_bounds[6];
    /** The spacing, greater than 0. All 0: that of the volume. */
    double spacing[3];
  } dv_output;

  /** Sets how large the output is. Null, the default: DV_BOUNDS_DEFORMED, no padding, the spacing
   * of the volume. */
  DV_EXPORT int32_t dv_set_output(dv_deformer* deformer, const dv_output* output);

  /** The grid of the output with its whole extent, for what has been set: how much memory
   * dv_deform() needs. grid->struct_size is set by the program. Fails where the volume or
   * the displacements of a mesh are missing, and where the deformed volume covers no output voxel.
   */
  DV_EXPORT int32_t dv_output_grid(dv_deformer* deformer, dv_grid* grid);

  /** How values are interpolated. */
  enum
  {
    DV_LINEAR = 0, /**< linearly in each tetrahedron */
    DV_CUBIC = 1, /**< by Catmull-Rom splines over four voxels on each axis, where they are there */
    DV_NEAREST = 2 /**< not at all: all arrays count as categorical */
  };

  /** A progress callback. It gets the fraction that is done, 0 to 1, in the thread that called the
   * function which works. If it does not return 0, that function aborts and returns DV_ABORTED. It
   * must neither throw nor call functions for the same object. */
  typedef int32_t (*dv_progress)(double fraction, void* user);

  /** What dv_deform() is to do, and the memory for it, which is written during the call. */
  typedef struct dv_request
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** A part of the whole extent of the output, in its indices. */
    int32_t extent[6];
    /** 0: extent is not used, and the whole output is made. */
    int32_t use_extent;
    /** DV_LINEAR, DV_CUBIC or DV_NEAREST. */
    int32_t interpolation;
    /** The number of arrays of dv_set_arrays(). */
    int32_t number_of_outputs;
    /** Not 0: the next call may begin with what this one wrote. If the next call is incremental,
     * too, and has the same extent and memory, then that memory must still hold what this call
     * wrote: only what has changed is written. The result is the same to the last bit. Not together
     * with rest_positions, jacobian, fold_count and densities. */
    int32_t incremental;
    /** For each array, room for its components of its type for each voxel, and for a density of
     * floats or doubles. */
    void* const* outputs;
    /** Room for a byte a voxel: 1 where the deformed volume covers it, else 0. */
    int8_t* coverage;
    /** Null, or room for three floats a voxel: the world coordinates at rest of the tissue that is
     * seen there. */
    float* rest_positions;
    /** Null, or room for a float a voxel: how many times as large the deformation makes the volume
     * there; negative: inside out. */
    float* jacobian;
    /** Null, or room for an integer a voxel: how many tetrahedra of the sampling mesh hold it; more
     * than 1 in folds. Not with inverse fields. */
    uint32_t* fold_count;
    /** The value of rest_positions and jacobian where nothing is covered. */
    double extra_background;
    /** The progress callback; null: none. */
    dv_progress progress;
    /** What progress gets as its argument user. */
    void* user;
  } dv_request;

  /** The results of dv_deform() besides the output. */
  typedef struct dv_report
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** Voxels of the output that the deformed volume covers. */
    int64_t number_of_covered_voxels;
    /** Tetrahedra that the deformation turns inside out: of the sampling mesh or, with an inverse
     * field, of the grid of the field. */
    int64_t number_of_inverted_tetrahedra;
    /** Tetrahedra of the mesh without volume at rest. */
    int64_t number_of_flat_tetrahedra;
    /** Cells of the volume that are stretched over more than 4,000 output voxels. Tetrahedra of
     * them are left out. */
    int64_t number_of_overstretched_cells;
    /** Samples that other parts of a folded volume hide. */
    int64_t number_of_hidden_samples;
    /** An extent that holds all output voxels that may have changed since the last call. First >
     * last: none has. */
    int32_t changed_extent[6];
    /** The name of the device. The text belongs to the deformer, and stays until its next
     * dv_deform() or dv_destroy(). */
    const char* device;
    /** The warnings; "" where there is none. The text belongs to the deformer like that of device.
     */
    const char* warnings;
  } dv_report;

  /** Deforms the volume into the memory of the request. report may be null. */
  DV_EXPORT int32_t dv_deform(dv_deformer* deformer, const dv_request* request, dv_report* report);

  /** Bytes that the deformer holds on the device. */
  DV_EXPORT int32_t dv_device_memory(const dv_deformer* deformer, uint64_t* bytes);

  /** Frees what the deformer holds on the device. The next dv_deform() sends it again. */
  DV_EXPORT int32_t dv_release_memory(dv_deformer* deformer);

  /* ---- Cutting and carving ---- */

  /*
   * An edit takes tetrahedra out of the volume of a deformer, or divides them. It changes what the
   * next dv_deform() draws. Edits are those of vtkCutVolume and vtkCarveVolume, with the same bits.
   *
   *   dv_cut, dv_carve_surface, dv_carve_sphere, dv_carve_label, dv_carve_function,
   *   dv_undo_edit, dv_redo_edit, dv_reset_edits, dv_get_masks
   *
   * The volume is edited at rest, whatever its deformation is: sheets and bodies are given in world
   * coordinates where the volume lies before it is deformed. What is cut then moves as the tissue
   * does. vtkCutVolume and vtkCarveVolume can edit the deformed volume, too.
   *
   * Edits add up, and their order does not matter. They come on top of the masks that
   * dv_set_active_tetrahedra(), dv_set_boundary_distances() and dv_set_smooth_cut() set: these stay
   * as they are, and may be set before and after edits. dv_set_volume() with another grid forgets
   * all edits.
   *
   * What is given is read during the call only. The volume must be set first. A function that fails
   * or is aborted leaves the edits as they were.
   */

  /** Triangles: a sheet to cut with, or a closed surface to carve with. */
  typedef struct dv_surface
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** How many points there are. */
    int64_t number_of_points;
    /** Three numbers a point, in world coordinates. */
    const void* points;
    /** The type of these numbers, DV_FLOAT32 or DV_FLOAT64. */
    int32_t point_type;
    /** 0. */
    int32_t reserved;
    /** How many triangles there are, 1 or more. */
    int64_t number_of_triangles;
    /** The numbers of three points for each triangle, in any orientation. */
    const int64_t* triangles;
  } dv_surface;

  /** Which tetrahedra are inside a body. */
  enum
  {
    /** Those with their centroid inside: as large as the body. */
    DV_CARVE_CENTROID = 0,
    /** Those with any vertex inside: nothing of the body is left. */
    DV_CARVE_CONSERVATIVE = 1,
    /** Those with all vertices inside: nothing but the body is taken. */
    DV_CARVE_MINIMAL = 2
  };

  /** How an edit is made. Functions take a null pointer as one of zeros. */
  typedef struct dv_edit
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** Not 0: a sheet divides the tetrahedra that it crosses in place of switching them off; a body
     * is carved out with a boundary between the voxels, which switches tetrahedra off that have all
     * vertices inside, whatever the rule is, and leaves out samples of others. */
    int32_t smooth;
    /** DV_CARVE_CENTROID, ...: which tetrahedra a body takes where smooth is 0. */
    int32_t rule;
    /** The progress callback; null: none. */
    dv_progress progress;
    /** What progress gets as its argument user. */
    void* user;
  } dv_edit;

  /** Cuts with a sheet, which may be open, fold and cross itself: the tetrahedra that it crosses,
   * decided exactly on positions that are rounded to 1/256 voxel. A sheet that misses the volume
   * cuts nothing, which is no error. Fails where there are no triangles, and where a triangle has a
   * point that does not exist, is not finite or is more than 2^31 voxels away. */
  DV_EXPORT int32_t dv_cut(dv_deformer* deformer, const dv_surface* sheet, const dv_edit* edit);

  /** Carves out what a closed surface encloses, such as a box of twelve triangles: the points from
   * which a ray crosses the surface an odd number of times. Points in one place, to 1/256 voxel,
   * are one. Fails as dv_cut() does, and where the surface is open. */
  DV_EXPORT int32_t dv_carve_surface(
    dv_deformer* deformer, const dv_surface* surface, const dv_edit* edit);

  /** Carves out what a sphere sweeps along straight lines from center to center. centers: count
   * points of three numbers, in world coordinates; one point is the sphere itself. Fails where
   * there is no center, one is not finite, or the radius is not finite and greater than 0. */
  DV_EXPORT int32_t dv_carve_sphere(dv_deformer* deformer, int64_t count, const double* centers,
    double radius, const dv_edit* edit);

  /** Carves out where voxels have a label. labels: an array over the points of the volume, of one
   * component. They are compared as doubles: whole numbers up to 2^53. By DV_CARVE_CENTROID three
   * of the four vertices of a tetrahedron have the label; a smooth boundary lies halfway between
   * voxels. Fails where no voxel has the label. */
  DV_EXPORT int32_t dv_carve_label(
    dv_deformer* deformer, const dv_array* labels, double label, const dv_edit* edit);

  /** Finds numbers for some points. points: three numbers each, in world coordinates. It is called
   * while the function works that it was given to, in threads of the library. It must neither throw
   * nor call functions for the same object. */
  typedef void (*dv_point_function)(
    int64_t count, const double* points, double* values, void* user);

  /** A body by a function that is negative inside. */
  typedef struct dv_body
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The function, one number a point. Values that are no numbers are outside. */
    dv_point_function values;
    /** The gradients of the function, three numbers a point, for smooth edits: the distance of a
     * point from the boundary is the value by the length of the gradient. Null: the values are
     * distances, in world units. */
    dv_point_function gradients;
    /** What both get as their argument user. */
    void* user;
    /** Not 0: several threads may call both at once. 0: one at a time does. */
    int32_t is_thread_safe;
    /** 0. */
    int32_t reserved;
    /** x min, x max, y min, y max, z min, z max, in world coordinates: nothing is inside the body
     * beyond them, nor looked at there. All 0: all of the volume is looked at. */
    double bounds[6];
  } dv_body;

  /** Carves out a body. Fails where it has no function, or bounds that are not finite or not in
   * ascending order. */
  DV_EXPORT int32_t dv_carve_function(
    dv_deformer* deformer, const dv_body* body, const dv_edit* edit);

  /** Undoes the last edit, bit for bit. Fails where there is none. */
  DV_EXPORT int32_t dv_undo_edit(dv_deformer* deformer);
  /** Makes the edit again that was undone last. Fails where there is none, as after another edit.
   */
  DV_EXPORT int32_t dv_redo_edit(dv_deformer* deformer);
  /** Forgets all edits. */
  DV_EXPORT int32_t dv_reset_edits(dv_deformer* deformer);

  /** The masks of a volume with its edits, in the shapes that dv_set_active_tetrahedra(),
   * dv_set_boundary_distances() and dv_set_smooth_cut() take. Null: there is no such mask. What no
   * edit has changed is the memory that the program has given. All else belongs to the deformer,
   * and stays until the next function that edits or sets a mask, dv_set_volume() or dv_destroy().
   */
  typedef struct dv_masks
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The active tetrahedra, a byte a cell. */
    const uint8_t* active;
    /** The distances to a smooth boundary, a float a voxel; those of edits in world units. */
    const float* boundary_distances;
    /** The tetrahedra that smooth cuts divide, a byte a cell. */
    const uint8_t* crossed;
    /** The distances from the sheets, a float a voxel; those of edits in voxels. */
    const float* cut_distances;
    /** Tetrahedra that edits have switched off, and that were active before. */
    int64_t number_of_switched_off_tetrahedra;
    /** Tetrahedra that edits have divided, and that were whole before. */
    int64_t number_of_divided_tetrahedra;
    /** Edits, without those that are undone. */
    int32_t number_of_edits;
    /** Edits that are undone, and can be redone. */
    int32_t number_of_undone_edits;
  } dv_masks;

  /** Gets the masks of the volume. */
  DV_EXPORT int32_t dv_get_masks(dv_deformer* deformer, dv_masks* masks);

  /* ---- ChainMail ---- */

  /**
   * The tissue of a volume that is dragged by handles, with a stiffness that follows the image:
   * what vtkChainMailDeformation does, with the same bits. Each voxel is linked to its six
   * neighbours. A link may be stretched, compressed and sheared within the limits of the materials
   * at its ends. Handles hold voxels and move them; others follow, each by as little as possible,
   * and relaxation evens out the displacements (Documents/chainmail.md).
   *
   *   dv_chainmail_create, dv_chainmail_set_materials, dv_chainmail_set_pinned,
   *   dv_chainmail_set_active_tetrahedra, dv_chainmail_step, dv_chainmail_reset,
   *   dv_chainmail_displacements, dv_set_chainmail, dv_chainmail_destroy
   *
   * Displacements are kept from step to step, so that a drag goes on. All memory that is given is
   * read during the call only. A function that fails or is aborted leaves the displacements as they
   * were, but for failures of the device: then only dv_chainmail_destroy() is left to be called.
   *
   * It takes 15 bytes a voxel on the device, in blocks of 8 x 8 x 8 voxels, and the displacements
   * 12 bytes.
   */
  typedef struct dv_chainmail dv_chainmail;

  /** Makes a ChainMail, to be destroyed with dv_chainmail_destroy(). grid: that of the volume at
   * rest, two points or more on each axis. device: as for dv_set_device(). memory_limit: how many
   * bytes may be used on the device; 0: what it has available. All voxels are at rest, and soft
   * tissue. */
  DV_EXPORT int32_t dv_chainmail_create(
    const dv_grid* grid, const char* device, uint64_t memory_limit, dv_chainmail** chainmail);
  /** Null is allowed. Deformers that use the displacements keep what they need of them. */
  DV_EXPORT void dv_chainmail_destroy(dv_chainmail* chainmail);

  /** The name of the device. Null, with an error, where there is no ChainMail. The text belongs to
   * the ChainMail. */
  DV_EXPORT const char* dv_chainmail_device(const dv_chainmail* chainmail);

  /** The materials of the voxels. */
  typedef struct dv_chainmail_materials
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The limits of the materials from 0 on, three numbers each, as fractions of the spacing: the
     * shortest that a link may be along its axis, 0 to 1; the longest, 1 to 1000; and how far its
     * ends may move past each other across it, 0 to 1000. A link between two materials has the mean
     * of their limits. Null: 0 is air (0.1, 2, 1), 1 soft tissue (0.5, 1.5, 0.5), 2 muscle (0.8,
     * 1.2, 0.2), 3 cartilage (0.95, 1.05, 0.05), 4 bone (0.99, 1.01, 0.01). */
    const double* table;
    /** How many materials the table has, 1 to 256. */
    int32_t number_of_materials;
    /** The number of the material of voxels for which nothing else tells one. */
    int32_t default_material;
    /** What tells the material of each voxel: an array of one component over the volume. Without
     * ranges its values are numbers of materials. Null: all voxels have the default material. */
    const dv_array* values;
    /** Three numbers each: voxels with a value of the first one or more, and less than the second
     * one, have the material with the third one as its number. The first range that holds a value
     * counts. */
    const double* ranges;
    /** How many ranges there are. */
    int64_t number_of_ranges;
  } dv_chainmail_materials;

  /** Sets the materials. Where displacements exceed the new limits, all are put to 0. Fails where a
   * voxel has no material, and where a limit is out of its range. */
  DV_EXPORT int32_t dv_chainmail_set_materials(
    dv_chainmail* chainmail, const dv_chainmail_materials* materials);

  /** Which voxels do not move. pinned: one byte a voxel, not 0 where the voxel is pinned. Null:
   * none is. */
  DV_EXPORT int32_t dv_chainmail_set_pinned(dv_chainmail* chainmail, const uint8_t* pinned);

  /** Where the tissue is cut or carved, in the shapes of dv_set_active_tetrahedra() and
   * dv_set_smooth_cut(), such as dv_get_masks() gives them. A link is there if one of the up to
   * four tetrahedra that have it as an edge is active, and not crossed. Null: all are active, none
   * is crossed. Where links come back that the displacements exceed, all are put to 0. */
  DV_EXPORT int32_t dv_chainmail_set_active_tetrahedra(
    dv_chainmail* chainmail, const uint8_t* active, const uint8_t* crossed);

  /** What a step is to do. */
  typedef struct dv_chainmail_request
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** How many handles there are; 0 to relax only. */
    int64_t number_of_handles;
    /** The place in the volume at rest that each handle holds: three numbers, in world
     * coordinates. */
    const double* rest_positions;
    /** Where each handle is now: three numbers, in world coordinates. It displaces its voxels by
     * the difference, at most 4095 voxels on each axis. */
    const double* positions;
    /** How far round its rest position a handle holds voxels, in world units, 0 or more; at least
     * the nearest voxel is held. */
    double handle_radius;
    /** How much of the way to the weighted mean of its neighbours a voxel moves in a sweep of
     * relaxation, 0 to 1. 1 in vtkChainMailDeformation by default. */
    double elasticity;
    /** Voxels that are nearer to that mean than this fraction of the spacing stay where they are,
     * on each axis by itself, 0 or more. */
    double plasticity_threshold;
    /** Sweeps of relaxation, over the blocks that were moved in the last 30 steps, 0 or more. 5 in
     * vtkChainMailDeformation by default. */
    int32_t relaxation_sweeps;
    /** 0. */
    int32_t reserved;
    /** The progress callback; null: none. It gets 0 each time: how long a step takes is not known
     * before. */
    dv_progress progress;
    /** What progress gets as its argument user. */
    void* user;
  } dv_chainmail_request;

  /** What a step has done. */
  typedef struct dv_chainmail_report
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** Rounds over the blocks that move, and sweeps of relaxation. */
    int64_t number_of_sweeps;
    /** Voxels whose displacement is not what it was before the step. */
    int64_t number_of_moved_voxels;
    /** The largest violation of a limit by a voxel that moved, as a fraction of the spacing: 0
     * unless something is wrong. */
    double largest_violation;
    /** Handles whose displacement was reduced so that pinned voxels and handles before them stay.
     */
    int32_t number_of_reduced_handles;
    /** Handles that were released, since no displacement of their voxels would do. */
    int32_t number_of_released_handles;
    /** Not 0: all displacements were put to 0 since the last step. */
    int32_t was_reset;
    /** An extent that holds all voxels whose displacement has changed since the last step. First >
     * last: none has. */
    int32_t changed_extent[6];
  } dv_chainmail_report;

  /** Moves the handles, and relaxes. report may be null. Fails where a handle is outside the
   * volume, is moved too far, or has a coordinate that is not finite. */
  DV_EXPORT int32_t dv_chainmail_step(
    dv_chainmail* chainmail, const dv_chainmail_request* request, dv_chainmail_report* report);

  /** Puts all voxels to rest. */
  DV_EXPORT int32_t dv_chainmail_reset(dv_chainmail* chainmail);

  /** The displacements of all voxels: three floats each, in world units, x varying fastest. The
   * memory belongs to the ChainMail, and stays the same. On a device with memory of its own, this
   * call brings it up to date; on a processor each step does. */
  DV_EXPORT int32_t dv_chainmail_displacements(
    dv_chainmail* chainmail, const float** displacements);

  /** Bytes that the ChainMail and its displacements hold on the device. */
  DV_EXPORT int32_t dv_chainmail_device_memory(const dv_chainmail* chainmail, uint64_t* bytes);

  /** The displacements of a ChainMail, in place of the mesh or field before. They are used where
   * they lie, and dv_deform() follows each step without another call. Where the deformer has the
   * same device, nothing passes through the host. While dv_deform() and dv_output_grid() run, no
   * other thread may use the ChainMail. */
  DV_EXPORT int32_t dv_set_chainmail(dv_deformer* deformer, const dv_chainmail* chainmail);

#ifdef __cplusplus
}
#endif

#endif
