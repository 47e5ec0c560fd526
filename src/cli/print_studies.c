#include "cli/print_studies.h"

#include "output/csv.h"
#include "result/convergence.h"

#include <math.h>
#include <stdio.h>

static void print_meshes(const struct dea_convergence *c)
{
  printf("%-18s%10s%10s%10s%10s\n", "mesh", "elements", "nodes", "unknowns", "time (s)");
  for (size_t m = 0; m < c->mesh_count; m++) {
    const struct dea_variant *mesh = c->meshes[m];
    printf("%-18s%10zu%10zu%10zu%10.2f%s%s\n", mesh->name, mesh->size.elements, mesh->size.nodes,
           mesh->size.unknowns, mesh->wall_s,
           mesh->curve.complete ? "" : "  stopped: ", mesh->curve.stopped);
  }
}

static void print_value(double value, int width, int digits)
{
  if (isnan(value)) {
    printf("%*s", width, "-");
  } else {
    printf("%*.*g", width, digits, value);
  }
}

static void print_errors(const struct dea_convergence *c)
{
  printf("\n%8s  %-24s", "V (kV)", "estimated error (%) at");
  for (size_t m = 0; m < c->mesh_count; m++) {
    print_value(c->meshes[m]->refinement, 8, 4);
  }
  printf("%8s%14s\n", "order", "extrapolated");
  for (size_t i = 0; i < c->row_count; i++) {
    const struct dea_convergence_row *row = &c->rows[i];
    const struct dea_column *column = &dea_point_columns[row->column];
    char title[96];
    dea_column_title(column, title, sizeof title);
    printf("%8.4g  %-24s", 1e-3 * row->voltage_V, title);
    for (size_t m = 0; m < c->mesh_count; m++) {
      print_value(100 * row->errors[m], 8, 2);
    }
    print_value(row->order, 8, 2);
    print_value(column->factor * row->extrapolated, 14, 5);
    const char *remark = dea_order_text(row->kind);
    printf("%s%s\n", remark[0] != '\0' ? "  " : "", remark);
  }
}

dea_status cli_print_convergence(struct dea_context *ctx, const struct dea_result *result,
                                 const char *model)
{
  struct dea_convergence *convergence;
  DEA_TRY(ctx, dea_convergence_create(ctx, result, model, &convergence));
  if (convergence == NULL) {
    return DEA_OK;
  }
  struct dea_text verdict = {.ctx = ctx};
  dea_convergence_verdict(convergence, &verdict);
  printf("\n%s: convergence\n", model);
  print_meshes(convergence);
  print_errors(convergence);
  printf("\n%s", dea_text_get(&verdict));
  dea_status status = verdict.failed ? DEA_E_MEMORY : DEA_OK;
  dea_text_free(&verdict);
  dea_convergence_destroy(ctx, convergence);
  return status;
}

/* In um; what is only noise is 0. */
static void print_displacement(double z_m)
{
  print_value(fabs(z_m) < 1e-12 ? 0 : 1e6 * z_m, 12, 5);
}

void cli_print_designs(const struct dea_result *result, const char *model)
{
  bool any = false;
  for (size_t i = 0; i < result->variant_count; i++) {
    const struct dea_variant *variant = &result->variants[i];
    if (!dea_variant_is(variant, model, "compare-design")) {
      continue;
    }
    if (!any) {
      printf("\n%s: designs at their last voltage\n%-32s%9s%10s%12s%12s%12s\n", model, "", "V (kV)",
             "strain %", "z centre um", "z tip um", "field V/um");
      any = true;
    }
    printf("%-32s", variant->name);
    if (variant->curve.count > 0) {
      const struct dea_load_point *p = &variant->curve.points[variant->curve.count - 1];
      print_value(1e-3 * p->voltage_V, 9, 4);
      print_value(100 * (p->electrode_stretch - 1), 10, 4);
      print_displacement(p->centre_z_m);
      print_displacement(p->fibre_tip_z_m);
      print_value(1e-6 * p->true_field_V_per_m, 12, 5);
    }
    printf("%s%s\n", variant->curve.complete ? "" : "  stopped: ", variant->curve.stopped);
  }
}
