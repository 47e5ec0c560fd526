/* dea.h: design and simulation of dielectric elastomer actuators. The whole interface of libdea.
 *
 *   cc program.c $(pkg-config --cflags --libs libdea)
 *
 * An actuator is a design: values with units under keys such as "film.thickness". Studies are run
 * on it with models; what they find are arrays with names such as "3d/sweep/voltage_V".
 *
 *   dea_context *ctx;
 *   dea_design *design;
 *   dea_result *result;
 *   const dea_array *volts;
 *   dea_context_new(NULL, &ctx);
 *   dea_design_open(ctx, "my.yaml", &design);
 *   dea_design_set(ctx, design, "film.thickness", "80 um");
 *   dea_run(ctx, design, NULL, &result);
 *   dea_result_array(ctx, result, "lumped/sweep/voltage_V", &volts);
 *
 * Rules that hold everywhere:
 *
 *   Errors. What can fail takes the context first and returns a dea_status; the context then has
 *   the message, and findings with their place in the design. Objects are as they were after a
 *   status below DEA_STATUS_SUSPECT. What a call cannot hand out is NULL. A model that lacks an
 *   ability says so as an error, DEA_E_UNSUPPORTED. The library neither prints nor ends the
 * program. Ownership. `_new`, `_open`, `_parse`, `_copy` and dea_run give an object; its `_free`
 * takes it back (NULL is fine) and comes before that of the context that made it. All else is lent:
 * until its object is freed, or as the function says. `_at` functions count from 0 and are NULL
 * beyond the last. Units. SI, and in the name: voltage_V, radius_m. Texts may have any unit: "80
 * um", "2 kV". Not known is NAN. Lengths are in the pre-stretched flat film; z is positive to the
 * fibres. Growth. Structs that the library hands out get new members at their end; structs that you
 * fill begin with their size, which their DEA_..._INIT sets, and a member that is 0 means the
 * default. Threads. A context and what it made belong to one thread at a time; different contexts
 * may compute at once (3D models take turns), but not read or write results at once. dea_run only
 * reads the design.
 *
 * The lines between the two marks of each part are plain C declarations, for the wrappers of other
 * languages. */
#ifndef DEA_H
#define DEA_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

#ifndef DEA_INSIDE // the library's own sources have these from their own lists
/* [declarations] */

typedef enum dea_status {
  DEA_OK,
  DEA_E_DIFFERS,     // a comparison is out of tolerance
  DEA_E_USAGE,       // of the command line
  DEA_E_ARGUMENT,    // an argument is out of range, a name is not known
  DEA_E_UNSUPPORTED, // this build, or this model, cannot do that
  DEA_E_DESIGN,      // the design has errors: see the findings
  DEA_E_IO,          // a file could not be read or written
  DEA_E_TOOL,        // an external program (gnuplot) failed or is missing
  DEA_E_INSTRUMENT,
  DEA_E_INTERLOCK,
  DEA_E_MEMORY,
  DEA_E_DOMAIN,         // a material law was asked beyond its domain
  DEA_STATUS_SUSPECT,   // never returned; from here on there are partial results
  DEA_E_NOT_CONVERGED,  // the solver did not converge
  DEA_E_NO_EQUILIBRIUM, // there is none at this load: pull-in
  DEA_E_INTERRUPTED,    // the interrupt callback said so
  DEA_E_SLACK,          // the film loses its tension on the way
  DEA_E_INVERTED        // an element of the mesh turns inside out
} dea_status;

enum dea_severity { DEA_NOTE, DEA_WARNING, DEA_ERROR };

/* Where a value of a design comes from. */
enum dea_origin {
  DEA_ABSENT, // not given, no default
  DEA_DEFAULT,
  DEA_GIVEN,   // in the file or text
  DEA_OVERRIDE // set by dea_design_set
};

/* How the components of a field go over to a mirrored copy. */
enum dea_mesh_kind {
  DEA_MESH_VALUES, // numbers that do not know directions
  DEA_MESH_VECTOR, // x, y, z
  DEA_MESH_AXIS    // a direction of length 1 without sign
};

/* [end] */
#endif
/* [declarations] */

