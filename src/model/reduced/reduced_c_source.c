/* A reduced-order model as one file in C99: reduced_core.[ch], the device's numbers, and a test of
 * them. */
#include "base/assets.h"
#include "base/version.h"
#include "model/reduced/reduced.h"

#include <math.h>
#include <string.h>

enum { POINTS = 5 }; // of the test, along each variable

static const char head[] =
    "/* %s, reduced from 3D by dea %s.\n"
    " *\n"
    " * Range: force %.6g to %.6g %s, voltage %.6g to %.6g V.\n"
    " * Held-out error: %.2g %% of the stroke of %.6g %s, %.2g %% of the charge.\n"
    " *\n"
    " *   cc -std=c99 -O2 -c FILE                      and in your program:\n"
    " *     struct dea_reduced_state s;\n"
    " *     dea_reduced_begin(&dea_reduced_device, V, F, &s);\n"
    " *     dea_reduced_step(&dea_reduced_device, &s, dt, V, F, 1, 0.9, &s);   s.at.q, "
    "s.at.charge_C\n"
    " *   cc -std=c99 -O2 -DDEA_REDUCED_TEST FILE -lm  is its test. */\n\n";

static const char test[] =
    "#ifdef DEA_REDUCED_TEST\n#include <stdio.h>\n#include <time.h>\n\n"
    "int main(void)\n{\n"
    "  const int count = (int)(sizeof dea_reduced_points / sizeof dea_reduced_points[0]);\n"
    "  const int steps = 1000000;\n"
    "  const struct dea_reduced *m = &dea_reduced_device;\n"
    "  struct dea_reduced_state s;\n"
    "  double worst = 0, largest[2] = {0, 0};\n"
    "  int wrong = 0;\n"
    "  for (int i = 0; i < count; i++) {\n"
    "    largest[0] = fmax(largest[0], fabs(dea_reduced_points[i][2]));\n"
    "    largest[1] = fmax(largest[1], fabs(dea_reduced_points[i][3]));\n  }\n"
    "  for (int i = 0; i < count; i++) {\n"
    "    const double *row = dea_reduced_points[i];\n"
    "    struct dea_reduced_point p, held;\n"
    "    wrong += dea_reduced_at(m, row[0], row[1], &p) != DEA_REDUCED_OK;\n"
    "    worst = fmax(worst, fabs(p.q - row[2]) / largest[0]);\n"
    "    worst = fmax(worst, fabs(p.charge_C - row[3]) / largest[1]);\n"
    "    held.force = 0;\n"
    "    wrong += dea_reduced_held(m, p.q, row[1], &held) != DEA_REDUCED_OK;\n"
    "    worst = fmax(worst, fabs(held.charge_C - p.charge_C) / largest[1]);\n  }\n"
    "  const double V = dea_reduced_points[count - 1][1];\n"
    "  const clock_t began = clock();\n"
    "  wrong += dea_reduced_begin(m, 0.3 * V, 0, &s) != DEA_REDUCED_OK;\n"
    "  for (int i = 1; i <= steps; i++) {\n"
    "    wrong += dea_reduced_step(m, &s, 1e-4, V * (0.3 - 0.1 * sin(1e-3 * i)), 0,\n"
    "                              m->mode_count > 0, 0.9, &s) != DEA_REDUCED_OK;\n  }\n"
    "  const double took = (double)(clock() - began) / CLOCKS_PER_SEC;\n"
    "  printf(\"%d points within %.1e, %.3g steps per second, %d failures\\n\", count, worst,\n"
    "         steps / took, wrong);\n"
    "  return worst < 1e-10 && wrong == 0 ? 0 : 1;\n}\n#endif\n";

/* The two files without the includes of each other. */
static void add_core(struct dea_text *out)
{
  const char *line = dea_asset_reduced;
  while (*line != '\0') {
    const char *end = strchr(line, '\n');
    const int length = end != NULL ? (int)(end - line) : (int)strlen(line);
    if (strncmp(line, "#include \"", strlen("#include \"")) != 0 &&
        strncmp(line, "#pragma", strlen("#pragma")) != 0) {
      dea_text_add(out, "%.*s\n", length, line);
    }
    line += length + (end != NULL);
  }
}

