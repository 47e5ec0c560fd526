/* What elements tell of themselves: closed forms of homogeneous states, bending, second
 * derivatives. */
#include "devices.h"
#include "failing_allocator.h"
#include "material/plane.h"
#include "model/solid/recovery/recover.h"
#include "model/solid/recovery/recover_points.h"
#include "model/solid/recovery/recover_second.h"
#include "testing.h"

#include <stdlib.h>

#include "context_fixture.h" // after: its context shadows no name of the headers above

/* ---- a strip: two regions side by side, a film and a fibre on the second ---- */

static const double h_m = 44e-6, fibre_m = 80e-6, length_m = 1e-3, l_pre = 1.5;

/* Region 0 from x = 0 to 1 mm, region 1 from there to 2 mm; skewed a little. */
static void map_strip(const void *self, double s, double t, double x[2])
{
  x[0] = length_m * (s + *(const double *)self + 0.2 * s * (1 - s) * t);
  x[1] = length_m * t;
}

static bool fibre_on_second(const void *self, int region, int ply)
{
  return ply == 0 || region == 1;
}

enum kind { SOLID, COUPLED, FLAT };

struct strip {
  struct dea_arena memory; // of the elements
  enum kind kind;
  struct dea_grid *grid;
  struct dea_element_set elements;
  enum dea_element_kind *kinds; // [elements]
  struct dea_part_material layers[2];
  int *layer;
  bool *active;
  double *u, *multiplier, *across_V, *potential_V;
  struct dea_recover_input in;
};

static struct dea_material film;

static struct strip *strip_create(enum kind kind, int order, int order_z, size_t film_elements)
{
  static const double fibre[] = {8e9 / 3, 1. / 3}; // both Lame constants some GPa
  static const double left = 0, right = 1, cuts[3] = {0, 0.4, 1};
  struct dea_block blocks[2] = {{map_strip, &left, cuts, cuts, 2, 2, 0},
                                {map_strip, &right, cuts, cuts, 2, 2, 1}};
  struct dea_ply plies[2] = {{kind == FLAT ? 0 : h_m, film_elements, order_z},
                             {fibre_m, 1, order_z}};
  struct strip *s = calloc(1, sizeof *s);
  film = test_yeoh();
  s->kind = kind;
  s->memory.ctx = ctx;
  assert_ok(dea_grid_create(ctx, order, blocks, 2, plies, 2, fibre_on_second,
                            kind == FLAT ? 0 : -0.5 * h_m, length_m, &s->grid));
  assert_int_equal(dea_element_set_create(ctx, order, order_z, &s->memory, &s->elements), DEA_OK);
  s->layers[0] = (struct dea_part_material){.pre_stretch = {l_pre, l_pre, 1 / (l_pre * l_pre)},
                                            .kappa_Pa = 4e7,
                                            .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                            .thickness_m = h_m};
  dea_part_material_set_law(&s->layers[0], film.law, film.param);
  s->layers[1] = dea_part_material_bonded(fibre);
  assert_int_equal(dea_part_material_relax(&s->layers[0]), DEA_OK);
  size_t count = s->grid->element_count;
  s->layer = calloc(count, sizeof *s->layer);
  s->active = calloc(count, sizeof *s->active);
  s->kinds = calloc(count, sizeof *s->kinds);
  s->u = calloc(3 * s->grid->node_count, sizeof *s->u);
  s->multiplier = calloc(count * (size_t)s->elements.pressures, sizeof *s->multiplier);
  s->across_V = calloc(count, sizeof *s->across_V);
  s->potential_V = calloc(s->grid->node_count, sizeof *s->potential_V);
  for (size_t e = 0; e < count; e++) {
    s->layer[e] = s->grid->ply[e];
    s->kinds[e] =
        kind == COUPLED && s->layer[e] == 0 ? DEA_ELEMENT_POTENTIAL_HEXAHEDRON : s->grid->kind[e];
    s->active[e] = s->grid->ply[e] == 0 && (s->grid->region[e] == 0 || kind == COUPLED);
  }
  s->in = (struct dea_recover_input){.grid = s->grid,
                                     .elements = &s->elements,
                                     .kind = s->kinds,
                                     .part_materials = s->layers,
                                     .bulk_factor = 1,
                                     .part_material = s->layer,
                                     .active = s->active,
                                     .u = s->u,
                                     .multiplier = s->multiplier,
                                     .across_V = s->across_V,
                                     .potential_V = kind == COUPLED ? s->potential_V : NULL};
  return s;
}

