/* The engine by <dea.h> alone, against closed forms. */
// ctest: solid
#include <dea.h>

#include "testing.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static dea_context *ctx;
static const double nothing[3] = {0, 0, 0};

static void good(dea_status status)
{
  if (status != DEA_OK) {
    fail_msg("%s: %s", dea_error_name(status), dea_error_message(ctx));
  }
}

static const dea_array *array(dea_solid *solid, const char *name)
{
  const dea_array *found;
  good(dea_solid_array(ctx, solid, name, &found));
  return found;
}

static double number(const dea_solid *solid, const char *name)
{
  double value;
  good(dea_solid_number(ctx, solid, name, &value));
  return value;
}

static dea_solid *box(const dea_part *part, const double size_m[3], size_t nx, size_t ny, size_t nz)
{
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  dea_solid *solid;
  memcpy(options.box_m, size_m, sizeof options.box_m);
  options.elements[0] = nx;
  options.elements[1] = ny;
  options.elements[2] = nz;
  options.parts = &part;
  options.part_count = 1;
  good(dea_solid_new(ctx, &options, &solid));
  return solid;
}

/* Leans on the planes x = 0, y = 0 and z = 0. */
static void lean(dea_solid *solid, const double size_m[3])
{
  for (int i = 0; i < 3; i++) {
    double high[3] = {size_m[0], size_m[1], size_m[2]};
    high[i] = 0;
    good(dea_solid_hold(ctx, solid, nothing, high, 1 << i, nothing));
  }
}

static dea_part rubber(const double *mu)
{
  dea_part part = DEA_PART_INIT;
  part.law = "neo-hookean";
  part.parameters = mu;
  part.parameter_count = 1;
  return part;
}

static const dea_array *field(const dea_mesh *mesh, const char *name)
{
  for (size_t i = 0; i < mesh->field_count; i++) {
    if (strcmp(mesh->fields[i]->array->name, name) == 0) {
      return mesh->fields[i]->array;
    }
  }
  fail_msg("there is no field %s", name);
  return NULL;
}

/* Pulled by a dead load: the stretch where mu (l - 1/l^2) is the traction. */
TEST(test_pull)
{
  const double mu = 0.4e6, size[3] = {0.01, 0.01, 0.04}, stretch = 1.5;
  const double end[3] = {0, 0, size[2]};
  const double traction[3] = {0, 0, mu * (stretch - 1 / (stretch * stretch))};
  dea_part part = rubber(&mu);
  dea_solid *solid = box(&part, size, 1, 1, 2);
  lean(solid, size);
  good(dea_solid_pull(ctx, solid, end, size, traction));
  good(dea_solid_solve(ctx, solid, 0));
  const dea_array *X = array(solid, "points_m"), *u;
  size_t top = 3 * X->shape[0];
  for (size_t i = 0; i < X->shape[0]; i++) {
    top = X->data[3 * i + 2] > size[2] * (1 - 1e-9) ? 3 * i : top;
  }
  u = array(solid, "displacement_m");
  assert_close(u->data[top + 2], (stretch - 1) * size[2], 1e-6, 0);
  assert_int_equal((int)number(solid, "unstable_modes"), 0);
  // energy: W = mu/2 (l^2 + 2/l - 3) less the work of the load
  double W = 0.5 * mu * (stretch * stretch + 2 / stretch - 3);
  double V = size[0] * size[1] * size[2];
  assert_close(number(solid, "energy_J"), V * (W - traction[2] * (stretch - 1)), 1e-5, 0);
  const dea_mesh *mesh;
  good(dea_solid_mesh(ctx, solid, &mesh)); // once more takes the place of the last one
  good(dea_solid_mesh(ctx, solid, &mesh));
  assert_int_equal(mesh->point_count, X->shape[0]);
  assert_int_equal(mesh->cells[0]->count, 2);
  for (size_t i = 0; i < mesh->point_count; i++) {
    const double *stress = field(mesh, "principal_stress_Pa")->data + 3 * i;
    assert_close(stress[0], traction[2] * stretch, 1e-5, 0);
    assert_close(stress[1], 0, 0, 1e-5 * mu);
    assert_close(field(mesh, "principal_stretch")->data[3 * i], stretch, 1e-6, 0);
    assert_close(field(mesh, "energy_J_per_m3")->data[i], W, 1e-5, 0);
  }
  dea_solid_free(solid);
}

