/* A design with a thinner film, swept in voltage with the 3D model. Usage: sweep DESIGN */
#include <dea.h>
#include <stdio.h>

int main(int argc, char **argv)
{
  const char *model = "3d";
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  options.models = &model;
  options.model_count = 1;

  dea_context *ctx = NULL;
  dea_design *design = NULL;
  dea_result *result = NULL;
  const dea_array *V, *z;
  if (argc != 2 || dea_context_new(NULL, &ctx) != DEA_OK) {
    return 2;
  }
  int bad = dea_design_open(ctx, argv[1], &design) ||
            dea_design_set(ctx, design, "film.thickness", "80 um") ||
            dea_design_set(ctx, design, "compute.voltage", "{to: 4 kV, step: 2 kV}") ||
            dea_run(ctx, design, &options, &result) ||
            dea_result_array(ctx, result, "3d/sweep/voltage_V", &V) ||
            dea_result_array(ctx, result, "3d/sweep/centre_z_m", &z);
  if (bad) {
    fprintf(stderr, "%s\n", dea_error_message(ctx));
  }
  for (size_t i = 0; !bad && i < V->shape[0]; i++) {
    printf("%5.0f V %8.2f um\n", V->data[i], 1e6 * z->data[i]);
  }
  dea_result_free(result);
  dea_design_free(design);
  dea_context_free(ctx);
  return bad;
}
