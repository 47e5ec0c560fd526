/* The engine of solids for those who bring a mesh of their own: what its module offers beside the
 * model "3d". Arrays lie in the order of the mesh's nodes. */
#pragma once

#include "base/context.h"
#include "material/law.h"

/* A material of a part; copied. */
struct dea_part_spec {
  const struct dea_law *law; // NULL: compressible, of the next two
  double young_modulus_Pa, poisson_ratio;
  double param[DEA_LAW_PARAM_MAX];
  double bulk_modulus_Pa; // with a law
  double pre_stretch;     // equibiaxial in the plane
  double permittivity_F_per_m;
  double electrode_gap_m; // over which the voltage stands; 0: not between electrodes
  double density_kg_per_m3;
  int channel_above, channel_below; // with a gap; both 0: channel 1 above ground
};

/* A part in a ply, where the plane mesh is in a group (NULL: everywhere). */
struct dea_fill_spec {
  size_t ply;
  const char *group;
  size_t part;
};

/* A mesh: a box of plies from the origin, nodes and elements, or a plane mesh of a .msh file
 * through plies from z = 0 on. All lent. */
struct dea_solid_spec {
  int order, order_z;
  double box_m[3];
  size_t elements[3]; // all 0: by nodes
  size_t point_count;
  const double *points_m; // [point_count][3]
  size_t cell_count;
  const int *cells;   // [cell_count][(order + 1)^2 (order_z + 1)]
  const int *part_of; // [cell_count]; NULL: all of part 0
  const char *msh_file;
  double msh_unit_m; // length of a unit of that file
  size_t ply_count;
  const double *ply_thickness_m; // [ply_count]
  const size_t *ply_elements;    // [ply_count] through it
  size_t fill_count;
  const struct dea_fill_spec *fills; // [fill_count], later ones over earlier ones
  size_t part_count;
  const struct dea_part_spec *parts;
  size_t body_count;
  const struct dea_body_spec *bodies;
};

/* Nodes that move as one. */
struct dea_body_spec {
  const double *low_m, *high_m; // [3], NULL: everywhere
  const char *curve;            // of the .msh file, NULL: all
  const int *nodes;             // [node_count], NULL: all
  size_t node_count;
  double centre_m[3];
};

/* A spring between a body and the outside; copied. */
struct dea_spring_spec {
  size_t body;
  int component;            // 0 to 2: shift, 3 to 5: rotation vector
  double place, stiffness;  // m, N/m; of a turn rad, N m/rad
  size_t count;             // of a table in place of the stiffness, or 0
  const double *at, *force; // [count]
};

struct dea_solid_object;
struct dea_field_mesh;

/* Where nodes or the middles of faces are looked for: low_m <= X <= high_m, with a little more. */
struct dea_solid_place {
  const double *low_m, *high_m; // [3], NULL: everywhere
  const char *curve;            // of the .msh file, nodes above and on it only; NULL: all
  const int *nodes;             // [node_count] these only; NULL: all
  size_t node_count;
};

struct dea_solid_access {
  dea_status (*create)(struct dea_context *ctx, const struct dea_solid_spec *spec,
                       struct dea_solid_object **out);
  void (*destroy)(struct dea_context *ctx, struct dea_solid_object *object);
  /* Changes a tolerance or limit of the solvers by its name. */
  dea_status (*set)(struct dea_context *ctx, struct dea_solid_object *object, const char *name,
                    double value);
  /* The setting of that number: name, unit and meaning, and its value; false beyond the last. */
  bool (*setting)(const struct dea_solid_object *object, size_t number, const char *text[3],
                  double *value);
  /* Holds components (bits 1, 2, 4) of the nodes there; the next solve moves them. displacement_m:
   * NULL frees them. DEA_E_ARGUMENT where there is no node, or no
   * such curve. */
  dea_status (*hold)(struct dea_context *ctx, struct dea_solid_object *object,
                     struct dea_solid_place place, int components, const double *displacement_m);
  /* Holds components (bits 1 to 32) of a body at a shift and a turn, or frees them (NULL, NULL);
   * its dead force and moment. DEA_E_ARGUMENT where there is no such body. */
  dea_status (*hold_body)(struct dea_context *ctx, struct dea_solid_object *object, size_t body,
                          int components, const double *shift_m, const double *turn_rad);
  dea_status (*push_body)(struct dea_context *ctx, struct dea_solid_object *object, size_t body,
                          const double force_N[3], const double moment_N_m[3]);
  /* Adds a spring whose outer end the next solve brings from where the body is to its place; gives
   * one another place. DEA_E_ARGUMENT where there is no such body or spring, or numbers that cannot
   * be. */
  dea_status (*add_spring)(struct dea_context *ctx, struct dea_solid_object *object,
                           const struct dea_spring_spec *spec);
  dea_status (*move_spring)(struct dea_context *ctx, struct dea_solid_object *object, size_t spring,
                            double place);
  /* Adds a dead load per reference area on the faces whose middles are there. */
  dea_status (*pull)(struct dea_context *ctx, struct dea_solid_object *object,
                     struct dea_solid_place place, const double traction_Pa[3]);
  /* Own voltage of a channel for the next solve. DEA_E_ARGUMENT where there is no such channel. */
  dea_status (*set_channel)(struct dea_context *ctx, struct dea_solid_object *object, int channel,
                            double voltage_V);
  dea_status (*solve)(struct dea_context *ctx, struct dea_solid_object *object, double voltage_V);
  /* Makes the arrays of the channels at the last equilibrium. */
  dea_status (*find_charges)(struct dea_context *ctx, struct dea_solid_object *object);
  dea_status (*modes)(struct dea_context *ctx, struct dea_solid_object *object, size_t count);
  /* A path of equilibria to these loads and this voltage, and its next point. */
  dea_status (*path)(struct dea_context *ctx, struct dea_solid_object *object, double voltage_V,
                     double step, double unit_m);
  dea_status (*step)(struct dea_context *ctx, struct dea_solid_object *object);
  /* An array by its name: its unit, its shape (0 beyond its rank); NULL when there is none. */
  const double *(*array)(struct dea_solid_object *object, const char *name, const char **unit,
                         size_t shape[3]);
  /* All fields at the last equilibrium. *out: owned by the caller, NULL on failure. */
  dea_status (*mesh)(struct dea_context *ctx, const struct dea_solid_object *object,
                     struct dea_field_mesh **out);
  /* A number by its name; false when there is none. */
  bool (*number)(const struct dea_solid_object *object, const char *name, double *out);
};

/* PETSc, MPI and MUMPS keep what they do in global variables: a call into the module is made
 * between these two, by one thread at a time, in the order in which the threads came. Calls in a
 * call are fine. The second returns its argument. */
void dea_solid_enter(void);
dea_status dea_solid_leave(dea_status status);
#define DEA_SOLID_IN_TURN(call) (dea_solid_enter(), dea_solid_leave(call))

/* Loads the module. *out: static storage of it. */
dea_status dea_solid_access_open(struct dea_context *ctx, const struct dea_solid_access **out);