/* A film between electrodes, free in its plane: mu (l^2 - l^-4) = eps E^2 with E = V l^2/h. */
TEST(test_voltage)
{
  const double mu = 0.4e6, h = 1e-4, size[3] = {1e-3, 1e-3, h}, eps = 3 * 8.8541878128e-12;
  const double stretch = 1.1, l2 = stretch * stretch;
  const double voltage = h / l2 * sqrt(mu * (l2 - 1 / (l2 * l2)) / eps);
  dea_part part = rubber(&mu);
  part.permittivity = 3;
  part.electrode_gap_m = h;
  dea_solid *solid = box(&part, size, 1, 1, 1);
  lean(solid, size);
  good(dea_solid_solve(ctx, solid, voltage));
  const dea_array *u = array(solid, "displacement_m");
  double most = 0;
  for (size_t i = 0; i < u->shape[0]; i++) {
    most = fmax(most, u->data[3 * i]);
  }
  assert_close(most, (stretch - 1) * size[0], 1e-5, 0);
  assert_close(number(solid, "voltage_V"), voltage, 1e-12, 0);

  // its path: the voltage is highest where l^6 = 4
  good(dea_solid_solve(ctx, solid, 0));
  good(dea_solid_path_begin(ctx, solid, 2 * voltage, 0.05, size[0]));
  double highest = 0, last = 0;
  for (int i = 0; i < 200 && last >= highest; i++) {
    good(dea_solid_path_step(ctx, solid));
    last = number(solid, "voltage_V");
    highest = fmax(highest, last);
  }
  double exact = h * sqrt(mu / eps * (pow(4, -1.0 / 3) - pow(4, -4.0 / 3)));
  assert_close(highest, exact, 5e-3, 0);
  assert_true(number(solid, "unstable_modes") >= 1);
  dea_solid_free(solid);
}

/* A clamped bar: the lowest bending frequency of a slender beam, twice, by points and cells. */
TEST(test_modes)
{
  enum { ELEMENTS = 10, ALONG = 2 * ELEMENTS + 1, POINTS = 9 * ALONG };
  const double size[3] = {0.1, 2e-3, 2e-3}, E = 3e9, density = 1000;
  double points[3 * POINTS];
  int cells[ELEMENTS * 27], part_of[ELEMENTS];
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 3; j++) {
      for (int i = 0; i < ALONG; i++) {
        double *X = points + 3 * ((k * 3 + j) * ALONG + i);
        X[0] = size[0] * i / (ALONG - 1);
        X[1] = size[1] * j / 2;
        X[2] = size[2] * k / 2;
      }
    }
  }
  for (int e = 0; e < ELEMENTS; e++) {
    part_of[e] = 1;
    for (int n = 0; n < 27; n++) {
      cells[27 * e + n] = (n / 9 * 3 + n / 3 % 3) * ALONG + 2 * e + n % 3;
    }
  }
  dea_part soft = DEA_PART_INIT, stiff = DEA_PART_INIT;
  soft.young_modulus_Pa = 1e6;
  stiff.young_modulus_Pa = E;
  soft.density_kg_per_m3 = stiff.density_kg_per_m3 = density;
  const dea_part *const parts[] = {&soft, &stiff};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  options.point_count = POINTS;
  options.points_m = points;
  options.cell_count = ELEMENTS;
  options.cells = cells;
  options.part_of = part_of;
  options.parts = parts;
  options.part_count = 2;
  dea_solid *solid;
  good(dea_solid_new(ctx, &options, &solid));
  int ends[9] = {0, ALONG, 2 * ALONG};
  for (int n = 3; n < 9; n++) {
    ends[n] = ends[n % 3] + n / 3 * 3 * ALONG;
  }
  good(dea_solid_hold_nodes(ctx, solid, ends, 9, 7, nothing));
  good(dea_solid_solve(ctx, solid, 0));
  good(dea_solid_modes(ctx, solid, 3));
  const double exact = 1.8751 * 1.8751 / (2 * acos(-1) * size[0] * size[0]) *
                       sqrt(E * size[1] * size[1] / (12 * density));
  const dea_array *f = array(solid, "mode_Hz");
  assert_int_equal(f->shape[0], 3);
  assert_close(f->data[0], exact, 0.01, 0);
  assert_close(f->data[1], exact, 0.01, 0);
  assert_close(f->data[2] / f->data[0], 6.267, 0.02, 0);
  f = array(solid, "mode_shape");
  assert_int_equal(f->rank, 3);
  assert_int_equal(f->shape[1], POINTS);

  cells[5] = ends[1] = POINTS; // a node that is not there
  assert_int_equal(dea_solid_hold_nodes(ctx, solid, ends, 9, 7, nothing), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "there is no node 189: 189 of them"));
  dea_solid *bad;
  assert_int_equal(dea_solid_new(ctx, &options, &bad), DEA_E_ARGUMENT);
  assert_null(bad);
  dea_solid_free(solid);
}

