/* Local axes of nodes on mirror planes that are not x = 0 or y = 0 (docs/theory/mesh.md).
 *
 * Displacements and forces are kept in global components everywhere; K and the held
 * components of such a node are in local ones, v_local = Q v. */
#include "model/solid/assembly/internal.h"

#include <string.h>

dea_status dea_solid_frames_create(struct dea_context *ctx, struct dea_solid *s,
                                   const struct dea_solid_options *options)
{
  size_t nodes = s->grid->node_count, count = 0;
  double Q[9];
  for (size_t n = 0; options->frame != NULL && n < nodes; n++) {
    count += options->frame(options->self, s->grid->X + 3 * n, Q);
  }
  if (count == 0) {
    return DEA_OK;
  }
  s->frame = dea_alloc(ctx, nodes, sizeof *s->frame);
  s->frames = dea_alloc(ctx, count, sizeof *s->frames);
  if (s->frame == NULL || s->frames == NULL) {
    return DEA_E_MEMORY;
  }
  count = 0;
  for (size_t n = 0; n < nodes; n++) {
    if (options->frame(options->self, s->grid->X + 3 * n, Q)) {
      memcpy(s->frames[count], Q, sizeof Q);
      s->frame[n] = (int)++count;
    }
  }
  return DEA_OK;
}

/* Local axes of a node, NULL: the global ones. */
static const double *frame_of(const struct dea_solid *s, size_t node)
{
  return s->frame == NULL || s->frame[node] == 0 ? NULL : s->frames[s->frame[node] - 1];
}

/* v = Q v or, back, v = Q^T v; the components of v lie `apart` from each other. */
static void turn(const double Q[9], bool back, double *v, size_t apart)
{
  double old[3] = {v[0], v[apart], v[2 * apart]};
  for (size_t i = 0; i < 3; i++) {
    v[apart * i] = back ? Q[i] * old[0] + Q[3 + i] * old[1] + Q[6 + i] * old[2]
                        : Q[3 * i] * old[0] + Q[3 * i + 1] * old[1] + Q[3 * i + 2] * old[2];
  }
}

void dea_solid_frame_matrix(const struct dea_solid *s, int node_count, const int *nodes, double *K)
{
  size_t per = (size_t)s->per_node, dofs = per * (size_t)node_count;
  for (size_t n = 0; n < (size_t)node_count; n++) {
    const double *Q = frame_of(s, (size_t)nodes[n]);
    if (Q != NULL) {
      for (size_t j = 0; j < dofs; j++) {
        turn(Q, false, K + per * n * dofs + j, dofs);
      }
      for (size_t i = 0; i < dofs; i++) {
        turn(Q, false, K + i * dofs + per * n, 1);
      }
    }
  }
}

void dea_solid_frame_vector(const struct dea_solid *s, bool back, double *v)
{
  for (size_t n = 0; s->frame != NULL && n < s->grid->node_count; n++) {
    const double *Q = frame_of(s, n);
    if (Q != NULL) {
      turn(Q, back, v + 3 * n, 1);
    }
  }
}

void dea_solid_release_held(const struct dea_solid *s, double *v)
{
  dea_solid_frame_vector(s, false, v);
  for (size_t i = 0; i < s->dofs; i++) {
    v[i] = s->held[i] ? 0 : v[i];
  }
  dea_solid_frame_vector(s, true, v);
}