static void strip_destroy(struct strip *s)
{
  dea_grid_destroy(ctx, s->grid);
  free(s->layer);
  free(s->active);
  free(s->kinds);
  dea_arena_free(&s->memory);
  free(s->u);
  free(s->multiplier);
  free(s->across_V);
  free(s->potential_V);
  free(s);
}

/* x = F X. */
static void deform(struct strip *s, const double F[9])
{
  for (size_t n = 0; n < s->grid->node_count; n++) {
    const double *X = s->grid->X + 3 * n;
    for (int i = 0; i < 3; i++) {
      s->u[3 * n + (size_t)i] = F[3 * i] * X[0] + F[3 * i + 1] * X[1] + F[3 * i + 2] * X[2] - X[i];
    }
  }
}

/* The voltage: in a coupled field as potentials that rise through the film. */
static void apply(struct strip *s, double voltage_V)
{
  for (size_t e = 0; e < s->grid->element_count; e++) {
    s->across_V[e] = s->active[e] ? voltage_V : 0;
  }
  for (size_t n = 0; n < s->grid->node_count; n++) {
    double share = s->grid->X[3 * n + 2] / h_m + 0.5;
    s->potential_V[n] = voltage_V * fmin(share, 1);
  }
}

/* Multipliers that take the stress through the thickness out of the film. */
static void relax(struct strip *s, const double F[9])
{
  for (size_t e = 0; e < s->grid->element_count; e++) {
    struct dea_point point;
    double cof[9], J = dea_cofactors(F, cof);
    if (s->layer[e] == 0 && s->kind != FLAT) {
      double field = s->across_V[e] / h_m;
      assert_ok(dea_part_material_point(&s->layers[0], F, cof, J, 0, field, true, &point));
      double push = 0, size = 0; // along the current normal
      for (int i = 0; i < 3; i++) {
        push += point.P[3 * i + 2] * cof[3 * i + 2];
        size += cof[3 * i + 2] * cof[3 * i + 2];
      }
      s->multiplier[e * (size_t)s->elements.pressures] = -push / size;
    }
  }
}

static const double *values(const struct dea_field_mesh *mesh, const char *name)
{
  const struct dea_mesh_field *field = dea_field_mesh_find(mesh, name);
  assert_non_null(field);
  return field->values;
}

static void multiply(const double A[9], const double B[9], double out[9])
{
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
    }
  }
}

/* Film stretched by a and b in its plane at a voltage, in closed form. */
struct flat {
  double stress[2], tension[2], field, energy;
};

static struct flat flat_film(double a, double b, double voltage_V)
{
  struct dea_plane plane;
  struct flat f;
  double thickness = h_m / (a * b), eps = 2.8 * DEA_EPSILON_0;
  assert_int_equal(dea_plane_elastic(&film, l_pre * a, l_pre * b, &plane), DEA_OK);
  f.field = voltage_V / thickness;
  f.stress[0] = l_pre * a * plane.s1 - eps * f.field * f.field; // paper eqs 1, 5
  f.stress[1] = l_pre * b * plane.s2 - eps * f.field * f.field;
  f.tension[0] = f.stress[0] * thickness;
  f.tension[1] = f.stress[1] * thickness;
  f.energy = plane.W;
  return f;
}