/* Two films on each other with an electrode between them and at both faces, held where they are:
 * plate capacitors, eps A / h each, and a force between the plates. */
TEST(test_channels)
{
  enum { LEVELS = 5, POINTS = 9 * LEVELS };
  const double mu[1] = {0.1e6}, side = 1e-3, h = 50e-6, V = 1500;
  double points[POINTS * 3];
  int cells[2 * 27], part_of[2] = {0, 1};
  for (int n = 0; n < POINTS; n++) {
    points[3 * n] = 0.5 * side * (n % 3);
    points[3 * n + 1] = 0.5 * side * (n / 3 % 3);
    points[3 * n + 2] = 0.5 * h * (n / 9);
  }
  for (int e = 0; e < 2; e++) {
    for (int n = 0; n < 27; n++) {
      cells[27 * e + n] = 18 * e + n;
    }
  }
  dea_part lower = rubber(mu), upper = rubber(mu);
  lower.permittivity = upper.permittivity = 3;
  lower.electrode_gap_m = upper.electrode_gap_m = h;
  lower.channel_above = upper.channel_below = 1; // the electrode between them
  upper.channel_above = 2;
  const dea_part *const parts[] = {&lower, &upper};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  options.point_count = POINTS;
  options.points_m = points;
  options.cell_count = 2;
  options.cells = cells;
  options.part_of = part_of;
  options.parts = parts;
  options.part_count = 2;
  dea_solid *solid;
  const dea_array *none;
  good(dea_solid_new(ctx, &options, &solid));
  const double all[3] = {side, side, 2 * h};
  good(dea_solid_hold(ctx, solid, nothing, all, 7, nothing));
  assert_int_equal(dea_solid_set_channel(ctx, solid, 3, V), DEA_E_ARGUMENT);
  assert_int_equal(dea_solid_array(ctx, solid, "charge_C", &none), DEA_E_ARGUMENT); // not asked for
  good(dea_solid_set_channel(ctx, solid, 1, V));
  good(dea_solid_set_channel(ctx, solid, 2, -V));
  good(dea_solid_solve(ctx, solid, 0));
  good(dea_solid_find_charges(ctx, solid));
  const double C = 3 * 8.8541878128e-12 * side * side / h;
  const double wanted[3] = {-C * V, 3 * C * V, -2 * C * V}; // 2 V across the upper film
  const double matrix[9] = {C, -C, 0, -C, 2 * C, -C, 0, -C, C};
  for (int k = 0; k < 3; k++) {
    assert_close(array(solid, "charge_C")->data[k], wanted[k], 1e-9, 0);
    assert_close(array(solid, "channel_V")->data[k], k == 0 ? 0 : k == 1 ? V : -V, 0, 1e-9);
  }
  for (int i = 0; i < 9; i++) {
    assert_close(array(solid, "capacitance_held_F")->data[i], matrix[i], 0, 1e-9 * C);
    assert_close(array(solid, "capacitance_F")->data[i], matrix[i], 0, 1e-9 * C); // nothing moves
  }
  good(dea_solid_solve(ctx, solid, 0));
  assert_int_equal(dea_solid_array(ctx, solid, "charge_C", &none), DEA_E_ARGUMENT); // of before
  dea_solid_free(solid);
  lower.channel_below = -1;
  assert_int_equal(dea_solid_new(ctx, &options, &solid), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "part 0 has the channel -1"));
}

