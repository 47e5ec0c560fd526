/* The middle surface of a ply with its fields. */
#include "model/solid/recovery/recover_points.h"

#include "base/quadrature.h"

#include <string.h>

// displacement 3, F 9, field, height, membrane force 6, voltage
enum { SUMS = 21, FIELD = 12, HEIGHT = 13, FORCE = 14, VOLTAGE = 20, GROUPS = 4 };

struct work {
  struct dea_context *ctx;
  struct dea_arena memory; // of all arrays
  const struct dea_recover_input *in;
  int ply;
  struct dea_stacked *stack;
  struct dea_recovered *at;
  size_t column_count, point_count;
  int *point;      // of a group's bottom node, [GROUPS][node_count], counted from 1; 0: none
  int *nodes;      // points of a column, [column_count][plane_nodes]
  int *group;      // of a column
  size_t *element; // of a point, one that has it
  int *node;       // of a point: the bottom node of its column
  double (*sum)[SUMS];
  double *weight;
};

static dea_status prepare(struct work *w)
{
  const struct dea_grid *grid = w->in->grid;
  size_t per = (size_t)((grid->order + 1) * (grid->order + 1)), count = grid->element_count;
  struct dea_arena *memory = &w->memory;
  w->stack = dea_recover_stack(memory, w->in);
  w->at = dea_arena_alloc(memory, 1, sizeof *w->at);
  w->point = dea_arena_alloc(memory, GROUPS * grid->node_count, sizeof *w->point);
  w->nodes = dea_arena_alloc(memory, count * per, sizeof *w->nodes);
  w->group = dea_arena_alloc(memory, count, sizeof *w->group);
  w->element = dea_arena_alloc(memory, count * per, sizeof *w->element);
  w->node = dea_arena_alloc(memory, count * per, sizeof *w->node);
  w->sum = dea_arena_alloc(memory, count * per, sizeof *w->sum);
  w->weight = dea_arena_alloc(memory, count * per, sizeof *w->weight);
  return dea_arena_status(memory);
}

/* Numbers the points of a column. Those of its bottom nodes stand for it in its group. */
static int *number_column(struct work *w, size_t element, int group)
{
  const struct dea_grid *grid = w->in->grid;
  int per = (grid->order + 1) * (grid->order + 1);
  int *nodes = w->nodes + w->column_count * (size_t)per;
  for (int n = 0; n < per; n++) {
    int node = grid->nodes[element * DEA_HEX_NODES_MAX + (size_t)n];
    int *point = &w->point[(size_t)group * grid->node_count + (size_t)node];
    if (*point == 0) {
      w->element[w->point_count] = element;
      w->node[w->point_count] = node;
      *point = (int)++w->point_count;
    }
    nodes[n] = *point - 1;
  }
  w->group[w->column_count++] = group;
  return nodes;
}

/* Displacement, F and field at the height z of an element, added to the points of its column. */
static void add_level(struct work *w, size_t element, double z, const int *points)
{
  const struct dea_recover_input *in = w->in;
  const struct dea_recovered *at = w->at;
  int levels = in->grid->levels[element];
  double bottom = dea_recover_height(in, element, 0);
  double top = dea_recover_height(in, element, levels - 1);
  double places[DEA_HEX_ORDER_MAX + 1], slope[DEA_HEX_ORDER_MAX + 1];
  double value[DEA_HEX_ORDER_MAX + 1] = {1}; // of a flat element
  if (levels > 1) {
    dea_lobatto_nodes((size_t)levels - 1, places);
    dea_lagrange((size_t)levels, places, 2 * (z - bottom) / (top - bottom) - 1, value, slope);
  }
  for (int n = 0; n < at->nodes; n++) {
    double *sum = w->sum[points[n % at->plane_nodes]];
    double share = at->volume_m3 * value[n / at->plane_nodes];
    const double *u = in->u + 3 * in->grid->nodes[element * DEA_HEX_NODES_MAX + (size_t)n];
    for (int i = 0; i < 3; i++) {
      sum[i] += share * u[i];
    }
    for (int i = 0; i < 9; i++) {
      sum[3 + i] += share * at->F[n][i];
    }
    sum[FIELD] += share * at->field[n];
    sum[VOLTAGE] += share * in->across_V[element];
  }
}

/* Membrane forces of one element, which is in w->at after it, added to those of its column. */
static dea_status add_force(struct work *w, size_t element, double (*force)[6])
{
  DEA_TRY(w->ctx, dea_recover_element(w->ctx, w->in, element, w->at));
  for (int i = 0; i < 6 * w->at->plane_nodes; i++) {
    force[i / 6][i % 6] += w->at->force[i / 6][i % 6];
  }
  return DEA_OK;
}

static enum dea_part part_of(const struct work *w, size_t k)
{
  return w->in->part_materials[w->in->part_material[w->stack[k].element]].part;
}

/* All elements above each other, in the order of the stack. */
struct column {
  size_t from, end;
};

/* The elements of the ply in one column, from below: the membrane forces of all, and of electrodes
 * of a thickness that are bonded to it, the rest from the one that has the middle. */
