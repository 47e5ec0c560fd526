/* Membrane elements: points, known tensions, meshes. */
#include "complex_material.h"
#include "failing_allocator.h"
#include "membrane_samples.h"
#include "model/solid/load/loads.h"
#include "quarter_grid.h"
#include "solid_element.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

/* ---- against the law in three dimensions ---- */

/* P of the film from the material point of a solid, its third column the normal over |F1 x F2|^2;
 * for complex F. */
static double complex solid_film(const struct dea_part_material *layer, double field,
                                 const double complex F[6], double complex P[6])
{
  const double *G = layer->pre_stretch, s = layer->pre_shear;
  double complex N[3], full[9], W, solid[9], A[81], n = 0;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    N[i] = F[2 * j] * F[2 * k + 1] - F[2 * k] * F[2 * j + 1];
    n += N[i] * N[i];
  }
  for (int i = 0; i < 3; i++) {
    full[3 * i] = F[2 * i] * G[0] + F[2 * i + 1] * s;
    full[3 * i + 1] = F[2 * i] * s + F[2 * i + 1] * G[1];
    full[3 * i + 2] = N[i] / n * G[2];
  }
  assert_int_equal(complex_point(layer->law->name, layer->param, full, NULL, &W, solid, A), DEA_OK);
  // -(E^2/2) (eps + slope (n^(1/4) - 1)) n, n = |F_1 x F_2|^2
  double slope = layer->permittivity_slope_F_per_m, rest = layer->permittivity_F_per_m - slope;
  double complex k = field * field * (rest + 1.25 * slope * cpow(n, 0.25));
  for (int a = 0; a < 6; a++) {
    int i = a / 2, J = a % 2, j = (i + 1) % 3, l = (i + 2) % 3, O = 1 - J;
    double sign = J == 0 ? 1 : -1;
    double complex d[3] = {0, 0, 0}, dn = 0; // dN/dF_iJ: e_i x F_2 or F_1 x e_i
    d[l] = sign * F[2 * j + O];
    d[j] = -sign * F[2 * l + O];
    for (int b = 0; b < 3; b++) {
      dn += 2 * N[b] * d[b];
    }
    P[a] = G[J] * solid[3 * i + J] + s * solid[3 * i + O] - 0.5 * k * dn;
    for (int b = 0; b < 3; b++) {
      P[a] += G[2] * solid[3 * b + 2] * (d[b] / n - N[b] * dn / (n * n));
    }
  }
  return W - 0.5 * field * field * (rest + slope * cpow(n, 0.25)) * n;
}

/* W, P and A of the film against the solid: A by complex step of P, P by complex step of W too. */
static void check_point(const struct dea_part_material *layer, double field, const double F[6],
                        double tolerance)
{
  static const double step = 1e-30;
  struct dea_membrane_point point;
  double wanted[36], P[6], scale;
  assert_int_equal(dea_membrane_point(layer, NULL, F, field, &point), DEA_OK);
  scale = largest(point.A, 36);
  for (int b = 0; b < 6; b++) {
    double complex z[6], stepped[6];
    for (int a = 0; a < 6; a++) {
      z[a] = F[a];
    }
    z[b] += step * _Complex_I;
    double complex W = solid_film(layer, field, z, stepped);
    P[b] = cimag(W) / step;
    assert_close(point.W, creal(W), 0, 1e-12 * scale);
    assert_close(point.P[b], creal(stepped[b]), 0, 1e-12 * scale);
    for (int a = 0; a < 6; a++) {
      wanted[6 * a + b] = cimag(stepped[a]) / step;
    }
  }
  assert_all_close(layer->law->name, point.P, P, 6, 1e-12, scale);
  assert_all_close(layer->law->name, point.A, wanted, 36, tolerance, scale);
  for (size_t i = 0; i < 36; i++) {
    wanted[i] = point.A[6 * (i % 6) + i / 6];
  }
  assert_all_close("symmetry", point.A, wanted, 36, 1e-14, scale);
}

