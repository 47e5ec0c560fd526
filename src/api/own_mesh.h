/* The 3D engine with a mesh of one's own, as the module of solids offers it to api_solid.c. Arrays
 * lie in the order of the mesh's nodes. */
#pragma once

#include "api/api.h"

struct dea_solid_object;

/* Where nodes or the middles of faces are looked for: low_m <= X <= high_m, with a little more. */
struct dea_solid_place {
  const double *low_m, *high_m; // [3], NULL: everywhere
  const char *curve;            // of the .msh file, nodes above and on it only; NULL: all
  const int *nodes;             // [node_count] these only; NULL: all
  size_t node_count;
};

struct dea_own_mesh {
  /* options: with parts and bodies as they are here, which are whole and checked. */
  dea_status (*create)(struct dea_context *ctx, const dea_solid_options *options,
                       const dea_part *parts, const dea_body *bodies,
                       struct dea_solid_object **out);
  void (*destroy)(struct dea_context *ctx, struct dea_solid_object *object);
  /* As the functions of dea.h of these names. displacement_m, shift_m and turn_rad: NULL frees. */
  dea_status (*set)(struct dea_context *ctx, struct dea_solid_object *object, const char *name,
                    double value);
  bool (*setting)(const struct dea_solid_object *object, size_t number, dea_solid_setting *out);
  dea_status (*hold)(struct dea_context *ctx, struct dea_solid_object *object,
                     struct dea_solid_place place, int components, const double *displacement_m);
  dea_status (*hold_body)(struct dea_context *ctx, struct dea_solid_object *object, size_t body,
                          int components, const double *shift_m, const double *turn_rad);
  dea_status (*push_body)(struct dea_context *ctx, struct dea_solid_object *object, size_t body,
                          const double force_N[3], const double moment_N_m[3]);
  dea_status (*add_spring)(struct dea_context *ctx, struct dea_solid_object *object,
                           const dea_body_spring *spring);
  dea_status (*move_spring)(struct dea_context *ctx, struct dea_solid_object *object, size_t spring,
                            double place);
  dea_status (*pull)(struct dea_context *ctx, struct dea_solid_object *object,
                     struct dea_solid_place place, const double traction_Pa[3]);
  dea_status (*set_channel)(struct dea_context *ctx, struct dea_solid_object *object, int channel,
                            double voltage_V);
  dea_status (*solve)(struct dea_context *ctx, struct dea_solid_object *object, double voltage_V);
  dea_status (*find_charges)(struct dea_context *ctx, struct dea_solid_object *object);
  dea_status (*modes)(struct dea_context *ctx, struct dea_solid_object *object, size_t count);
  dea_status (*path)(struct dea_context *ctx, struct dea_solid_object *object, double voltage_V,
                     double step, double unit_m);
  dea_status (*step)(struct dea_context *ctx, struct dea_solid_object *object);
  dea_status (*array)(struct dea_context *ctx, struct dea_solid_object *object, const char *name,
                      dea_array *out);
  /* *out: owned by the caller, NULL on failure. */
  dea_status (*mesh)(struct dea_context *ctx, const struct dea_solid_object *object,
                     struct dea_field_mesh **out);
  dea_status (*number)(struct dea_context *ctx, const struct dea_solid_object *object,
                       const char *name, double *out);
};