static void check_axis(const double *axis, const double *R, int column)
{
  double along = axis[0] * R[column] + axis[1] * R[3 + column] + axis[2] * R[6 + column];
  assert_close(fabs(along), 1, 1e-10, 0);
}

/* All nodes of all cells of a mesh, one after the other. Start with the mesh alone set. */
struct corner {
  const struct dea_field_mesh *mesh;
  size_t block, k, before; // before: cells of the blocks before
  size_t point, cell;
};

static bool next_corner(struct corner *at)
{
  const struct dea_mesh_block *block = &at->mesh->blocks[at->block];
  size_t per = (size_t)dea_mesh_block_nodes(block);
  if (at->k == block->count * per) {
    at->before += block->count;
    at->k = 0;
    if (++at->block == at->mesh->block_count) {
      assert_int_equal(at->before, at->mesh->cell_count);
      return false;
    }
    block++;
    per = (size_t)dea_mesh_block_nodes(block);
  }
  at->cell = at->before + at->k / per;
  at->point = (size_t)block->nodes[at->k++];
  return true;
}

/* P = R diag(stress / stretch) of the film at its Gauss points, and the volume of all of them. */
static void check_state(const struct strip *s, double a, double b, const double R[9])
{
  struct dea_element_state at;
  for (size_t e = 0; e < s->grid->element_count; e++) {
    if (s->layer[e] != 0) {
      continue;
    }
    struct flat wanted = flat_film(a, b, s->active[e] ? 3e3 : 0);
    const double along[3] = {wanted.stress[0] / a, wanted.stress[1] / b, 0};
    double volume_m3 = 0;
    assert_int_equal(dea_recover_state(&s->in, e, true, &at), DEA_OK);
    for (int q = 0; q < s->elements.of[s->kinds[e]].points; q++) {
      for (int i = 0; i < 9; i++) {
        assert_close(at.P[q][i], R[i] * along[i % 3], 0, 1e-9 * along[0]);
      }
      assert_close(at.J[q], 1, 1e-12, 0);
      volume_m3 += at.volume_m3[q];
    }
    struct dea_recovered whole;
    assert_int_equal(dea_recover_element(ctx, &s->in, e, &whole), DEA_OK);
    assert_close(volume_m3, whole.volume_m3, 1e-12, 0);
  }
}

/* A film stretched by 1.1 and 0.95 at 3 kV and then turned: stress, tension, field and energy of
 * the closed form, directions turned too; and at its joint the fibre has its own. */