static void check_law(const struct dea_law *law, const double *param)
{
  uint64_t seed = 11;
  for (int n = 0; n < 20 && !law->anisotropic && law->compressible == NULL; n++) {
    double m1 = uniform(&seed, 0.8, 1.3), m2 = uniform(&seed, 0.8, 1.3), F[6];
    struct dea_part_material layer =
        film(law, param, uniform(&seed, 0.9, 1.4), uniform(&seed, 0.9, 1.4));
    layer.permittivity_slope_F_per_m = uniform(&seed, -0.3, 0.1) * permittivity;
    compose(m1, m2, uniform(&seed, 0, 6), F);
    check_point(&layer, uniform(&seed, 0, 5e7), F, 1e-11);
    layer.pre_shear = uniform(&seed, -0.2, 0.2);
    layer.pre_stretch[2] =
        1 / (layer.pre_stretch[0] * layer.pre_stretch[1] - layer.pre_shear * layer.pre_shear);
    check_point(&layer, uniform(&seed, 0, 5e7), F, 1e-11);
  }
}

TEST(test_point_is_the_solid_in_plane_stress)
{
  for_each_law(check_law);
}

/* Stretches that are equal or nearly. A complex step through eigenvectors loses digits there, so
 * laws in principal form are compared by terms that have an invariant form too: sum l^2 = I1, and
 * sum l^4 = I1^2 - 2 I2 (a complex step at a gap of 1e-3 is good to 1e-9). */
TEST(test_equal_stretches)
{
  static const double gaps[] = {0, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3, 9e-3, 1.1e-2, 2e-2};
  static const double square[DEA_LAW_PARAM_MAX] = {80e3, 2}, fourth[DEA_LAW_PARAM_MAX] = {40e3, 4};
  static const double neo[DEA_LAW_PARAM_MAX] = {80e3};
  for (size_t g = 0; g < sizeof gaps / sizeof gaps[0]; g++) {
    for (int turn = 0; turn < 4; turn++) {
      double F[6], scale;
      struct dea_membrane_point a, b;
      compose(1.2 * (1 + gaps[g]), 1.2, 0.3 * turn, F);
      const struct dea_part_material invariant = yeoh_film(1.5);
      check_point(&invariant, 3e7, F, 1e-12);
      const struct dea_part_material principal = film(dea_law_find("ogden"), square, 1.1, 1.1);
      const struct dea_part_material the_same = film(dea_law_find("neo-hookean"), neo, 1.1, 1.1);
      assert_int_equal(dea_membrane_point(&principal, NULL, F, 2e7, &a), DEA_OK);
      assert_int_equal(dea_membrane_point(&the_same, NULL, F, 2e7, &b), DEA_OK);
      scale = largest(b.A, 36);
      assert_all_close("alpha = 2", a.P, b.P, 6, 1e-12, scale);
      assert_all_close("alpha = 2", a.A, b.A, 36, 1e-12, scale);
      if (gaps[g] > 1e-4) {
        const struct dea_part_material higher = film(dea_law_find("ogden"), fourth, 1.1, 1.1);
        check_point(&higher, 2e7, F, 1e-9);
      }
    }
  }
}

TEST(test_laws_that_are_refused)
{
  const struct dea_part_material plastic = dea_part_material_bonded((const double[]){2, 0});
  const struct dea_part_material soft = yeoh_film(1.5);
  const struct dea_part_material fibrous = film(dea_law_find("holzapfel-gasser-ogden"), yeoh, 1, 1);
  assert_int_equal(dea_membrane_check(&soft), DEA_OK);
  assert_int_equal(dea_membrane_check(&plastic), DEA_E_UNSUPPORTED);
  assert_int_equal(dea_membrane_check(&fibrous), DEA_E_UNSUPPORTED);
}

