/* A plate of rubber between clamps, pulled: our hexahedra against CalculiX (ccx), which has its own
 * elements, material and solver. Exit code 77 when ccx is not there. */
#include "verify.h"

#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"

#include <unistd.h>

static const double half_length_m = 5e-3, half_width_m = 5e-3, half_thickness_m = 0.5e-3;
static const double yeoh[DEA_LAW_PARAM_MAX] = {178.4e3, -6e3, 4.2e3}; // paper Table 1

static struct dea_context *ctx;

struct answer {
  double force_N, narrowing_m; // of the whole plate; of half its width in the middle
};

/* ---- ours: an eighth, incompressible ---- */

static void map_plate(const void *self, double s, double t, double x[2])
{
  (void)self;
  x[0] = half_length_m * s;
  x[1] = half_width_m * t;
}

static int held(const void *self, const double X[3])
{
  (void)self;
  if (X[0] > half_length_m * (1 - 1e-9)) {
    return 1 | 2 | 4;
  }
  return (X[0] < 1e-12 ? 1 : 0) | (X[1] < 1e-12 ? 2 : 0) | (X[2] < 1e-12 ? 4 : 0);
}

/* Moves the clamp to a pull [m] and solves; returns the energy of the eighth. */
static double pulled(struct dea_grid *grid, struct dea_solid *solid, double pull_m)
{
  double *u = dea_solid_displacement(solid);
  struct dea_solid_report report;
  double last = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    last = grid->X[3 * n] > half_length_m * (1 - 1e-9) ? u[3 * n] : last;
  }
  for (size_t n = 0; n < grid->node_count; n++) { // everything along: a start without steep edges
    u[3 * n] += (pull_m - last) * grid->X[3 * n] / half_length_m;
  }
  verify_ok(ctx, dea_load_steps_solve(ctx, solid, 0, &report));
  return report.energy_J;
}

static struct answer ours(int elements, double stretch)
{
  double cuts[65];
  for (int i = 0; i <= elements; i++) { // finer toward the clamp and the free edge
    double s = (double)i / elements;
    cuts[i] = 1 - (1 - s) * (1 + 0.6 * s);
  }
  const struct dea_block block = {map_plate,        NULL, cuts, cuts, (size_t)elements,
                                  (size_t)elements, 0};
  const struct dea_ply ply = {half_thickness_m, 2, 2};
  struct dea_part_material rubber = {.law = dea_law_find("yeoh"),
                                     .param = {yeoh[0], yeoh[1], yeoh[2]},
                                     .pre_stretch = {1, 1, 1},
                                     .kappa_Pa = 4e7};
  const struct dea_solid_options options = {
      .order_z = 2, .part_material_count = 1, .part_materials = &rubber, .held = held};
  struct dea_grid *grid;
  struct dea_solid *solid;
  verify_ok(ctx, dea_part_material_relax(&rubber));
  verify_ok(ctx, dea_grid_create(ctx, 2, &block, 1, &ply, 1, NULL, 0, half_length_m, &grid));
  verify_ok(ctx, dea_solid_create(ctx, grid, &options, &solid));
  const double pull = (stretch - 1) * half_length_m, step = 1e-3 * half_length_m;
  for (int i = 1; i < 10; i++) {
    pulled(grid, solid, pull * i / 10);
  }
  double below = pulled(grid, solid, pull - step), above = pulled(grid, solid, pull + step);
  pulled(grid, solid, pull);
  struct answer answer = {4 * (above - below) / (2 * step),
                          NAN}; // two eighths pull each clamp half
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    if (X[0] < 1e-12 && X[1] > half_width_m * (1 - 1e-9) && X[2] < 1e-12) {
      answer.narrowing_m = -dea_solid_displacement(solid)[3 * n + 1];
    }
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  return answer;
}

/* ---- CalculiX: the same eighth of C3D20R, compressible with a bulk modulus ---- */

