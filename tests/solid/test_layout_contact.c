/* Contact of plies with a plane and with each other, of films that a pressure blows onto it:
 * against membranes of a tension T under a pressure p in closed form (docs/theory/loads.md). */
// ctest: solid
#include "design_text.h"
#include "model/model.h"

#include "layout_device.h"

#include <math.h>

#define SHAPES                                                                                     \
  "dea: 1\n"                                                                                       \
  "shapes:\n"                                                                                      \
  "  - {name: hole, kind: circle, radius: 10 mm}\n"                                                \
  "  - {name: ring, kind: circle, radius: 12 mm}\n"                                                \
  "  - {name: spacer, kind: difference, of: [ring, hole]}\n"
#define FILM(name)                                                                                 \
  "  - {name: " name                                                                               \
  ", shape: ring, material: film, law: a, permittivity: flat, thickness: 50 um, "                  \
  "pre_stretch: 1.5}\n"
#define REST                                                                                       \
  "electrodes:\n"                                                                                  \
  "  - {ply: film, side: top, shape: hole, channel: drive}\n"                                      \
  "  - {ply: film, side: bottom, shape: hole, channel: ground}\n"                                  \
  "supports: [{shape: spacer}]\n"                                                                  \
  "pressures: [{ply: film, side: top, shape: hole, pressure: 600 Pa}]\n"                           \
  "monitors: [{name: touch, contact: touch}, {name: side, at: [7 mm, 0 mm]}]\n" FILM_MATERIAL
#define ON_PLANE(gap)                                                                              \
  SHAPES "plies:\n" FILM("film") REST                                                              \
      "contacts: [{name: touch, ply: film, side: bottom, shape: hole, gap: " gap "}]\n"
#define ON_PLY(lower)                                                                              \
  SHAPES "plies:\n" lower                                                                          \
         "  - {name: spacer, shape: spacer, material: stiff, thickness: 400 um}\n" FILM("film")    \
             REST "contacts: [{name: touch, ply: film, side: bottom, shape: hole, with: lower}]\n"

static const double radius_m = 10e-3, gap_m = 400e-6, pressure_Pa = 600;

/* Force of a film on a plane, or on a film like it, of that tension: of the radius c at which
 * (p/2T) [(R^2 - c^2)/2 - c^2 ln(R/c)] = g, times 1/2 with R^2 - c^2 - 2 c^2 ln(R/c) for two. */
static double force_N(double tension, int films)
{
  double low = 0, high = radius_m;
  for (int i = 0; i < 100; i++) {
    const double c = 0.5 * (low + high), square = radius_m * radius_m - c * c;
    const double gap =
        pressure_Pa / (4 * tension) * (square - 2 * c * c * log(radius_m / c)); // the same for both
    *(gap > gap_m ? &low : &high) = c;
  }
  return pressure_Pa / films * acos(-1) * low * low;
}

struct seen {
  double force_N, area_m2, side_m, slope;
  struct dea_load_point point;
};

static struct seen solve(const char *text, const struct dea_override *override, size_t count)
{
  const struct dea_model_settings settings = {.refinement = 1};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_observation o;
  struct seen out;
  if (read_and_build(ctx, text, override, count, &design, &device) != DEA_OK) {
    print_findings(ctx);
  }
  assert_non_null(device);
  struct dea_model *model = layout_model(device, &settings);
  const struct dea_model_type *type = dea_model_find("3d");
  assert_ok(type->solve(ctx, model, 0, &out.point));
  assert_ok(type->observe(ctx, model, &o));
  out.force_N = o.monitor[0][DEA_OBSERVED_CONTACT_FORCE];
  out.area_m2 = o.monitor[0][DEA_OBSERVED_CONTACT_AREA];
  out.side_m = o.monitor[1][DEA_OBSERVED_Z];
  type->destroy(ctx, model);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return out;
}

/* A stiff ply is a plane; two films share the pressure. The tension rises as they are blown, which
 * the closed forms do not know. */
TEST(test_blown_films)
{
  const struct seen plane = solve(ON_PLANE("0.4 mm"), NULL, 0);
  const struct seen stiff =
      solve(ON_PLY("  - {name: lower, shape: ring, material: stiff, thickness: 2 mm}\n"), NULL, 0);
  const struct seen films = solve(ON_PLY(FILM("lower")), NULL, 0);
  const double tension = plane.point.min_tension_N_per_m;
  assert_close(plane.force_N, force_N(tension, 1), 0.015, 0);
  assert_close(stiff.force_N, plane.force_N, 0.005, 0);
  assert_close(films.force_N, force_N(tension, 2), 0.02, 0);
  assert_close(plane.area_m2, plane.force_N / pressure_Pa, 0.25, 0); // by nodes
}

/* A film that does not reach the plane feels nothing of it. */
TEST(test_far_plane)
{
  const struct seen far = solve(ON_PLANE("2 mm"), NULL, 0),
                    near = solve(ON_PLANE("0.4 mm"), NULL, 0);
  assert_close(far.force_N, 0, 0, 0);
  assert_close(far.area_m2, 0, 0, 0);
  assert_true(far.side_m < near.side_m);
}

static void check_refused(const char *text, const char *said)
{
  struct dea_design *design;
  struct dea_device *device;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  (void)read_and_build(ctx, text, NULL, 0, &design, &device);
  assert_true(dea_finding_count(ctx, DEA_ERROR) > errors);
  if (find_error(ctx, said) == NULL) {
    print_findings(ctx);
    fail();
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_clear(ctx);
}

TEST(test_refused)
{
  check_refused(SHAPES "plies:\n" FILM("lower") FILM("film") REST
                "contacts: [{name: touch, ply: film, side: bottom, shape: hole, with: lower}]\n",
                "has no gap to ply 'lower'");
  check_refused(SHAPES "plies:\n" FILM("film") REST
                "contacts: [{name: touch, ply: film, side: bottom, shape: hole}]\n",
                "lacks the distance of the flat face");
  check_refused(ON_PLANE("-1 mm"), "gap must be at least 0");
}

TESTS(context_set_up, context_tear_down)