typedef struct dea_context_handle dea_context;
typedef struct dea_design_handle dea_design;
typedef struct dea_result_handle dea_result;

// Version and status --------------------------------------------------------------------------

/* "0.5.0" of the library that is loaded. */
const char *dea_version(void);
/* "DEA_E_IO"; and one sentence about it. Never NULL. */
const char *dea_error_name(dea_status status);
const char *dea_error_meaning(dea_status status);

// Context: memory, messages, progress, interruption -------------------------------------------

typedef struct {
  size_t size; // set by DEA_CONTEXT_OPTIONS_INIT
  void *user;  // first argument of all that follow; each may be NULL
  /* During a run: done of total (0: not known) of what ("3d sweep"). */
  void (*progress)(void *user, const char *what, size_t done, size_t total);
  /* Asked again and again during a run; not 0: stop, keep what is there, DEA_E_INTERRUPTED. */
  int (*interrupt)(void *user);
  /* Notes and warnings as a run finds them; they are among the findings too. */
  void (*note)(void *user, enum dea_severity severity, const char *text);
  /* Memory, both or neither: resize is realloc (pointer may be NULL, size is never 0). */
  void *(*resize)(void *user, void *pointer, size_t size);
  void (*release)(void *user, void *pointer);
} dea_context_options;

/* options: NULL for the defaults; copied. */
dea_status dea_context_new(const dea_context_options *options, dea_context **out);
void dea_context_free(dea_context *ctx);

/* Of the last call that failed: one sentence ("" before any); the functions that it went through.
 * Lent until the next call. */
const char *dea_error_message(const dea_context *ctx);
const char *dea_error_trace(const dea_context *ctx);

/* What was found in a design or during a run. */
typedef struct {
  enum dea_severity severity;
  const char *text; // one sentence
  const char *file; // as the design was named, or "--set KEY" of what was set; "" without a place
  size_t line, column; // from 1; 0: not known
} dea_finding;

/* Findings of the last call that reads, sets, checks, runs or solves, in their order; lent until
 * the next such call. */
const dea_finding *dea_finding_at(dea_context *ctx, size_t index);

// Designs -------------------------------------------------------------------------------------

/* A value of a design, as written and in SI. */
typedef struct {
  const char *key;  // "film.thickness"
  const char *text; // "80 um"; of a default as it would be written; "" when absent
  double si;        // 8e-05; NAN for what is no number
  const char *unit; // of si: "m", "1" for a pure number; "" for what is no number
  enum dea_origin origin;
  size_t line, column; // in the file; 0: not there
} dea_value;

/* Reads a design file (docs/design-file.md), or YAML text that `name` stands for in findings.
 * DEA_E_DESIGN with all errors as findings. */
dea_status dea_design_open(dea_context *ctx, const char *path, dea_design **out);
dea_status dea_design_parse(dea_context *ctx, const char *text, const char *name, dea_design **out);
dea_status dea_design_copy(dea_context *ctx, const dea_design *design, dea_design **out);
void dea_design_free(dea_design *design);

/* Sets the value of a key, as it would stand in the file: "80 um", "[1 kV, 2 kV]", "null" to take
 * the key away. DEA_E_DESIGN and no change when key or value are not understood or do not fit. */
dea_status dea_design_set(dea_context *ctx, dea_design *design, const char *key, const char *value);
/* Several at once, [count] each, for values that fit only together. */
dea_status dea_design_set_all(dea_context *ctx, dea_design *design, const char *const *keys,
                              const char *const *values, size_t count);
/* The value of a key, defaults too. DEA_E_ARGUMENT for one that no design has. *out: lent until the
 * design is set or freed. */
dea_status dea_design_get(dea_context *ctx, const dea_design *design, const char *key,
                          const dea_value **out);
/* All values in the order of the schema; lent as above. */
const dea_value *dea_design_value_at(const dea_design *design, size_t index);
/* The design as YAML with what was set (comments stay only when nothing was); lent as above. */
dea_status dea_design_text(dea_context *ctx, dea_design *design, const char **out);
dea_status dea_design_write(dea_context *ctx, dea_design *design, const char *path);
/* Checks all that a run would: geometry, materials, models. DEA_E_DESIGN with findings. Notes and
 * warnings come with DEA_OK too. */