/* Two squares of a .msh file, side by side, of the same material as two parts in two plies: pulled
 * along x they are one bar. */
TEST(test_msh)
{
  const double mu = 0.4e6, stretch = 1.3, thickness[2] = {1e-4, 2e-4};
  const dea_part soft = rubber(&mu), same = rubber(&mu);
  const dea_part *parts[] = {&soft, &same};
  const size_t through[2] = {2, 1};
  const dea_fill fills[] = {{0, NULL, 0}, {1, "film", 0}, {1, "electrode", 1}};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  dea_solid *bar;
  options.parts = parts;
  options.part_count = 2;
  options.msh_file = DEA_SOURCE_DIR "/tests/fuzz/seeds/msh/two-squares-41.msh";
  options.ply_count = 2;
  options.ply_thickness_m = thickness;
  options.ply_elements = through;
  options.fills = fills;
  options.fill_count = 3;
  good(dea_solid_new(ctx, &options, &bar));
  const double size[3] = {2e-3, 1e-3, 3e-4}, low[3] = {2e-3, 0, 0};
  const double move[3] = {(stretch - 1) * size[0], 0, 0};
  lean(bar, size);
  good(dea_solid_hold_curve(ctx, bar, "left", NULL, NULL, 1, nothing));
  good(dea_solid_hold(ctx, bar, low, size, 1, move));
  good(dea_solid_solve(ctx, bar, 0));
  const double *reaction = array(bar, "reaction_N")->data;
  const dea_array *points = array(bar, "points_m");
  assert_int_equal(points->shape[0], 15 * 7);
  double force = 0;
  for (size_t i = 0; i < points->shape[0]; i++) {
    force += points->data[3 * i] > 1.9e-3 ? reaction[3 * i] : 0;
  }
  assert_close(force, mu * size[1] * size[2] * (stretch - 1 / (stretch * stretch)), 1e-6, 0);
  assert_int_equal(dea_solid_hold_curve(ctx, bar, "right", NULL, NULL, 1, nothing), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "no physical curve 'right'"));
  dea_solid_free(bar);
  dea_fill wrong = {1, "elektrode", 1};
  options.fills = &wrong;
  options.fill_count = 1;
  assert_int_equal(dea_solid_new(ctx, &options, &bar), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "no physical surface 'elektrode'"));
  wrong = (dea_fill){2, "film", 0};
  assert_int_equal(dea_solid_new(ctx, &options, &bar), DEA_E_ARGUMENT);
  options.msh_file = DEA_SOURCE_DIR "/README.md";
  assert_int_equal(dea_solid_new(ctx, &options, &bar), DEA_E_DESIGN);
  assert_non_null(strstr(dea_error_message(ctx), "README.md:1: this is no .msh file"));
  options.ply_count = 0;
  assert_int_equal(dea_solid_new(ctx, &options, &bar), DEA_E_ARGUMENT);
  assert_null(bar);
}

/* A block whose top is a rigid plate: moved like nodes that are held, brought there by the force
 * that this takes, and turned by it when it may turn. */
