/* What `dea fit` prints of a device. */
#include "cli/print_device_fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A value with its unit for people: 101.3 um. */
struct shown {
  const char *unit;
  double factor;
};

static struct shown shown_of(const struct dea_device_param *param, double value)
{
  const char *unit = param->param.unit;
  if (strcmp(unit, "m") == 0) {
    return fabs(value) < 1e-3 ? (struct shown){"um", 1e6} : (struct shown){"mm", 1e3};
  }
  if (strcmp(unit, "Pa") == 0) {
    return fabs(value) < 1e7 ? (struct shown){"kPa", 1e-3} : (struct shown){"MPa", 1e-6};
  }
  return (struct shown){strcmp(unit, "1") == 0 ? "" : unit, 1};
}

static void print_values(const struct dea_device_fit *fit)
{
  printf("%-28s %12s    %s\n", "", "as designed", "as built");
  for (size_t j = 0; j < fit->param_count; j++) {
    const struct dea_device_param *param = &fit->params[j];
    const struct dea_fit_value *v = &fit->values[j];
    const struct shown shown = shown_of(param, v->value);
    printf("%-28s %12.6g -> %10.6g", param->param.name, shown.factor * param->designed,
           shown.factor * v->value);
    if (v->fixed) {
      printf(" fixed");
    } else if (v->at_bound) {
      printf(" at its bound");
    } else if (isinf(v->std)) {
      printf(" not determined");
    } else {
      printf(" +- %-8.2g", shown.factor * v->std);
    }
    printf(" %s%s", shown.unit, param->state);
    if (!isnan(v->low)) {
      printf("   (68 %%: ");
      printf(isinf(v->low) ? "open" : "%.5g", shown.factor * v->low);
      printf(isinf(v->high) ? " to open)" : " to %.5g)", shown.factor * v->high);
    }
    putchar('\n');
  }
}

static void print_curves(const struct dea_device_fit *fit)
{
  putchar('\n');
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    const struct dea_column *column = &dea_point_columns[curve->column];
    const bool bare = strcmp(column->display_unit, "1") == 0;
    printf("%-20s %-20s %-7s %3zu rows", curve->text->name.text, column->key,
           curve->text->use.value == DEA_FIT_USED ? "fitted" : "checked", curve->rows);
    if (!isnan(curve->rms)) {
      printf(", off by %.3g%s%s (root mean square), %.1f %% of the range at most",
             column->factor * curve->rms, bare ? "" : " ", bare ? "" : column->display_unit,
             100 * curve->largest);
    }
    if (curve->lag > 0) {
      printf("; neighbours correlate (%.2f): %.1f rows count", curve->lag, curve->effective);
    }
    putchar('\n');
    if (curve->slack > 0) {
      printf("%20s %zu of them, from %.4g kV on, are left out: the model's film is slack there\n",
             "", curve->slack, 1e-3 * curve->slack_from_V);
    }
  }
}

static void print_derived(const struct dea_device_fit *fit)
{
  for (size_t k = 0; k < fit->derived_count; k++) {
    const struct dea_device_derived *d = &fit->derived[k];
    const struct dea_column *column = &dea_point_columns[d->column];
    if (k == 0) {
      printf("\nAt %.4g kV, the highest that was fitted:\n", 1e-3 * d->voltage_V);
    }
    printf("  %-20s %10.4g +- %-8.2g %s", column->header, column->factor * d->value,
           column->factor * d->std, column->display_unit);
    if (!isnan(d->designed)) {
      printf("   (as designed %.4g)", column->factor * d->designed);
    }
    putchar('\n');
  }
}

static void print_advice(const struct dea_device_fit *fit)
{
  putchar('\n');
  if (fit->statistics.widened) {
    printf("the misfit is %.2g times what the uncertainties explain: the model, what it was not "
           "asked to fit, or they are wrong; error bars are widened by that\n",
           sqrt(fit->statistics.reduced_chi2));
  }
  for (size_t k = 0; k < fit->weak_count; k++) {
    printf("%s\n", fit->weak[k]);
  }
  for (size_t k = 0; k < fit->pair_count; k++) {
    const struct dea_device_pair *pair = &fit->pairs[k];
    printf("%s and %s %s told apart", fit->params[pair->first].param.name,
           fit->params[pair->second].param.name,
           fabs(pair->correlation) < 0.999 ? "are hardly" : "cannot be");
    if (!isnan(pair->correlation)) {
      printf(" (correlation %.3f)", pair->correlation);
    }
    printf("%s%s\n", pair->next[0] != '\0' ? "; this would tell: " : "", pair->next);
  }
  if (fit->next_count > 0) {
    printf("the measurement that would tell most: %s (error bars x %.2f)\n", fit->next[0].what,
           fit->next[0].shrink);
  }
}

void cli_print_device_fit(const struct dea_device_fit *fit)
{
  print_values(fit);
  print_curves(fit);
  print_derived(fit);
  print_advice(fit);
}