dea_status dea_design_check(dea_context *ctx, const dea_design *design);
/* The actuator from above and cut along a fibre, as SVG; lent until the design is set or freed. */
dea_status dea_design_svg(dea_context *ctx, dea_design *design, const char **out);

// Models and studies --------------------------------------------------------------------------

/* What a model can do beside the equilibrium at a voltage. */
typedef enum {
  DEA_CAN_PATH = 1,     // the whole equilibrium path, with pull-in: study path
  DEA_CAN_PROFILE = 2,  // values along the radius
  DEA_CAN_INDENT = 4,   // a probe pressed into the film: study force
  DEA_CAN_MODES = 8,    // natural modes: study modal
  DEA_CAN_RESPOND = 16, // the response to a small AC voltage: study frequency
  DEA_CAN_FIELDS = 32,  // meshes with fields
  DEA_CAN_TIME = 64,    // waveforms, creep: study transient
  DEA_CAN_REFINE = 128  // has a mesh that can be refined: study convergence
} dea_ability;

typedef struct {
  const char *name;          // "lumped", "axisymmetric", "3d"
  const char *title;         // for figures
  unsigned abilities;        // sum of dea_ability, of a disc in a round frame
  int available;             // 0: its module is not installed
  unsigned layout_abilities; // the same of devices made of `plies`; 0: knows only discs
} dea_model_info;

const dea_model_info *dea_model_at(dea_context *ctx, size_t index);

typedef struct {
  const char *name;  // "sweep"
  const char *needs; // keys of the design without which it cannot run; "": none
} dea_study_info;

const dea_study_info *dea_study_at(dea_context *ctx, size_t index);

typedef struct {
  size_t size;               // set by DEA_RUN_OPTIONS_INIT
  const char *const *models; // [model_count]; 0: those of the design
  size_t model_count;
  const char *const *studies; // [study_count]; 0: those that the design asks for
  size_t study_count;
  const char *folder; // run folder, written as the run goes (docs/results.md); NULL: none
  int replace;        // the results that are in the folder; else DEA_E_IO when there are some
  int resume;         // go on where the run in the folder stopped (model 3d)
  int no_figures;     // in the folder
} dea_run_options;

/* Runs studies on a design. options: NULL for the defaults. *out is NULL only when the run could
 * not begin: after DEA_E_NOT_CONVERGED, DEA_E_INTERRUPTED and the like it has what was computed. */
dea_status dea_run(dea_context *ctx, const dea_design *design, const dea_run_options *options,
                   dea_result **out);

// Results -------------------------------------------------------------------------------------

/* Numbers with a name, row by row: data[i * shape[1] + j]. */
typedef struct {
  const char *name;    // "3d/sweep/voltage_V"
  const char *unit;    // SI: "V"; "1" for a pure number
  const char *meaning; // one clause
  size_t rank;         // 1 to 3
  size_t shape[3];     // 1 beyond rank
  const double *data;  // NAN where there is no value
} dea_array;

/* Arrays are named by model, study and quantity:
 *   MODEL/STUDY/KEY           of each point; keys as in docs/results.md, those of a device's
 * monitors (hub_z_m) and channels too, and stable (1 or 0), unstable_modes, trusted (1 or 0), flags
 * (a sum of powers of two) MODEL/STUDY/KIND/KEY      where its path turns or ends: KIND pull_in,
 * snap_back, slack, breakdown MODEL/profiles/NNNN/KEY   along the radius, NNNN counts the points of
 * the sweep from 0000 MODEL/STUDY/NNNN/KEY      of studies convergence and compare-design, one NNNN
 * a mesh or design */
const dea_array *dea_result_array_at(const dea_result *result, size_t index);
/* Of a monitor or channel the unit at the end may be left out: 3d/sweep/hub_z. DEA_E_ARGUMENT when
 * there is none of that name. */
dea_status dea_result_array(dea_context *ctx, const dea_result *result, const char *name,
                            const dea_array **out);
/* Texts: title, file, design (the text), set ("key=value" a line), program, libraries, started,
 * sha256, summary (JSON, docs/formats.md), MODEL/STUDY/status and MODEL/STUDY/stopped (why it ended
 * early, ""), MODEL/STUDY/NNNN/name. DEA_E_ARGUMENT when there is none of that name. */
