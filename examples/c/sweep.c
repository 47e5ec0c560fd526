/* A design, swept in voltage with the 3D model; prints voltage and height. Usage: sweep DESIGN */
#include <dea.h>
#include <stdio.h>

int main(int argc, char **argv)
{
  dea_context *ctx = NULL;
  dea_design *design = NULL;
  dea_result *result = NULL;
  const dea_array *V, *z;
  const char *const models[] = {"3d"}, *const studies[] = {"sweep"};
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  options.models = models;
  options.model_count = 1;
  options.studies = studies;
  options.study_count = 1;

  if (argc < 2 || dea_context_new(NULL, &ctx) != DEA_OK) {
    return 2;
  }
  if (dea_design_open(ctx, argv[1], &design) == DEA_OK &&
      dea_design_set(ctx, design, "compute.voltage", "{from: 0 kV, to: 4 kV, step: 2 kV}") ==
          DEA_OK &&
      dea_run(ctx, design, &options, &result) == DEA_OK &&
      dea_result_array(ctx, result, "3d/sweep/voltage_V", &V) == DEA_OK &&
      dea_result_array(ctx, result, "3d/sweep/centre_z_m", &z) == DEA_OK) {
    for (size_t i = 0; i < V->shape[0]; i++) {
      printf("%6.0f V %9.2f um\n", V->data[i], 1e6 * z->data[i]);
    }
  }
  const char *message = dea_error_message(ctx);
  const dea_finding *finding;
  for (size_t i = 0; (finding = dea_finding_at(ctx, i)) != NULL; i++) {
    fprintf(stderr, "%s:%zu: %s\n", finding->file, finding->line, finding->text);
  }
  fprintf(stderr, "%s\n", message);
  int bad = message[0] != '\0';
  dea_result_free(result);
  dea_design_free(design);
  dea_context_free(ctx);
  return bad;
}