static void check_turned(enum kind kind, int order, int order_z, size_t film_elements)
{
  const double a = 1.1, b = 0.95, c = cos(0.5), d = sin(0.5), e = cos(0.3), f = sin(0.3);
  const double U[9] = {a, 0, 0, 0, b, 0, 0, 0, 1 / (a * b)};
  const double about_y[9] = {c, 0, d, 0, 1, 0, -d, 0, c}, about_x[9] = {1, 0, 0, 0, e, -f, 0, f, e};
  double R[9], F[9];
  struct strip *s = strip_create(kind, order, order_z, film_elements);
  struct dea_field_mesh *mesh, *surface;
  apply(s, -3e3); // the sign has no say
  multiply(about_x, about_y, R);
  multiply(R, U, F);
  deform(s, F);
  relax(s, F);
  check_state(s, a, b, R);
  assert_int_equal(dea_recover_volume(ctx, &s->in, &mesh), DEA_OK);
  assert_int_equal(dea_recover_surface(ctx, &s->in, 0, &surface), DEA_OK);
  const double *stress = values(mesh, "principal_stress_Pa"),
               *field = values(mesh, "true_field_V_per_m");
  const double *tension = values(mesh, "tension_N_per_m"),
               *energy = values(mesh, "energy_J_per_m3");
  const double *stretch = values(mesh, "principal_stretch"), *plane = values(mesh, "plane_stretch");
  const double *axes[3] = {values(mesh, "stress_axis_1"), values(mesh, "stress_axis_2"),
                           values(mesh, "stress_axis_3")};
  const double *ply = values(mesh, "sheet"), *region = values(mesh, "region");
  // compressible neo-Hookean: sigma_i = mu (l_i^2 - 1) + lambda ln J, with J = 1
  const double fibre[3] = {1e9 * (a * a - 1), 1e9 * (b * b - 1), 1e9 * (1 / (a * a * b * b) - 1)};
  struct corner at = {.mesh = mesh};
  while (next_corner(&at)) {
    size_t p = at.point, cell = at.cell;
    if (ply[cell] == 1) {
      assert_close(stress[3 * p], fibre[0], 1e-9, 0);
      assert_close(stress[3 * p + 1], fibre[2], 1e-9, 0); // the thickness, 0.957, above 0.95
      assert_close(stress[3 * p + 2], fibre[1], 1e-9, 0);
      check_axis(axes[2] + 3 * p, R, 1);
      assert_close(stretch[3 * p], a, 1e-10, 0);
      assert_close(plane[3 * p + 1], b, 1e-10, 0);
      assert_close(tension[2 * p], fibre[0] * fibre_m / (a * b), 1e-9, 0);
      assert_close(field[p], 0, 0, 0);
      continue;
    }
    struct flat wanted = flat_film(a, b, region[cell] == 0 || kind == COUPLED ? 3e3 : 0);
    assert_close(stress[3 * p], wanted.stress[0], 1e-9, 0);
    assert_close(stress[3 * p + 1], wanted.stress[1], 1e-9, 0);
    assert_close(stress[3 * p + 2], 0, 0, 1e-3);
    check_axis(axes[0] + 3 * p, R, 0);
    check_axis(axes[1] + 3 * p, R, 1);
    check_axis(axes[2] + 3 * p, R, 2);
    assert_close(tension[2 * p], wanted.tension[0], 1e-9, 0);
    assert_close(tension[2 * p + 1], wanted.tension[1], 1e-9, 0);
    assert_close(field[p], wanted.field, 1e-10, 0);
    assert_close(energy[p], wanted.energy, 1e-9, 0);
    assert_close(stretch[3 * p], l_pre * a, 1e-10, 0);
    assert_close(stretch[3 * p + 2], 1 / (l_pre * l_pre * a * b), 1e-10, 0);
    assert_close(plane[3 * p], l_pre * a, 1e-10, 0);
    assert_close(plane[3 * p + 1], l_pre * b, 1e-10, 0);
    assert_close(plane[3 * p + 2], 1 / (l_pre * l_pre * a * b), 1e-10, 0);
  }
  const double *moved = values(surface, "displacement_m"),
               *pull = values(surface, "tension_N_per_m");
  const double *under = values(surface, "under_fibre"), *on = values(surface, "between_electrodes");
  at = (struct corner){.mesh = surface};
  while (next_corner(&at)) {
    size_t p = at.point, cell = at.cell;
    const double *X = surface->X + 3 * p;
    assert_close(X[2], 0, 0, 1e-12);
    for (int i = 0; i < 3; i++) {
      double x = F[3 * i] * X[0] + F[3 * i + 1] * X[1];
      assert_close(X[i] + moved[3 * p + (size_t)i], x, 0, 1e-12);
    }
    struct flat wanted = flat_film(a, b, on[cell] != 0 ? 3e3 : 0);
    // region 0 has electrodes, region 1 a fibre, and a potential knows no regions
    assert_true(X[0] > length_m - 1e-9 || (on[cell] == 1 && under[cell] == 0));
    assert_true(X[0] < length_m + 1e-9 || (on[cell] == (kind == COUPLED) && under[cell] == 1));
    assert_close(pull[2 * p], wanted.tension[0], 1e-9, 0);
    assert_close(pull[2 * p + 1], wanted.tension[1], 1e-9, 0);
  }
  dea_field_mesh_destroy(ctx, mesh);
  dea_field_mesh_destroy(ctx, surface);
  strip_destroy(s);
}