dea_status dea_result_text(dea_context *ctx, dea_result *result, const char *name,
                           const char **out);
/* A figure of the run as SVG, without gnuplot: "displacement", "stretch", "field", ...; "" for the
 * first that has something to show. DEA_E_ARGUMENT when there is no such figure or it shows
 * nothing. Lent until the next call of this function. */
dea_status dea_result_svg(dea_context *ctx, dea_result *result, const char *figure,
                          const char **out);

/* Writes a run folder: results.h5, summary.json, tables, figures (DEA_E_TOOL without gnuplot: all
 * but those). options: replace and no_figures count; NULL for the defaults. */
dea_status dea_result_write(dea_context *ctx, const dea_result *result, const char *folder,
                            const dea_run_options *options);
/* Writes results.h5 alone, to that path; and reads such a file, or the run folder that has it. */
dea_status dea_result_save(dea_context *ctx, const dea_result *result, const char *path);
dea_status dea_result_open(dea_context *ctx, const char *path, dea_result **out);
void dea_result_free(dea_result *result);
/* The design that was computed, with what was set. */
dea_status dea_result_design(dea_context *ctx, const dea_result *result, dea_design **out);

// Fields --------------------------------------------------------------------------------------

/* Cells of one kind: quadrilaterals (order_z 0) or hexahedra, of order 1 to 3 in the plane and
 * order_z through the thickness. */
typedef struct {
  int order, order_z;
  size_t count, nodes_per_cell; // (order + 1)^2 (order_z + 1)
  const int
      *nodes; // [count][nodes_per_cell]: from 0, first local axis fastest, Gauss-Lobatto nodes
} dea_cells;

typedef struct {
  const dea_array *array; // "displacement_m"; shape [points or cells][components]
  enum dea_mesh_kind kind;
  int of_cells; // 1: one row a cell, over all cells in their order; 0: one a point
} dea_field;

typedef struct {
  const char *name; // "3d/surface/0004": of the sweep's point 4, 3d_modal/surface/0000: shapes
  double voltage_V;
  size_t point_count;
  const double *points_m; // [point_count][3], in the stretched flat film
  size_t cells_count;
  const dea_cells *const *cells; // [cells_count]
  size_t field_count;
  const dea_field *const *fields; // [field_count]
  /* The whole is 2 fold mirrored copies of this part between the planes of symmetry through the z
   * axis at this angle and pi/fold further; 0: this is the whole. */
  int fold;
  double symmetry_angle_rad;
} dea_mesh;

/* The film's middle surface at the points of a sweep, and modes, of models with fields. */
const dea_mesh *dea_result_mesh_at(const dea_result *result, size_t index);
/* whole: 1 for all mirrored copies. *out: lent until the result is freed. */
dea_status dea_result_mesh(dea_context *ctx, dea_result *result, const char *name, int whole,
                           const dea_mesh **out);

// One actuator, step by step ------------------------------------------------------------------

/* A model of a design and its state. */
typedef struct dea_actuator_handle dea_actuator;

/* The design as it is now; later changes to it do not reach the actuator. */
dea_status dea_actuator_open(dea_context *ctx, const dea_design *design, const char *model,
                             dea_actuator **out);
void dea_actuator_free(dea_actuator *actuator);
/* Stable equilibrium at a voltage, reached from the last one (at first the flat film at 0 V).
 * DEA_E_NO_EQUILIBRIUM beyond pull-in: the actuator stays at its last point. */
dea_status dea_actuator_solve(dea_context *ctx, dea_actuator *actuator, double voltage_V);
/* A rigid indenter without friction, from the side of the fibres to `depth_m` beyond touching the
 * flat film at the last voltage; it stays there, its shape that of the first call. Needs
 * DEA_CAN_INDENT. */
typedef enum { DEA_SPHERE, DEA_FLAT_END, DEA_LYING_CYLINDER } dea_indenter_shape;
dea_status dea_actuator_indent(dea_context *ctx, dea_actuator *actuator, dea_indenter_shape shape,
                               double radius_m, double depth_m);
