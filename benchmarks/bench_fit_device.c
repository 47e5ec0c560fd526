/* How long dea fit takes to find three parameters of a device through the membrane film: thickness,
 * pre-stretch and overlap from edge, fibre tip and capacitance at eight voltages; and through model
 * axisymmetric (the example of docs/fit.md). */
#include "bench_command.h"

static char folder[] = "/tmp/dea-bench-XXXXXX";

static void write_file(const char *name, const char *text)
{
  char path[80];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  if (file == NULL || fputs(text, file) < 0 || fclose(file) != 0) {
    fprintf(stderr, "cannot write %s\n", path);
    exit(EXIT_FAILURE);
  }
}

static const char design[] =
    "dea: 1\n"
    "film: {material: elastosil-2030, thickness: 100 um}\n"
    "pre_stretch: 1.5\n"
    "frame: {inner_diameter: 30 mm}\n"
    "electrodes: {diameter: 5 mm unstretched}\n"
    "fibres: {count: 4, material: pet}\n"
    "compute:\n"
    "  models: [3d]\n"
    "  voltage: {values: [1 kV, 2 kV, 3 kV, 3.5 kV, 4 kV, 4.5 kV, 5 kV, 5.5 kV]}\n"
    "  solid: {film: membrane}\n";

static const char fit[] =
    "dea_fit: 1\n"
    "name: bench\n"
    "design: design.yaml\n"
    "model: 3d\n"
    "parameters:\n"
    "  - {name: film.thickness, low: 60 um, high: 140 um}\n"
    "  - {name: pre_stretch, low: 1.1, high: 1.8}\n"
    "  - {name: fibres.overlap, start: 0.2 mm, low: -1 mm, high: 1.5 mm}\n"
    "curves:\n"
    "  - {name: edge, file: run/3d_sweep.csv, quantities: [electrode_edge_u_m],\n"
    "     uncertainty_absolute: 2 um}\n"
    "  - {name: tip, file: run/3d_sweep.csv, quantities: [fibre_tip_z_m],\n"
    "     uncertainty_absolute: 0.3 um}\n"
    "  - {name: charge, file: run/3d_sweep.csv, quantities: [capacitance_F],\n"
    "     uncertainty_absolute: 0.1 pF}\n";

int main(void)
{
  static char command[] = DEA_COMMAND, run[] = "run", set[] = "--set", force[] = "--force",
              quiet[] = "--no-figures", output[] = "-o", verb[] = "fit",
              thickness[] = "film.thickness=94 um", stretch[] = "pre_stretch=1.42",
              overlap[] = "fibres.overlap=0.4 mm stretched",
              example[] = DEA_SOURCE_DIR "/examples/fit/device.yaml";
  char from[80], to[80], file[80], fitted[80], remove[120];
  if (mkdtemp(folder) == NULL) {
    return EXIT_FAILURE;
  }
  write_file("design.yaml", design);
  write_file("fit.yaml", fit);
  snprintf(from, sizeof from, "%s/design.yaml", folder);
  snprintf(to, sizeof to, "%s/run", folder);
  snprintf(file, sizeof file, "%s/fit.yaml", folder);
  snprintf(fitted, sizeof fitted, "%s/fit", folder);
  snprintf(remove, sizeof remove, "rm -rf '%s'", folder);
  bench_run_once((char *[]){command, run, from, output, to, quiet, set, thickness, set, stretch,
                            set, overlap, NULL});
  bench_print("fit.device_membrane",
              bench_run_once((char *[]){command, verb, file, output, fitted, force, NULL}),
              "s for three parameters");
  bench_print("fit.device_axisymmetric",
              bench_run_once((char *[]){command, verb, example, output, fitted, force, NULL}),
              "s for three parameters");
  return system(remove) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