TEST(test_body)
{
  const double mu = 0.4e6, size[3] = {0.01, 0.01, 0.02}, move[3] = {2e-3, 0, 1e-3};
  const double low[3] = {0, 0, size[2]}, bottom[3] = {size[0], size[1], 0};
  dea_part part = rubber(&mu);
  const dea_part *parts[] = {&part};
  dea_body plate = DEA_BODY_INIT;
  memcpy(plate.low_m, low, sizeof low);
  memcpy(plate.high_m, size, sizeof size);
  plate.centre_m[0] = plate.centre_m[1] = 0.005;
  plate.centre_m[2] = size[2];
  const dea_body *bodies[] = {&plate};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  memcpy(options.box_m, size, sizeof size);
  options.elements[0] = options.elements[1] = options.elements[2] = 2;
  options.parts = parts;
  options.part_count = 1;
  dea_solid *held, *moved;
  good(dea_solid_new(ctx, &options, &held));
  options.bodies = bodies;
  options.body_count = 1;
  good(dea_solid_new(ctx, &options, &moved));
  good(dea_solid_hold(ctx, held, nothing, bottom, 7, nothing));
  good(dea_solid_hold(ctx, held, low, size, 7, move));
  good(dea_solid_hold(ctx, moved, nothing, bottom, 7, nothing));
  good(dea_solid_hold_body(ctx, moved, 0, 63, move, NULL));
  good(dea_solid_solve(ctx, held, 0));
  good(dea_solid_solve(ctx, moved, 0));
  assert_close(number(moved, "energy_J"), number(held, "energy_J"), 1e-9, 0);
  double force[3] = {0, 0, 0};
  const dea_array *points = array(held, "points_m");
  size_t count = points->shape[0];
  for (size_t n = 0; n < count; n++) {
    bool top = array(held, "points_m")->data[3 * n + 2] > 0.99 * size[2];
    for (size_t i = 0; i < 3 && top; i++) {
      force[i] += array(held, "reaction_N")->data[3 * n + i];
    }
  }
  assert_int_equal(array(moved, "points_m")->shape[0], count + 2);
  for (int i = 0; i < 3; i++) {
    assert_close(array(moved, "body_force_N")->data[i], force[i], 0, 1e-8 * force[0]);
    assert_close(array(moved, "body_shift_m")->data[i], move[i], 0, 1e-12);
  }
  assert_true(fabs(array(moved, "body_moment_N_m")->data[1]) > 1e-3 * force[0] * size[2]);
  good(dea_solid_hold_body(ctx, moved, 0, 7, NULL, NULL)); // free to shift, pushed
  good(dea_solid_push_body(ctx, moved, 0, force, nothing));
  good(dea_solid_solve(ctx, moved, 0));
  for (int i = 0; i < 3; i++) {
    assert_close(array(moved, "body_shift_m")->data[i], move[i], 0, 1e-8 * size[2]);
    assert_close(array(moved, "body_turn_rad")->data[i], 0, 0, 0);
  }
  good(dea_solid_hold_body(ctx, moved, 0, 63, NULL, NULL)); // and to turn
  good(dea_solid_solve(ctx, moved, 0));
  assert_true(array(moved, "body_turn_rad")->data[1] > 0.05); // a beam that is pushed sideways
  assert_close(array(moved, "body_moment_N_m")->data[1], 0, 0, 1e-9 * force[0] * size[2]);
  assert_int_equal(dea_solid_hold_body(ctx, moved, 1, 1, move, NULL), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "no body 1: 1 of them"));
  assert_int_equal(dea_solid_push_body(ctx, held, 0, force, nothing), DEA_E_ARGUMENT);
  dea_solid_free(held);
  dea_solid_free(moved);
  plate.low_m[2] = plate.high_m[2] = 1; // nothing is there
  dea_solid *none;
  assert_int_equal(dea_solid_new(ctx, &options, &none), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "no node for body 0"));
  plate.nodes = (const int[]){-1};
  plate.node_count = 1;
  assert_int_equal(dea_solid_new(ctx, &options, &none), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "there is no node -1"));
}

/* A block with a rigid plate on top, where a spring holds it: at a shift, or a turn, that takes the
 * force with which the block is held there without one. */