/* A quantity of the last point by its key ("centre_z_m", "force_N"; docs/results.md); NAN when the
 * model has none. */
dea_status dea_actuator_get(dea_context *ctx, const dea_actuator *actuator, const char *key,
                            double *out);
/* All fields at the last point, in the volume. Needs DEA_CAN_FIELDS. Lent until the next call with
 * this actuator. */
dea_status dea_actuator_mesh(dea_context *ctx, dea_actuator *actuator, const dea_mesh **out);

// Solids: the 3D engine with a mesh of your own -----------------------------------------------

typedef struct dea_solid_handle dea_solid;

typedef struct {
  const char *name;       // "yeoh"
  const char *title;      // "Yeoh (1993), third order in I1 - 3"
  const char *parameters; // in their order: "c1 [Pa], c2 [Pa], c3 [Pa]"
  size_t parameter_count;
} dea_law_info;

/* Hyperelastic laws; lent until the next call of this function. */
const dea_law_info *dea_law_at(dea_context *ctx, size_t index);

/* Material of a part. */
typedef struct {
  size_t size;              // set by DEA_PART_INIT
  const char *law;          // incompressible, of dea_law_at; NULL: compressible, of the next two
  double young_modulus_Pa;  // with NULL
  double poisson_ratio;     // with NULL; below 0.49
  const double *parameters; // [parameter_count] of the law, SI
  size_t parameter_count;
  double bulk_modulus_Pa;   // of the law's iteration to volume 1; 0: 100 times the shear modulus
  double pre_stretch;       // equibiaxial in x and y, of the law; 0: 1
  double permittivity;      // relative
  double electrode_gap_m;   // between electrodes: height that the voltage stands over; 0: it is not
  double density_kg_per_m3; // for modes
  /* Of the electrodes above and below a part with a gap: channels from 1, or 0 for ground. Both 0:
   * channel 1 above ground. */
  int channel_above, channel_below;
} dea_part;

/* A part in a ply of a plane mesh: where it is in a group, a physical surface. */
typedef struct {
  size_t ply;        // 0: the lowest
  const char *group; // NULL: everywhere
  size_t part;
} dea_fill;

/* Nodes that move as one, by a shift and a rotation vector (docs/theory/bodies.md). */
typedef struct {
  size_t size;                // set by DEA_BODY_INIT
  double low_m[3], high_m[3]; // its nodes: those with low <= X <= high; both 0: everywhere
  const char *curve;          // of these only nodes on, above and below a physical curve of the
                              // .msh file; NULL: all
  double centre_m[3];         // X_0: what it turns about, and where its shift is told
  const int *nodes;           // [node_count] of these only, from 0; NULL: all
  size_t node_count;
} dea_body;

/* Pulls a body back along one component of its shift or its rotation vector, by a force (moment) F
 * of y, how far that component is beyond `place`: F = stiffness y, or a table. */
typedef struct {
  size_t size;      // set by DEA_BODY_SPRING_INIT
  size_t body;      // its number
  int component;    // 1, 2, 4: shift along x, y, z; 8, 16, 32: of the rotation vector
  double place;     // of the outer end [m or rad]
  double stiffness; // 0 or more [N/m or N m/rad]
  /* A table in place of the stiffness: a monotone cubic through its points, straight on beyond its
   * ends. F may fall, as that of a bistable spring does. */
  size_t count;        // 0: none; 2 or more
  const double *at;    // [count] y, rising [m or rad]
  const double *force; // [count] F [N or N m]
} dea_body_spring;