/* The elastic energy is that of the stretches, whatever the permittivity does. */
TEST(test_flat_energy_with_electrostriction)
{
  const double a = 1.1, b = 0.95, F[9] = {a, 0, 0, 0, b, 0, 0, 0, 1};
  struct strip *s = strip_create(FLAT, 2, 1, 1);
  struct dea_field_mesh *mesh;
  s->layers[0].permittivity_slope_F_per_m = -0.28 * DEA_EPSILON_0 * l_pre;
  apply(s, 3e3);
  deform(s, F);
  assert_int_equal(dea_recover_volume(ctx, &s->in, &mesh), DEA_OK);
  const double *energy = values(mesh, "energy_J_per_m3"), *ply = values(mesh, "sheet");
  struct corner at = {.mesh = mesh};
  while (next_corner(&at)) {
    assert_true(ply[at.cell] == 1 || fabs(energy[at.point] / flat_film(a, b, 0).energy - 1) < 1e-9);
  }
  dea_field_mesh_destroy(ctx, mesh);
  strip_destroy(s);
}

TEST(test_turned_film)
{
  for (int order = 1; order <= 3; order++) {
    for (int order_z = 1; order_z <= 3; order_z++) {
      check_turned(SOLID, order, order_z, 1);
      check_turned(COUPLED, order, order_z, 1);
      check_turned(FLAT, order, order_z, 1);
    }
  }
  check_turned(SOLID, 2, 2, 2);
  check_turned(SOLID, 2, 1, 3);
  check_turned(COUPLED, 2, 2, 2);
}

/* Bending, u_x = k x z: the stretch along x is 1 + k z, also at the faces. */
TEST(test_bending)
{
  const double k = 2000;
  for (int order_z = 1; order_z <= 3; order_z++) {
    struct strip *s = strip_create(SOLID, 2, order_z, 1);
    struct dea_field_mesh *mesh;
    for (size_t n = 0; n < s->grid->node_count; n++) {
      s->u[3 * n] = k * s->grid->X[3 * n] * s->grid->X[3 * n + 2];
    }
    assert_int_equal(dea_recover_volume(ctx, &s->in, &mesh), DEA_OK);
    const double *plane = values(mesh, "plane_stretch"), *ply = values(mesh, "sheet");
    const double *error = values(mesh, "volume_error");
    size_t per = (size_t)s->elements.of[DEA_ELEMENT_HEXAHEDRON].nodes;
    for (size_t i = 0; i < mesh->cell_count * per; i++) {
      size_t p = (size_t)mesh->blocks[0].nodes[i];
      double stretch = 1 + k * mesh->X[3 * p + 2], pre = ply[i / per] == 0 ? l_pre : 1;
      assert_close(plane[3 * p], pre * fmax(stretch, 1), 1e-9, 0);
      assert_close(plane[3 * p + 1], pre * fmin(stretch, 1), 1e-9, 0);
      assert_true(error[i / per] > 0.5 * k * h_m / 2 && error[i / per] < k * (h_m + fibre_m));
    }
    dea_field_mesh_destroy(ctx, mesh);
    strip_destroy(s);
  }
}

static struct strip *memory_strip;

static void recover_both(struct dea_context *failing)
{
  struct dea_field_mesh *mesh;
  dea_status status = dea_recover_volume(failing, &memory_strip->in, &mesh);
  failing_check(failing, status);
  dea_field_mesh_destroy(failing, mesh);
  status = dea_recover_surface(failing, &memory_strip->in, 0, &mesh);
  failing_check(failing, status);
  dea_field_mesh_destroy(failing, mesh);
}

TEST(test_each_allocation)
{
  memory_strip = strip_create(SOLID, 2, 1, 1);
  assert_true(failing_each(recover_both) > 20);
  strip_destroy(memory_strip);
}