static void check_spring(const dea_body_spring *given, double there, const char *force)
{
  const double mu = 0.4e6, size[3] = {0.01, 0.01, 0.02}, bottom[3] = {0.01, 0.01, 0};
  dea_part part = rubber(&mu);
  const dea_part *parts[] = {&part};
  dea_body plate = DEA_BODY_INIT;
  plate.low_m[2] = size[2];
  memcpy(plate.high_m, size, sizeof size);
  plate.centre_m[0] = plate.centre_m[1] = 0.005;
  plate.centre_m[2] = size[2];
  const dea_body *bodies[] = {&plate};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  memcpy(options.box_m, size, sizeof size);
  options.elements[0] = options.elements[1] = options.elements[2] = 2;
  options.parts = parts;
  options.part_count = 1;
  options.bodies = bodies;
  options.body_count = 1;
  dea_solid *solid;
  dea_body_spring spring = *given;
  bool turn = spring.component >= 8;
  int i = turn ? 1 : 2;
  double move[3] = {0}, table[3];
  move[i] = there;
  good(dea_solid_new(ctx, &options, &solid));
  good(dea_solid_hold(ctx, solid, nothing, bottom, 7, nothing));
  good(dea_solid_hold_body(ctx, solid, 0, 63, turn ? NULL : move, turn ? move : NULL));
  good(dea_solid_solve(ctx, solid, 0));
  double F = array(solid, turn ? "body_moment_N_m" : "body_force_N")->data[i];
  assert_true(F * there > 0);
  for (size_t k = 0; k < spring.count; k++) { // in shares of F, which is at y = there - place
    table[k] = -given->force[k] * F;
  }
  spring.force = table;
  spring.place = spring.count > 0 ? 0 : there + F / spring.stiffness;
  good(dea_solid_hold_body(ctx, solid, 0, spring.component, NULL, NULL));
  good(dea_solid_add_spring(ctx, solid, &spring));
  good(dea_solid_solve(ctx, solid, 0));
  const char *where = turn ? "body_turn_rad" : "body_shift_m";
  assert_close(array(solid, where)->data[i], there, 1e-7, 0);
  assert_close(array(solid, force)->data[0], -F, 1e-6, 0);
  assert_true(isnan(array(solid, turn ? "spring_force_N" : "spring_moment_N_m")->data[0]));
  if (spring.count == 0) { // at its free length it does nothing
    good(dea_solid_move_spring(ctx, solid, 0, 0));
    good(dea_solid_solve(ctx, solid, 0));
    assert_close(array(solid, where)->data[i], 0, 0, 1e-9 * there);
  }
  assert_int_equal(dea_solid_move_spring(ctx, solid, 1, 0), DEA_E_ARGUMENT);
  spring.body = 1;
  assert_int_equal(dea_solid_add_spring(ctx, solid, &spring), DEA_E_ARGUMENT);
  spring.body = 0;
  spring.component = 3; // two of them
  assert_int_equal(dea_solid_add_spring(ctx, solid, &spring), DEA_E_ARGUMENT);
  dea_solid_free(solid);
}

TEST(test_springs)
{
  const double y[3] = {-1e-3, 1e-3, 3e-3}, F[3] = {2, 1, 0.8}; // less and less
  dea_body_spring spring = DEA_BODY_SPRING_INIT;
  spring.component = 4;
  spring.stiffness = 500;
  check_spring(&spring, 1e-3, "spring_force_N");
  spring.component = 16;
  spring.stiffness = 0.02;
  check_spring(&spring, 0.1, "spring_moment_N_m");
  spring.component = 4;
  spring.count = 3;
  spring.at = y;
  spring.force = F;
  check_spring(&spring, 1e-3, "spring_force_N");
}

struct allocations {
  long left; // until the one that fails
  long alive;
  bool failed;
};

static void *resize(void *user, void *pointer, size_t size)
{
  struct allocations *count = user;
  if (count->left-- == 0) {
    count->failed = true;
    return NULL;
  }
  void *moved = realloc(pointer, size);
  count->alive += moved != NULL && pointer == NULL;
  return moved;
}

static void release(void *user, void *pointer)
{
  struct allocations *count = user;
  count->alive -= pointer != NULL;
  free(pointer);
}