typedef struct {
  size_t size;        // set by DEA_SOLID_OPTIONS_INIT
  int order, order_z; // of the elements, 1 to 3; 0: 2
  double box_m[3];    // a box from the origin, of part 0, with so many elements; or
  size_t elements[3];
  size_t point_count;     // points and hexahedra, nodes as in dea_cells
  const double *points_m; // [point_count][3]
  size_t cell_count;
  const int *cells;             // [cell_count][(order + 1)^2 (order_z + 1)]
  const int *part_of;           // [cell_count]; NULL: all of part 0
  const dea_part *const *parts; // [part_count]
  size_t part_count;
  /* Or a plane mesh of quadrilaterals of first or second order from a file of Gmsh (.msh, ASCII,
   * 2.2 or 4.1), extruded through plies from z = 0 up. Heights are the same everywhere: where a ply
   * has no part there is a gap. `order` is that of the file. */
  const char *msh_file;
  double msh_unit_m; // length of a unit of the file; 0: 1e-3
  size_t ply_count;
  const double *ply_thickness_m; // [ply_count]
  const size_t *ply_elements;    // [ply_count] elements through it; NULL: 1
  size_t fill_count;
  const dea_fill *fills; // [fill_count], later ones over earlier ones
  /* Rigid bodies, at first free. They bring two points each, behind those of the mesh. A node of
   * several is of the last one. */
  size_t body_count;
  const dea_body *const *bodies; // [body_count]
} dea_solid_options;

/* Copies all. DEA_E_UNSUPPORTED where the 3D engine is not installed. */
dea_status dea_solid_new(dea_context *ctx, const dea_solid_options *options, dea_solid **out);
void dea_solid_free(dea_solid *solid);
/* Holds components (1: x, 2: y, 4: z, or sums of them) of the nodes with low <= X <= high at a
 * displacement that the next solve goes to; NULL frees them. DEA_E_ARGUMENT: no node is there. */
dea_status dea_solid_hold(dea_context *ctx, dea_solid *solid, const double low_m[3],
                          const double high_m[3], int components, const double displacement_m[3]);
/* The same of the nodes on, above and below a curve: a physical curve of the .msh file. low_m and
 * high_m: only those there; both NULL: all. DEA_E_ARGUMENT: there is no such curve or node. */
dea_status dea_solid_hold_curve(dea_context *ctx, dea_solid *solid, const char *curve,
                                const double low_m[3], const double high_m[3], int components,
                                const double displacement_m[3]);
/* The same of the nodes [count] with these numbers, from 0: rows of points_m. */
dea_status dea_solid_hold_nodes(dea_context *ctx, dea_solid *solid, const int *nodes, size_t count,
                                int components, const double displacement_m[3]);
/* Holds components of a body (1, 2, 4: shift along x, y, z; 8, 16, 32: of the rotation vector, or
 * sums of them) at a shift and a rotation vector that the next solve goes to; both NULL frees them.
 */
dea_status dea_solid_hold_body(dea_context *ctx, dea_solid *solid, size_t body, int components,
                               const double shift_m[3], const double turn_rad[3]);
/* A dead force at the centre of a body, and a moment (while turns are small), for the solves to
 * come; in place of what was there. */
dea_status dea_solid_push_body(dea_context *ctx, dea_solid *solid, size_t body,
                               const double force_N[3], const double moment_N_m[3]);
/* Adds a spring between a body and the outside; copied. The next solve brings its outer end from
 * where the body is to its place. Springs count from 0 in the order in which they were added. */
dea_status dea_solid_add_spring(dea_context *ctx, dea_solid *solid, const dea_body_spring *spring);
/* Another place of a spring's outer end [m or rad], that the next solve goes to. */
dea_status dea_solid_move_spring(dea_context *ctx, dea_solid *solid, size_t spring, double place);
/* Adds a force per reference area on the faces of elements whose middles are there; an outer face
 * of the solid is a box without thickness. */
dea_status dea_solid_pull(dea_context *ctx, dea_solid *solid, const double low_m[3],
                          const double high_m[3], const double traction_Pa[3]);
/* Voltage of a channel that the next solve goes to, beside the one that is given to the solve,
 * which all channels have; at first 0. DEA_E_ARGUMENT: no part is on it. */
dea_status dea_solid_set_channel(dea_context *ctx, dea_solid *solid, int channel, double voltage_V);
/* A tolerance or limit of the solvers. */
typedef struct {
  const char *name;    // "newton_rtol"
  const char *unit;    // what a relative number is relative to: "of the sum of element forces"
  const char *meaning; // "forces left at an equilibrium"
  double value;
} dea_solid_setting;

/* The settings of a solid as they are, by their number; NULL beyond the last. Lent until the next
 * call of this function. */
const dea_solid_setting *dea_solid_setting_at(dea_context *ctx, const dea_solid *solid,
                                              size_t index);