/* ---- second derivatives from neighbours ---- */

static void map_square(const void *self, double s, double t, double x[2])
{
  x[0] = length_m * s;
  x[1] = length_m * t;
}

static bool everywhere(const void *self, int region, int ply)
{
  return region == 0 && ply == 0;
}

enum { NUMBERS = 10 }; // a tensor and a scalar

/* Component xx and the scalar: (x^2 + 2 y^2) / length^2 times one more than the level, of each
 * element the linear function nearest to it; xy: x / length. */
static void fill_linear(const struct dea_grid *grid, double *value)
{
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    const double *low = grid->X + 3 * nodes[0], *high = grid->X + 3 * nodes[8];
    for (int n = 0; n < 27; n++) {
      double *v = value + (e * 27 + (size_t)n) * NUMBERS, level = 1 + n / 9;
      for (int i = 0; i < 2; i++) {
        double x = grid->X[3 * nodes[n] + i] / length_m;
        double middle = 0.5 * (low[i] + high[i]) / length_m,
               a = 0.5 * (high[i] - low[i]) / length_m;
        v[0] += level * (i + 1) * (middle * middle + a * a / 3 + 2 * middle * (x - middle));
      }
      v[1] = grid->X[3 * nodes[n]] / length_m;
      v[9] = v[0];
    }
  }
}

/* Of elements of unequal lengths with one neighbour, or two, and of one alone beside a mirror
 * plane, in which xx and the scalar are even and xy odd. x^2 of half a length a has c = 2 a^2 / 3.
 */
TEST(test_second_derivatives)
{
  static const double cuts[4] = {0, 0.3, 0.8, 1}, alone[2] = {0, 1};
  static const struct dea_ply ply = {44e-6, 1, 2};
  for (int mirrors = 0; mirrors < 2; mirrors++) {
    struct dea_block block = {map_square, NULL, mirrors ? alone : cuts, cuts, mirrors ? 1 : 3,
                              3,          0};
    struct dea_grid *grid;
    assert_ok(dea_grid_create(ctx, 2, &block, 1, &ply, 1, everywhere, 0, length_m, &grid));
    size_t count = grid->element_count, axes = 2 * (size_t)DEA_RECOVER_LEVELS * NUMBERS;
    double *value = calloc(count * 27 * NUMBERS, sizeof *value),
           *c = calloc(count * axes, sizeof *c);
    double(*mirror)[3] = calloc(grid->node_count, sizeof *mirror);
    int *group = calloc(count, sizeof *group);
    fill_linear(grid, value);
    for (size_t n = 0; n < grid->node_count; n++) {
      mirror[n][0] = grid->X[3 * n] == 0 ? 1 : 0;
    }
    const struct dea_recover_second in = {.grid = grid,
                                          .group = group,
                                          .mirror = mirrors ? (const double(*)[3])mirror : NULL,
                                          .tensors = 1,
                                          .scalars = 1,
                                          .nodes = 27,
                                          .value = value};
    assert_int_equal(dea_recover_second(ctx, &in, c), DEA_OK);
    for (size_t k = 0; k < count * axes; k++) {
      size_t e = k / axes, axis = k % axes / (axes / 2), level = k % (axes / 2) / NUMBERS;
      const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
      double a = 0.5 *
                 (grid->X[3 * (size_t)nodes[8] + axis] - grid->X[3 * (size_t)nodes[0] + axis]) /
                 length_m;
      bool xx = (k % NUMBERS == 0 || k % NUMBERS == 9) && level < 3;
      assert_close(c[k], xx ? (double)((level + 1) * (axis + 1)) * 2 * a * a / 3 : 0, 0, 1e-12);
    }
    free(value);
    free(c);
    free(mirror);
    free(group);
    dea_grid_destroy(ctx, grid);
  }
}

TESTS(context_set_up, context_tear_down)