/* Much of what a solid can do, until something fails. */
static dea_status work(dea_context *own, const dea_solid_options *options, dea_solid **solid)
{
  const double *size = options->box_m, bottom[3] = {size[0], size[1], 0};
  const int nodes[2] = {0, 1};
  const dea_array *pull;
  const dea_mesh *mesh;
  dea_body_spring spring = DEA_BODY_SPRING_INIT;
  spring.component = 4;
  spring.stiffness = 100;
  spring.place = 0.05 * size[2];
  dea_status status = dea_solid_new(own, options, solid);
  status = status ? status : dea_solid_hold(own, *solid, nothing, bottom, 7, nothing);
  status = status ? status : dea_solid_hold_nodes(own, *solid, nodes, 2, 7, nothing);
  status = status ? status : dea_solid_hold_body(own, *solid, 0, 32, nothing, nothing);
  status = status ? status : dea_solid_add_spring(own, *solid, &spring);
  status = status ? status : dea_solid_add_spring(own, *solid, &spring);
  status = status ? status : dea_solid_solve(own, *solid, 0);
  status = status ? status : dea_solid_array(own, *solid, "spring_force_N", &pull);
  status = status ? status : dea_solid_mesh(own, *solid, &mesh);
  status = status ? status : dea_solid_find_charges(own, *solid);
  return status ? status : dea_solid_modes(own, *solid, 1);
}

/* Whichever allocation fails: out of memory, and nothing is left over. */
TEST(test_memory)
{
  const double mu = 0.4e6, size[3] = {0.01, 0.01, 0.02};
  dea_part part = rubber(&mu);
  part.density_kg_per_m3 = 1000;
  const dea_part *parts[] = {&part};
  dea_body plate = DEA_BODY_INIT;
  plate.low_m[2] = size[2];
  memcpy(plate.high_m, size, sizeof size);
  const dea_body *bodies[] = {&plate};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  memcpy(options.box_m, size, sizeof size);
  options.elements[0] = options.elements[1] = options.elements[2] = 1;
  options.parts = parts;
  options.part_count = 1;
  options.bodies = bodies;
  options.body_count = 1;
  struct allocations count = {.failed = true};
  long n = 0;
  for (; count.failed; n++) {
    dea_context_options with = DEA_CONTEXT_OPTIONS_INIT;
    dea_context *own;
    dea_solid *solid = NULL;
    count = (struct allocations){.left = n};
    with.user = &count;
    with.resize = resize;
    with.release = release;
    dea_status status = dea_context_new(&with, &own);
    if (status == DEA_OK) {
      status = work(own, &options, &solid);
      dea_solid_free(solid);
      dea_context_free(own);
    }
    assert_int_equal(status, count.failed ? DEA_E_MEMORY : DEA_OK);
    assert_int_equal(count.alive, 0);
  }
  assert_true(n > 100);
}

TEST(test_refused)
{
  const double mu[2] = {0.4e6, 1}, size[3] = {0.01, 0.01, 0.04};
  dea_part part = rubber(mu);
  const dea_part *parts[] = {&part};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  dea_solid *solid;
  memcpy(options.box_m, size, sizeof size);
  options.elements[0] = options.elements[1] = options.elements[2] = 1;
  options.parts = parts;
  assert_int_equal(dea_solid_new(ctx, &options, &solid), DEA_E_ARGUMENT); // no part
  options.part_count = 1;
  part.law = "neo-hooke";
  assert_int_equal(dea_solid_new(ctx, &options, &solid), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "'neo-hookean'"));
  part.law = "neo-hookean";
  part.parameter_count = 2;
  assert_int_equal(dea_solid_new(ctx, &options, &solid), DEA_E_ARGUMENT);
  part.law = NULL; // and no modulus
  assert_int_equal(dea_solid_new(ctx, &options, &solid), DEA_E_ARGUMENT);
  assert_null(solid);
  part = rubber(mu);
  good(dea_solid_new(ctx, &options, &solid));
  assert_int_equal(dea_solid_path_step(ctx, solid), DEA_E_ARGUMENT); // none was begun
  const double far[3] = {1, 1, 1};
  assert_int_equal(dea_solid_hold(ctx, solid, far, far, 7, nothing), DEA_E_ARGUMENT);
  assert_int_not_equal(dea_solid_solve(ctx, solid, 0), DEA_OK); // nothing holds it
  assert_int_equal(dea_solid_solve(ctx, solid, (double)NAN), DEA_E_ARGUMENT);
  const dea_array *none;
  assert_int_equal(dea_solid_array(ctx, solid, "mode_Hz", &none), DEA_E_ARGUMENT); // not asked for
  dea_solid_free(solid);
  const dea_law_info *law;
  size_t count = 0;
  while ((law = dea_law_at(ctx, count)) != NULL) {
    assert_true(law->parameter_count > 0 && strchr(law->parameters, '[') != NULL);
    count++;
  }
  assert_true(count >= 7);
}