/* Changes one for the solves to come. DEA_E_ARGUMENT for an unknown name or a value that cannot be:
 * all are above 0. */
dea_status dea_solid_set(dea_context *ctx, dea_solid *solid, const char *name, double value);
/* Stable equilibrium with these supports, loads and voltage, in steps where they are needed. */
dea_status dea_solid_solve(dea_context *ctx, dea_solid *solid, double voltage_V);
/* Charges at the last equilibrium, and what they change by with the voltages, at displacements that
 * are held and in equilibrium: arrays channel_V, charge_C [channels + 1], with ground first;
 * capacitance_held_F, capacitance_F [channels + 1][channels + 1]. DEA_E_NO_EQUILIBRIUM: it is
 * unstable. */
dea_status dea_solid_find_charges(dea_context *ctx, dea_solid *solid);
/* The lowest natural modes at the last equilibrium, 1 to 200: arrays mode_Hz, mode_shape. */
dea_status dea_solid_modes(dea_context *ctx, dea_solid *solid, size_t count);
/* Begins a path by arc-length, through unstable equilibria too, from the last equilibrium (load 0)
 * to what is now asked for (load 1), and beyond. step: length of the first step (below 0: the other
 * way), unit_m: a displacement that counts as much as the whole load. */
dea_status dea_solid_path_begin(dea_context *ctx, dea_solid *solid, double voltage_V, double step,
                                double unit_m);
/* The next point of the path: numbers load, arc, voltage_V, unstable_modes. */
dea_status dea_solid_path_step(dea_context *ctx, dea_solid *solid);
/* points_m, displacement_m, reaction_N, force_N [points][3], mode_Hz [modes] (negative: unstable),
 * mode_shape [modes][points][3], of bodies body_shift_m, body_turn_rad, and what holds them,
 * body_force_N, body_moment_N_m [bodies][3], by which springs pull back spring_force_N,
 * spring_moment_N_m [springs] (NAN for those of the other kind), and those of
 * dea_solid_find_charges. *out: lent until the next call of this function; its numbers until the
 * next solve, step or modes. DEA_E_ARGUMENT for another name, or when there are none. */
dea_status dea_solid_array(dea_context *ctx, dea_solid *solid, const char *name,
                           const dea_array **out);
/* Stretches, stresses, tension, field, energy and error of volume at the last equilibrium, on
 * meshes of hexahedra: a point is one node in one ply and part, cells have the number of their part
 * as "region". Lent until the next call of this function with this solid. */
dea_status dea_solid_mesh(dea_context *ctx, dea_solid *solid, const dea_mesh **out);
/* voltage_V, energy_J, unstable_modes, iterations, load, arc. */
dea_status dea_solid_number(dea_context *ctx, const dea_solid *solid, const char *name,
                            double *out);

/* [end] */

#define DEA_CONTEXT_OPTIONS_INIT                                                                   \
  {                                                                                                \
    sizeof(dea_context_options), NULL, NULL, NULL, NULL, NULL, NULL                                \
  }
#define DEA_PART_INIT                                                                              \
  {                                                                                                \
    sizeof(dea_part), NULL, 0, 0, NULL, 0, 0, 0, 0, 0, 0, 0, 0                                     \
  }
#define DEA_BODY_INIT                                                                              \
  {                                                                                                \
    sizeof(dea_body), {0, 0, 0}, {0, 0, 0}, NULL, {0, 0, 0}, NULL, 0                               \
  }
#define DEA_BODY_SPRING_INIT                                                                       \
  {                                                                                                \
    sizeof(dea_body_spring), 0, 0, 0, 0, 0, NULL, NULL                                             \
  }
#define DEA_SOLID_OPTIONS_INIT                                                                     \
  {                                                                                                \
    sizeof(dea_solid_options), 0, 0, {0, 0, 0}, {0, 0, 0}, 0, NULL, 0, NULL, NULL, NULL, 0, NULL,  \
        0, 0, NULL, NULL, 0, NULL, 0, NULL                                                         \
  }
#define DEA_RUN_OPTIONS_INIT                                                                       \
  {                                                                                                \
    sizeof(dea_run_options), NULL, 0, NULL, 0, NULL, 0, 0, 0                                       \
  }

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