/* The bond has the shear modulus of the film across it, 2 W'(I1)/l^4, three halves of it. */
TEST(test_bond)
{
  struct dea_part_material soft = yeoh_film(1.5), bond;
  double area = 2.25, I1 = 2 * area + 1 / (area * area) - 3;
  double W1 = yeoh[0] + 2 * yeoh[1] * I1 + 3 * yeoh[2] * I1 * I1;
  assert_int_equal(dea_part_material_relax(&soft), DEA_OK);
  assert_int_equal(dea_membrane_bond(&soft, &bond), DEA_OK);
  assert_false(dea_part_material_takes_pressure(&bond));
  assert_close(dea_part_material_modulus(&bond), 1.5 * 2 * W1 / (area * area), 1e-12, 0);
  assert_true(bond.param[1] > 0.48); // nearly incompressible
  const struct dea_part_material plastic = dea_part_material_bonded((const double[]){2, 0});
  assert_int_equal(dea_membrane_bond(&plastic, &bond), DEA_E_UNSUPPORTED);
}

/* Held flat the film pulls with the true stress of benchmark 1; a field takes eps E^2 of it. At
 * rest its energy is that of the stretched film. */
TEST(test_flat_film_has_the_true_pre_stress)
{
  static const double flat[6] = {1, 0, 0, 1, 0, 0};
  static const double stretch[] = {1.1, 1.2, 1.3, 1.4, 1.5, 2.0};
  static const double nominal[] = {169.879e3, 280.470e3, 363.529e3,
                                   441.409e3, 531.830e3, 1734.761e3};
  for (int i = 0; i < 6; i++) {
    for (int k = 0; k < 2; k++) {
      double field = k * 1e8, l = stretch[i], I1 = 2 * l * l + pow(l, -4) - 3;
      const struct dea_part_material layer = yeoh_film(l);
      struct dea_membrane_point point;
      assert_int_equal(dea_membrane_point(&layer, NULL, flat, field, &point), DEA_OK);
      double stress = nominal[i] * l - permittivity * field * field;
      assert_close(point.P[0], stress, 2e-6, 1);
      assert_close(point.P[3], stress, 2e-6, 1);
      assert_close(point.tension_Pa[1], stress, 2e-6, 1);
      double W = yeoh[0] * I1 + yeoh[1] * I1 * I1 + yeoh[2] * I1 * I1 * I1;
      assert_close(point.W, W - 0.5 * permittivity * field * field, 1e-12, 0);
    }
  }
}

/* ---- meshes ---- */

/* Loads on a membrane: it is its own upper and lower face and has no sides. */
TEST(test_faces)
{
  const double b = 15e-3, area = 0.25 * acos(-1) * b * b;
  const struct dea_quarter quarter = {2, 1, 3.75e-3, b, 1e-4, .fine = 3, .membrane = true};
  struct dea_grid *grid;
  struct dea_arena memory = {.ctx = ctx};
  struct dea_surface *surface;
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &grid), DEA_OK);
  for (int side = DEA_FACE_BOTTOM; side <= DEA_FACE_TOP; side++) {
    assert_ok(dea_surface_create(ctx, grid, (enum dea_face)side, NULL, NULL, &memory, &surface));
    struct dea_face_shape face;
    double X[3 * DEA_FACE_NODES_MAX], normal[3];
    assert_close(dea_surface_area(surface), area, 2e-4, 0);
    dea_face_shape_create(surface->order, DEA_FACE_GAUSS, &face);
    dea_face_gather(surface, 0, grid->X, X);
    dea_face_normal(&face, 0, X, normal);
    assert_true(side == DEA_FACE_TOP ? normal[2] > 0 : normal[2] < 0);
  }
  assert_int_equal(dea_surface_create(ctx, grid, DEA_FACE_FIRST_LOW, NULL, NULL, &memory, &surface),
                   DEA_E_ARGUMENT);
  dea_arena_free(&memory);
  dea_grid_destroy(ctx, grid);
}

static void make_grid(struct dea_context *failing)
{
  const struct dea_quarter quarter = {
      2, 2, 2e-3, 9e-3, 1e-4, 8, 1e-3, 1e-4, .fine = 1, .across = 1, .membrane = true};
  struct dea_grid *grid = NULL;
  failing_check(failing, dea_grid_quarter(failing, &quarter, &grid));
  dea_grid_destroy(failing, grid);
}

TEST(test_each_allocation_of_a_mesh)
{
  assert_true(failing_each(make_grid) > 5);
}

TESTS(context_set_up, context_tear_down)
