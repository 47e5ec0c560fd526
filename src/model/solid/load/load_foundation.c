/* Elastic foundation: E = 1/2 int k_i u_i^2 dA. */
#include "model/solid/load/loads.h"

#include <string.h>

struct dea_foundation {
  const struct dea_surface *surface;
  struct dea_face_shape shape;
  double *weight; // [face_count][points] areas
  double stiffness[3];
};

dea_status dea_foundation_create(struct dea_context *ctx, const struct dea_surface *surface,
                                 const double stiffness_Pa_per_m[3], struct dea_foundation **out)
{
  *out = NULL;
  for (int i = 0; i < 3; i++) {
    if (!(stiffness_Pa_per_m[i] >= 0)) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "the stiffness of a foundation is 0 or more");
    }
  }
  struct dea_foundation *f = dea_alloc(ctx, 1, sizeof *f);
  if (f == NULL) {
    return DEA_E_MEMORY;
  }
  f->surface = surface;
  memcpy(f->stiffness, stiffness_Pa_per_m, sizeof f->stiffness);
  dea_face_shape_create(surface, DEA_FACE_GAUSS, &f->shape);
  f->weight = dea_surface_weights(ctx, surface, &f->shape);
  if (f->weight == NULL) {
    dea_foundation_destroy(ctx, f);
    return DEA_E_MEMORY;
  }
  *out = f;
  return DEA_OK;
}

void dea_foundation_destroy(struct dea_context *ctx, struct dea_foundation *foundation)
{
  if (foundation != NULL) {
    dea_free(ctx, foundation->weight);
    dea_free(ctx, foundation);
  }
}

static dea_status evaluate(const void *self, size_t piece, const double *u,
                           enum dea_eval_order level, struct dea_load_piece *out)
{
  const struct dea_foundation *f = self;
  const struct dea_face_shape *s = &f->shape;
  int dofs = 3 * s->nodes;
  double at[3 * DEA_FACE_NODES_MAX];
  dea_face_gather(f->surface, piece, u, at);
  out->node_count = s->nodes;
  memcpy(out->nodes, f->surface->nodes + piece * DEA_FACE_NODES_MAX,
         (size_t)s->nodes * sizeof *out->nodes);
  out->energy_J = 0;
  memset(out->g, 0, (size_t)dofs * sizeof *out->g);
  memset(out->K, 0, level >= DEA_TANGENT ? (size_t)(dofs * dofs) * sizeof *out->K : 0);
  for (int q = 0; q < s->points; q++) {
    double w = f->weight[piece * (size_t)s->points + (size_t)q];
    for (int i = 0; i < 3; i++) {
      double k = w * f->stiffness[i], v = 0;
      for (int n = 0; n < s->nodes; n++) {
        v += s->value[q][n] * at[3 * n + i];
      }
      out->energy_J += 0.5 * k * v * v;
      for (int n = 0; n < s->nodes; n++) {
        out->g[3 * n + i] += k * v * s->value[q][n];
        for (int m = 0; m < s->nodes && level >= DEA_TANGENT; m++) {
          out->K[(3 * n + i) * dofs + 3 * m + i] += k * s->value[q][n] * s->value[q][m];
        }
      }
    }
  }
  return DEA_OK;
}

struct dea_solid_load dea_foundation_load(struct dea_foundation *foundation)
{
  return (struct dea_solid_load){
      .self = foundation, .piece_count = foundation->surface->face_count, .evaluate = evaluate};
}