static dea_status add_column(struct work *w, const struct column *column, size_t from, size_t end,
                             bool covered)
{
  const struct dea_recover_input *in = w->in;
  size_t last = w->stack[end - 1].element;
  double bottom = dea_recover_height(in, w->stack[from].element, 0);
  double middle = 0.5 * (bottom + dea_recover_height(in, last, in->grid->levels[last] - 1));
  int group = (in->active[w->stack[from].element] ? 1 : 0) + (covered ? 2 : 0);
  int *points = number_column(w, w->stack[from].element, group);
  double force[DEA_ELEMENT_LEVEL_MAX][6] = {{0}}, weight = 0;
  for (size_t k = from; k < end; k++) {
    size_t e = w->stack[k].element;
    DEA_TRY(w->ctx, add_force(w, e, force));
    double z = dea_recover_height(in, e, 0);
    double top = dea_recover_height(in, e, in->grid->levels[e] - 1);
    if (weight == 0 && (k + 1 == end || top > middle - 1e-9 * (top - z))) {
      weight = w->at->volume_m3;
      add_level(w, e, middle, points);
    }
  }
  for (size_t k = column->from; k < column->end; k++) {
    if (part_of(w, k) == DEA_PART_ELECTRODE) {
      DEA_TRY(w->ctx, add_force(w, w->stack[k].element, force));
    }
  }
  for (int n = 0; n < w->at->plane_nodes; n++) {
    w->weight[points[n]] += weight;
    for (int i = 0; i < 6; i++) {
      w->sum[points[n]][FORCE + i] += weight * force[n][i];
    }
    w->sum[points[n]][HEIGHT] += weight * middle;
  }
  return DEA_OK;
}

/* Whether a fibre stands in a column. */
static bool has_fibre(const struct work *w, const struct column *column)
{
  bool any = false;
  for (size_t k = column->from; k < column->end; k++) {
    any = any || part_of(w, k) == DEA_PART_FIBRE;
  }
  return any;
}

static dea_status add_columns(struct work *w)
{
  size_t count = w->in->grid->element_count;
  for (struct column column = {0, 0}; column.from < count; column.from = column.end) {
    column.end = dea_recover_column_end(w->stack, count, column.from, false);
    for (size_t first = column.from; first < column.end;) {
      size_t last = dea_recover_column_end(w->stack, count, first, true);
      if (w->stack[first].ply == w->ply) {
        DEA_TRY(w->ctx, add_column(w, &column, first, last, has_fibre(w, &column)));
      }
      first = last;
    }
  }
  return DEA_OK;
}

/* Where the values of the fields go. */
struct fields {
  double *displacement, *stretch, *tension, *field, *between, *under;
  double *voltage; // NULL: they are even
};

static dea_status add_fields(struct dea_context *ctx, struct dea_field_mesh *mesh, bool uneven,
                             struct fields *out)
{
  const struct dea_recover_field all[] = {
      {dea_recover_displacement, &out->displacement},
      {dea_recover_plane_stretch, &out->stretch},
      {dea_recover_tension, &out->tension},
      {dea_recover_true_field, &out->field},
      {DEA_RECOVER_OF_CELLS("between_electrodes", "1 where the film lies between electrodes"),
       &out->between},
      {DEA_RECOVER_OF_CELLS("under_fibre", "1 where a fibre lies on the film"), &out->under},
      {DEA_RECOVER_VALUES(DEA_VOLTAGE_FIELD, "V",
                          "voltage across the film, of electrodes with a sheet resistance", 1),
       &out->voltage},
  };
  out->voltage = NULL;
  return dea_recover_add(ctx, mesh, all, sizeof all / sizeof all[0] - (uneven ? 0 : 1));
}

static void fill_point(const struct work *w, size_t p, double *X, const struct fields *to)
{
  const struct dea_recover_input *in = w->in;
  size_t e = w->element[p];
  const struct dea_part_material *part_material = &in->part_materials[in->part_material[e]];
  struct dea_plane_state plane;
  double mean[SUMS];
  for (int i = 0; i < SUMS; i++) {
    mean[i] = w->sum[p][i] / w->weight[p];
  }
  memcpy(X, in->grid->X + 3 * w->node[p], 2 * sizeof *X);
  X[2] = mean[HEIGHT];
  memcpy(to->displacement + 3 * p, mean, 3 * sizeof *mean);
  dea_recover_plane(part_material, mean + 3, mean + FORCE, &plane);
  memcpy(to->stretch + 3 * p, plane.stretch, sizeof plane.stretch);
  memcpy(to->tension + 2 * p, plane.tension, sizeof plane.tension);
  to->field[p] = mean[FIELD];
  if (to->voltage != NULL) {
    to->voltage[p] = mean[VOLTAGE];
  }
}

static dea_status fill_mesh(struct work *w, struct dea_field_mesh *mesh)
{
  int order = w->in->grid->order, *nodes;
  struct fields to;
  DEA_TRY(w->ctx, dea_field_mesh_add_block(w->ctx, mesh, order, 0, w->column_count, &nodes));
  DEA_TRY(w->ctx, add_fields(w->ctx, mesh, w->in->uneven, &to));
  memcpy(nodes, w->nodes, w->column_count * (size_t)((order + 1) * (order + 1)) * sizeof *nodes);
  for (size_t c = 0; c < w->column_count; c++) {
    const int half = w->group[c] / 2;
    to.between[c] = w->group[c] % 2;
    to.under[c] = half;
  }
  for (size_t p = 0; p < w->point_count; p++) {
    fill_point(w, p, mesh->X + 3 * p, &to);
  }
  return DEA_OK;
}

dea_status dea_recover_surface(struct dea_context *ctx, const struct dea_recover_input *in, int ply,
                               struct dea_field_mesh **out)
{
  struct work work = {.ctx = ctx, .memory = {.ctx = ctx}, .in = in, .ply = ply};
  *out = NULL;
  dea_status status = prepare(&work);
  status = status == DEA_OK ? add_columns(&work) : status;
  status = status == DEA_OK ? dea_field_mesh_create(ctx, work.point_count, out) : status;
  status = status == DEA_OK ? fill_mesh(&work, *out) : status;
  dea_arena_free(&work.memory);
  return dea_field_mesh_finish(ctx, status, out);
}