/* Settings are listed, change what a solve does, and are refused where they cannot be. */
TEST(test_settings)
{
  const double mu = 0.4e6, size[3] = {0.01, 0.01, 0.04}, end[3] = {0, 0, size[2]};
  const double traction[3] = {0, 0, mu};
  dea_part part = rubber(&mu);
  dea_solid *solid = box(&part, size, 1, 1, 2);
  const dea_solid_setting *setting;
  size_t count = 0;
  bool found = false;
  while ((setting = dea_solid_setting_at(ctx, solid, count)) != NULL) {
    found = found || (strcmp(setting->name, "newton_max_iterations") == 0 && setting->value == 80);
    assert_true(setting->value > 0 && strlen(setting->unit) > 0 && strlen(setting->meaning) > 0);
    count++;
  }
  assert_true(found && count > 20 && count < 30);
  lean(solid, size);
  good(dea_solid_pull(ctx, solid, end, size, traction));
  good(dea_solid_set(ctx, solid, "newton_max_iterations", 1));
  assert_int_equal(dea_solid_solve(ctx, solid, 0), DEA_E_NOT_CONVERGED);
  assert_int_equal(dea_solid_set(ctx, solid, "newton_max_iterations", 2.5), DEA_E_ARGUMENT);
  assert_int_equal(dea_solid_set(ctx, solid, "newton_rtol", 0), DEA_E_ARGUMENT);
  assert_int_equal(dea_solid_set(ctx, solid, "patience", 1), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "'patience'"));
  good(dea_solid_set(ctx, solid, "iterations", 80)); // its former name
  good(dea_solid_solve(ctx, solid, 0));
  dea_solid_free(solid);
}

/* A voltage that no film bears is one without an equilibrium, in all models. */
TEST(test_voltage_out_of_all_range)
{
  static const char *const models[] = {"lumped", "axisymmetric", "3d"};
  static const char text[] = "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\n"
                             "pre_stretch: 1.3\nframe: {inner_diameter: 40 mm}\n"
                             "electrodes: {diameter: 20 mm stretched}\n"
                             "compute: {solid: {film: membrane}}\n";
  dea_design *design;
  good(dea_design_parse(ctx, text, "d.yaml", &design));
  for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
    for (int sign = -1; sign < 2; sign += 2) {
      dea_actuator *actuator;
      double z;
      good(dea_actuator_open(ctx, design, models[i], &actuator));
      const dea_status status = dea_actuator_solve(ctx, actuator, sign * 1e300);
      assert_true(status == DEA_E_NO_EQUILIBRIUM || status == DEA_E_DOMAIN);
      good(dea_actuator_solve(ctx, actuator, 100)); // it goes on
      good(dea_actuator_get(ctx, actuator, "voltage_V", &z));
      assert_close(z, 100, 0, 0);
      dea_actuator_free(actuator);
    }
  }
  dea_design_free(design);
}

int main(void)
{
  if (dea_context_new(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  int failed = run_all(NULL, NULL);
  dea_context_free(ctx);
  return failed;
}
