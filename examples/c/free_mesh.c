/* The plain disc on a free mesh: a film of silicone, pre-stretched by 1.5 into a round frame, with
 * electrodes in its middle; the mesh is a file of Gmsh (disc.geo, disc.msh). Prints how much the
 * electrode's radius grows with the voltage.
 *
 *   free_mesh disc.msh */
#include <dea.h>
#include <math.h>
#include <stdio.h>

int main(int argc, char **argv)
{
  const double yeoh[] = {178.4e3, -6e3, 4.2e3}, nothing[3] = {0, 0, 0};
  const double thickness = 100e-6 / (1.5 * 1.5), radius = 3.75e-3;
  dea_part film = DEA_PART_INIT;
  film.law = "yeoh";
  film.parameters = yeoh;
  film.parameter_count = 3;
  film.pre_stretch = 1.5;
  film.permittivity = 2.8;
  dea_part active = film; // between the electrodes
  active.electrode_gap_m = thickness;
  const dea_part *parts[] = {&film, &active};
  const dea_fill fills[] = {{0, "film", 0}, {0, "electrode", 1}}; // the later one wins
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  options.parts = parts;
  options.part_count = 2;
  options.msh_file = argc > 1 ? argv[1] : "disc.msh";
  options.msh_unit_m = 1e-3;
  options.ply_thickness_m = &thickness;
  options.ply_count = 1;
  options.fills = fills;
  options.fill_count = 2;

  dea_context *ctx = NULL;
  dea_solid *disc = NULL;
  const dea_array *points, *moved;
  if (dea_context_new(NULL, &ctx) != DEA_OK) {
    return 2;
  }
  int bad = dea_solid_new(ctx, &options, &disc) ||
            dea_solid_hold_curve(ctx, disc, "mirror_x", NULL, NULL, 1, nothing) ||
            dea_solid_hold_curve(ctx, disc, "mirror_y", NULL, NULL, 2, nothing) ||
            dea_solid_hold_curve(ctx, disc, "frame", NULL, NULL, 7, nothing);
  for (int kV = 0; !bad && kV <= 5; kV++) {
    double strain = NAN;
    bad = dea_solid_solve(ctx, disc, 1e3 * kV) || dea_solid_array(ctx, disc, "points_m", &points);
    for (size_t i = 0; !bad && i < points->shape[0]; i++) {
      const double *X = points->data + 3 * i;
      if (hypot(X[0] - radius, X[1]) < 1e-6 * radius && fabs(X[2] - 0.5 * thickness) < 1e-9) {
        bad = dea_solid_array(ctx, disc, "displacement_m", &moved) != DEA_OK;
        strain = bad ? NAN : moved->data[3 * i] / radius;
        break;
      }
    }
    if (!bad) {
      printf("%d kV: electrode grows by %6.3f %%\n", kV, 100 * strain);
    }
  }
  if (bad) {
    fprintf(stderr, "%s\n", dea_error_message(ctx));
  }
  dea_solid_free(disc);
  dea_context_free(ctx);
  return bad;
}
