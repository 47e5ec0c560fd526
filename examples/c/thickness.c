/* Which film goes furthest at 2 kV? A loop over values of a key, each checked, with all that is
 * found in the design. Usage: thickness DESIGN */
#include <dea.h>
#include <stdio.h>

static int report(dea_context *ctx)
{
  const dea_finding *finding;
  fprintf(stderr, "%s\n", dea_error_message(ctx));
  for (size_t i = 0; (finding = dea_finding_at(ctx, i)) != NULL; i++) {
    fprintf(stderr, "  %s:%zu: %s\n", finding->file, finding->line, finding->text);
  }
  return 1;
}

int main(int argc, char **argv)
{
  static const char *const films[] = {"60 um", "100 um", "200 um"};
  dea_context *ctx = NULL;
  dea_design *design = NULL;
  int bad = 0;
  if (argc != 2 || dea_context_new(NULL, &ctx) != DEA_OK) {
    return 2;
  }
  if (dea_design_open(ctx, argv[1], &design) != DEA_OK) {
    bad = report(ctx);
  }
  for (size_t i = 0; !bad && i < sizeof films / sizeof films[0]; i++) {
    dea_actuator *actuator = NULL;
    double stretch, margin;
    if (dea_design_set(ctx, design, "film.thickness", films[i]) ||
        dea_actuator_open(ctx, design, "lumped", &actuator) ||
        dea_actuator_solve(ctx, actuator, 2e3) ||
        dea_actuator_get(ctx, actuator, "electrode_stretch", &stretch) ||
        dea_actuator_get(ctx, actuator, "breakdown_margin", &margin)) {
      bad = report(ctx);
    } else {
      printf("%6s: electrode stretch %.4f, breakdown margin %.0f %%\n", films[i], stretch,
             100 * margin);
    }
    dea_actuator_free(actuator);
  }
  dea_design_free(design);
  dea_context_free(ctx);
  return bad;
}