static void add_numbers(struct dea_text *out, const char *name, const double *values, size_t count)
{
  dea_text_add(out, "static const double %s[] = {", name);
  for (size_t i = 0; i < count; i++) {
    dea_text_add(out, "%s%.17g", i == 0 ? "" : i % 4 == 0 ? ",\n    " : ", ", values[i]);
  }
  dea_text_add(out, "};\n");
}

static void add_list(struct dea_text *out, const char *name, const double *values, int count)
{
  dea_text_add(out, "    .%s = {", name);
  for (int i = 0; i < count; i++) {
    dea_text_add(out, "%s%.17g", i == 0 ? "" : ", ", values[i]);
  }
  dea_text_add(out, count == 0 ? "0},\n" : "},\n");
}

static void add_device(struct dea_text *out, const struct dea_reduced *core)
{
  const struct dea_reduced_spline *s = &core->energy;
  const size_t terms = DEA_REDUCED_TERMS * DEA_REDUCED_TERMS;
  add_numbers(out, "dea_reduced_force", s->breaks[0], (size_t)s->cells[0] + 1);
  add_numbers(out, "dea_reduced_voltage", s->breaks[1], (size_t)s->cells[1] + 1);
  add_numbers(out, "dea_reduced_energy", s->c, (size_t)(s->cells[0] * s->cells[1]) * terms);
  dea_text_add(out,
               "\nconst struct dea_reduced dea_reduced_device = {\n"
               "    .energy = {{%d, %d}, {dea_reduced_force, dea_reduced_voltage}, "
               "dea_reduced_energy},\n    .even = %d,\n    .middle = %.17g,\n"
               "    .damping = %.17g,\n    .branch_count = %d,\n    .mode_count = %d,\n    "
               ".small_count = %d,\n    .modes = {",
               s->cells[0], s->cells[1], core->even, core->middle, core->damping,
               core->branch_count, core->mode_count, core->small_count);
  for (int i = 0; i < core->small_count; i++) {
    const struct dea_reduced_mode *mode = &core->modes[i];
    dea_text_add(out, "{{%.17g, %.17g, %.17g}, %.17g, %.17g, {%.17g, %.17g, %.17g}}%s",
                 mode->mass[0], mode->mass[1], mode->mass[2], mode->share, mode->voltage_share,
                 mode->by_q[0], mode->by_q[1], mode->by_q[2],
                 i + 1 < core->small_count ? ", " : "");
  }
  dea_text_add(out, core->small_count == 0 ? "{{0}}},\n" : "},\n");
  add_list(out, "strain", core->strain, 3);
  add_list(out, "branch_N_per_m", core->branch_N_per_m, core->branch_count);
  add_list(out, "branch_s", core->branch_s, core->branch_count);
  dea_text_add(out, "};\n\n");
}

/* Force, voltage, q and charge at places that are no breaks. */
static void add_points(struct dea_text *out, const struct dea_reduced_order *o)
{
  dea_text_add(out, "#ifdef DEA_REDUCED_TEST\nstatic const double dea_reduced_points[][4] = {\n");
  for (int i = 0; i < POINTS * POINTS; i++) {
    const double s = (0.5 + i / POINTS) / POINTS, t = (i % POINTS + 1.0) / POINTS; // NOLINT
    struct dea_reduced_point p;
    dea_reduced_at(&o->core, o->force[0] + s * (o->force[1] - o->force[0]), t * o->voltage_V[1],
                   &p);
    dea_text_add(out, "    {%.17g, %.17g, %.17g, %.17g},\n", p.force, p.voltage_V, p.q, p.charge_C);
  }
  dea_text_add(out, "};\n#endif\n\n");
}

dea_status dea_reduced_add_c(const struct dea_reduced_export *e, struct dea_text *out)
{
  const struct dea_reduced_order *order = e->order;
  const bool turns = dea_reduced_order_turns(order);
  dea_text_add(out, head, e->name, DEA_VERSION, order->force[0], order->force[1],
               turns ? "N m" : "N", order->voltage_V[0], order->voltage_V[1], 100 * order->error,
               order->stroke, turns ? "rad" : "m", 100 * order->charge_error);
  add_core(out);
  dea_text_add(out, "\n");
  add_device(out, &order->core);
  add_points(out, order);
  dea_text_add(out, "%s", test);
  return DEA_OK;
}