static int node_number(int i, int j, int k, int n)
{
  return 1 + i + (2 * n + 1) * (j + (2 * n + 1) * k);
}

static bool is_node(int i, int j, int k)
{
  return (i & 1) + (j & 1) + (k & 1) < 2; // of a brick with 20 nodes
}

static double graded(int i, int n)
{
  double s0 = (double)(i / 2) / n, s1 = (double)((i + 1) / 2) / n;
  double c0 = 1 - (1 - s0) * (1 + 0.6 * s0), c1 = 1 - (1 - s1) * (1 + 0.6 * s1);
  return 0.5 * (c0 + c1);
}

static void write_mesh(FILE *f, int n)
{
  static const int at[20][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2},
                                {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {1, 0, 0}, {2, 1, 0},
                                {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2}, {1, 2, 2},
                                {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
  fprintf(f, "*NODE, NSET=ALL\n");
  for (int k = 0; k <= 4; k++) {
    for (int j = 0; j <= 2 * n; j++) {
      for (int i = 0; i <= 2 * n; i++) {
        if (is_node(i, j, k)) {
          fprintf(f, "%d, %.9e, %.9e, %.9e\n", node_number(i, j, k, n),
                  half_length_m * graded(i, n), half_width_m * graded(j, n),
                  half_thickness_m * k / 4);
        }
      }
    }
  }
  fprintf(f, "*ELEMENT, TYPE=C3D20R, ELSET=EALL\n");
  for (int e = 0; e < 2 * n * n; e++) {
    fprintf(f, "%d", e + 1);
    for (int a = 0; a < 20; a++) {
      int i = 2 * (e % n) + at[a][0], j = 2 * (e / n % n) + at[a][1],
          k = 2 * (e / n / n) + at[a][2];
      fprintf(f, ",%s%d", a == 10 ? "\n" : " ", node_number(i, j, k, n));
    }
    fprintf(f, "\n");
  }
}

/* A set of the nodes with index `at` along one axis. */
static void write_set(FILE *f, const char *name, int axis, int at, int n)
{
  fprintf(f, "*NSET, NSET=%s\n", name);
  for (int k = 0; k <= 4; k++) {
    for (int j = 0; j <= 2 * n; j++) {
      for (int i = 0; i <= 2 * n; i++) {
        const int index[3] = {i, j, k};
        if (is_node(i, j, k) && index[axis] == at) {
          fprintf(f, "%d,\n", node_number(i, j, k, n));
        }
      }
    }
  }
}

static struct answer calculix(const char *folder, int n, double stretch, double bulk_Pa)
{
  char path[512];
  struct answer answer = {NAN, NAN};
  snprintf(path, sizeof path, "%s/plate.inp", folder);
  FILE *f = fopen(path, "w");
  if (f == NULL) {
    return answer;
  }
  write_mesh(f, n);
  write_set(f, "X0", 0, 0, n);
  write_set(f, "Y0", 1, 0, n);
  write_set(f, "Z0", 2, 0, n);
  write_set(f, "CLAMP", 0, 2 * n, n);
  fprintf(f,
          "*NSET, NSET=SIDE\n%d,\n"
          "*MATERIAL, NAME=RUBBER\n*HYPERELASTIC, YEOH\n%.9e, %.9e, %.9e, %.9e, 0., 0.\n"
          "*SOLID SECTION, ELSET=EALL, MATERIAL=RUBBER\n"
          "*BOUNDARY\nX0, 1, 1\nY0, 2, 2\nZ0, 3, 3\nCLAMP, 2, 3\n"
          "*STEP, NLGEOM, INC=200\n*STATIC\n0.1, 1., 1e-4, 0.2\n*BOUNDARY\nCLAMP, 1, 1, %.9e\n"
          "*NODE PRINT, NSET=CLAMP, TOTALS=ONLY, FREQUENCY=1000\nRF\n"
          "*NODE PRINT, NSET=SIDE, FREQUENCY=1000\nU\n*END STEP\n",
          node_number(0, 2 * n, 0, n), yeoh[0], yeoh[1], yeoh[2], 2 / bulk_Pa,
          (stretch - 1) * half_length_m);
  fclose(f);
  char command[600];
  snprintf(command, sizeof command, "cd '%s' && ccx plate >ccx.log 2>&1", folder);
  if (system(command) != 0) {
    return answer;
  }
  snprintf(path, sizeof path, "%s/plate.dat", folder);
  f = fopen(path, "r");
  char line[256];
  bool is_force = false;
  while (f != NULL && fgets(line, sizeof line, f) != NULL) { // the last increment's come last
    double x, y, z, node;
    if (strstr(line, "total force") != NULL || strstr(line, "displacements") != NULL) {
      is_force = strstr(line, "total force") != NULL;
    } else if (is_force && sscanf(line, "%lf %lf %lf", &x, &y, &z) == 3) {
      answer.force_N = 4 * x;
    } else if (!is_force && sscanf(line, "%lf %lf %lf %lf", &node, &x, &y, &z) == 4) {
      answer.narrowing_m = -y;
    }
  }
  if (f != NULL) {
    fclose(f);
  }
  return answer;
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  char folder[] = "/tmp/dea-calculix-XXXXXX";
  if (system("command -v ccx >/dev/null 2>&1") != 0 || mkdtemp(folder) == NULL) {
    fprintf(stderr, "ccx (package calculix-ccx) is not here\n");
    return 77;
  }
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  const double stretches[] = {1.1, 1.3, 1.5};
  const int elements = small ? 4 : 8;
  const double tolerance = small ? 2e-2 : 1e-2; // half the elements along each side
  puts(
      "# A pulled plate: against CalculiX\n\n"
      "Made by `scripts/verify calculix`; not to be edited. A plate of 10 x 10 x 1 mm, Yeoh (paper "
      "Table 1), held at two opposite\nfaces by clamps that are drawn apart: the force, and by how "
      "much half its width narrows in the middle. Ours is\nincompressible; CalculiX 2.20 (C3D20R, "
      "*HYPERELASTIC, YEOH) has a bulk modulus K, and the last column of its answers is\nwhat K = "
      "100 and "
      "200 MPa say of an infinite one (the difference goes with 1/K). An eighth by 8 x 8 x 2 "
      "elements in both.\nTolerance 1 %.\n");
  puts("| stretch | | ours | CalculiX, K = 100 MPa | 200 MPa | infinite | difference "
       "|\n|---|---|---|---|---|---|---|");
  for (int i = 0; i < (small ? 1 : 3); i++) {
    struct answer mine = ours(elements, stretches[i]);
    struct answer soft = calculix(folder, elements, stretches[i], 1e8);
    struct answer hard = calculix(folder, elements, stretches[i], 2e8);
    struct answer limit = {2 * hard.force_N - soft.force_N,
                           2 * hard.narrowing_m - soft.narrowing_m};
    printf("| %.1f | force (N) | %.5f | %.5f | %.5f | %.5f | %+.2f %% |\n", stretches[i],
           mine.force_N, soft.force_N, hard.force_N, limit.force_N,
           100 * verify_relative("force", mine.force_N, limit.force_N, tolerance));
    printf("| | narrowing (mm) | %.5f | %.5f | %.5f | %.5f | %+.2f %% |\n", 1e3 * mine.narrowing_m,
           1e3 * soft.narrowing_m, 1e3 * hard.narrowing_m, 1e3 * limit.narrowing_m,
           100 * verify_relative("narrowing", mine.narrowing_m, limit.narrowing_m, tolerance));
    fflush(stdout);
  }
  char command[64];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  dea_context_destroy(ctx);
  return system(command) == 0 ? verify_end() : 1;
}
