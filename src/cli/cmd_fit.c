#include "cli/cli.h"
#include "io/fit_files.h"
#include "job/device_fit_run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// What both have in common ------------------------------------------------------------------------

/* A value with its unit for people: 101.3 um. */
struct shown {
  const char *unit;
  double factor;
};

/* Behind a value: how well it is known, its unit (with a state of the film, or ""), its interval.
 * digits: of the uncertainty. */
static void print_known(const struct dea_fit_value *v, const struct shown *shown, int digits,
                        const char *state, bool logarithmic)
{
  if (v->fixed) {
    printf("    fixed");
  } else if (v->at_bound) {
    printf("    at its bound");
  } else if (isinf(v->std)) {
    printf("    not determined");
  } else {
    printf(" +- %-9.*g", digits, shown->factor * v->std);
  }
  printf(" %s%s", shown->unit, state);
  if (!isnan(v->low)) {
    // of a time that may be as short as can be the lower end is 0
    const bool open = isinf(v->low) || (logarithmic && v->low == 0);
    printf("   (68 %%: ");
    printf(open ? "open" : "%.5g", shown->factor * v->low);
    printf(isinf(v->high) ? " to open)" : " to %.5g)", shown->factor * v->high);
  }
  putchar('\n');
}

static void print_neighbours(double lag, double effective)
{
  if (lag > 0) {
    printf("; neighbours correlate (%.2f): %.1f rows count", lag, effective);
  }
  putchar('\n');
}

/* blamed: "the law or they are wrong" */
static void print_misfit(const struct dea_lsq_statistics *statistics, const char *blamed)
{
  putchar('\n');
  if (statistics->widened) {
    printf("the misfit is %.2g times what the uncertainties explain: %s wrong; error bars are "
           "widened by that\n",
           sqrt(statistics->reduced_chi2), blamed);
  }
}

static void print_weak(const struct dea_fit_core *core)
{
  for (size_t k = 0; k < core->weak_count; k++) {
    printf("%s\n", core->weak[k]);
  }
}

static void print_next(const struct dea_fit_core *core, const char *word)
{
  if (core->next_count > 0) {
    printf("the %s that would tell most: %s (error bars x %.2f)\n", word, core->next[0].what,
           core->next[0].shrink);
  }
}

// A material --------------------------------------------------------------------------------------

static struct shown shown_of_law(const char *unit)
{
  return strcmp(unit, "Pa") == 0 ? (struct shown){"kPa", 1e-3}
                                 : (struct shown){strcmp(unit, "1") == 0 ? "" : unit, 1};
}

/* What a law is chosen by, with its share of the stress, and where it is not stable. */
static void print_candidate(const struct dea_fit_candidate *c, bool scale_known, bool taken)
{
  char share[24] = "> 1000";
  const double off = scale_known ? c->held_out_share : c->held_out;
  if (off < 10) {
    snprintf(share, sizeof share, "%.2f", 100 * off);
  }
  printf("%-18s %10zu %8zu ", c->name, c->free_count, c->branch_count);
  if (scale_known && c->held_out < 1e4) {
    printf("%8.2f std", c->held_out);
  } else if (scale_known) {
    printf("> 10000 std");
  }
  printf("%8s %%%s", share, taken ? "  <- taken" : "");
  if (!isnan(c->unstable_from)) {
    printf("  not stable: %s from %.3g", dea_coupon_mode_names[c->unstable_mode], c->unstable_from);
  }
  putchar('\n');
}

static void print_laws(const struct dea_fit *fit)
{
  if (fit->candidate_count < 2) {
    return;
  }
  printf("%-18s %10s %8s   held-out tests off by\n", "law", "parameters", "branches");
  for (size_t i = 0; i < fit->candidate_count; i++) {
    const struct dea_fit_candidate *c = &fit->candidates[i];
    if (c->failed) {
      printf("%-18s cannot be fitted: %s\n", c->name, c->why);
    } else {
      print_candidate(c, fit->core.scale_known, i == fit->chosen);
    }
  }
  printf(fit->core.scale_known
             ? "(std: times the uncertainty, by which the law is chosen; %%: of the "
               "test's largest stress)\n\n"
             : "(of the largest stress of all tests)\n\n");
}

static void print_law_values(const struct dea_fit *fit)
{
  printf("%s\n", fit->model.law->long_name);
  for (size_t j = 0; j < fit->model.count; j++) {
    const struct dea_fit_param *param = &fit->model.params[j];
    const struct shown shown = shown_of_law(param->unit);
    printf("  %-12s %12.6g", param->name, shown.factor * fit->core.values[j].value);
    print_known(&fit->core.values[j], &shown, 3, "", param->logarithmic);
  }
}

static void print_tests(const struct dea_fit *fit)
{
  static const char *const uses[] = {"fitted", "checked", "foretold"};
  putchar('\n');
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_curve *c = &fit->curves[s];
    printf("%-24s %-9s %5zu rows", c->series->test->name.text, uses[c->series->test->use.value],
           c->series->rows);
    if (!isnan(c->rms_Pa)) {
      printf(", off by %.3g kPa (root mean square), %.1f %% at most", 1e-3 * c->rms_Pa,
             100 * c->largest);
    }
    print_neighbours(c->lag, c->effective);
  }
}

static void print_stability(const struct dea_fit *fit)
{
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    const struct dea_fit_stability *s = &fit->stability[mode];
    if (!isnan(s->unstable_from)) {
      printf("not stable (Drucker) in %s tension from the stretch %.3g on%s\n",
             dea_coupon_mode_names[mode], s->unstable_from, s->measured ? "" : ", not measured");
    }
  }
}

/* What no test holds. */
static void print_spreads(const struct dea_fit *fit)
{
  for (size_t k = 0; k < fit->spread_count; k++) {
    const struct dea_fit_spread *s = &fit->spreads[k];
    printf("no %s test: there %s, which foretells the tests about as well, differs by %.3g %% at "
           "%.3g\n",
           dea_coupon_mode_names[s->mode], s->other, 100 * s->share, s->stretch);
  }
}

static void print_fit(const struct dea_fit *fit)
{
  print_laws(fit);
  print_law_values(fit);
  print_tests(fit);
  print_misfit(&fit->core.statistics, "the law or they are");
  print_weak(&fit->core);
  print_stability(fit);
  print_spreads(fit);
  print_next(&fit->core, "test");
}

// A device ----------------------------------------------------------------------------------------

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
    const struct dea_fit_value *v = &fit->core.values[j];
    const struct shown shown = shown_of(param, v->value);
    printf("%-28s %12.6g -> %10.6g", param->param.name, shown.factor * param->designed,
           shown.factor * v->value);
    print_known(v, &shown, 2, param->state, false);
  }
}

static void print_curves(const struct dea_device_fit *fit)
{
  putchar('\n');
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    const struct dea_column *column = curve->quantity;
    const bool bare = strcmp(column->display_unit, "1") == 0;
    printf("%-20s %-20s %-7s %3zu rows", curve->text->name.text, column->key,
           curve->text->use.value == DEA_FIT_USED ? "fitted" : "checked", curve->rows);
    if (!isnan(curve->rms)) {
      printf(", off by %.3g%s%s (root mean square)", column->factor * curve->rms, bare ? "" : " ",
             bare ? "" : column->display_unit);
    }
    if (!isnan(curve->largest)) { // not where all values are one
      printf(", %.1f %% of the range at most", 100 * curve->largest);
    }
    print_neighbours(curve->lag, curve->effective);
    if (curve->slack > 0) {
      printf("%20s %zu of them, from %.4g kV on, are left out: the model's film is slack there\n",
             "", curve->slack, 1e-3 * curve->slack_from_V);
    }
  }
  if (!fit->settled) {
    puts("Which rows are slack did not settle: the values found would have others left out than "
         "were. Leave\nrows near the loss of tension out, or begin elsewhere (start).");
  }
}

static void print_pairs(const struct dea_device_fit *fit)
{
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
}

static void print_device_fit(const struct dea_device_fit *fit)
{
  print_values(fit);
  print_curves(fit);
  print_misfit(&fit->core.statistics, "the model, what it was not asked to fit, or they are");
  print_weak(&fit->core);
  print_pairs(fit);
  print_next(&fit->core, "measurement");
}

/* A parameter of Weibull's law. */
static void print_weibull(const struct dea_weibull_fit *fit, size_t k, const char *name,
                          const struct shown *shown, bool fixed)
{
  const struct dea_fit_value value = {.value = fit->value[k],
                                      .std = fit->std[k],
                                      .low = fit->low[k],
                                      .high = fit->high[k],
                                      .fixed = fixed};
  printf("  %-20s %10.6g", name, shown->factor * value.value);
  print_known(&value, shown, 3, "", false);
}

/* When so many have failed by Weibull's law. */
static void print_shares(const struct dea_weibull_fit *fit, const char *what,
                         const struct shown *shown)
{
  static const double shares[] = {0.01, 0.1, 0.5};
  putchar('\n');
  for (size_t k = 0; k < sizeof shares / sizeof shares[0]; k++) {
    double std;
    const double at = shown->factor * dea_weibull_quantile(fit, shares[k], &std);
    printf("%4.0f %% %s by %.4g %s (68 %%: %.4g to %.4g)\n", 100 * shares[k], what, at, shown->unit,
           at * exp(-std), at * exp(std));
  }
}

// Breakdown ---------------------------------------------------------------------------------------

static void print_breakdown_fit(const struct dea_breakdown_fit *fit)
{
  static const struct {
    const char *name;
    struct shown shown;
  } rows[DEA_WEIBULL_PARAMS] = {{"at_rest", {"V/um", 1e-6}},
                                {"weibull_shape", {"", 1}},
                                {"exponent", {"", 1}},
                                {"thickness_exponent", {"", 1}}};
  printf("Weibull's law of breakdown: %zu films, of which %zu broke\n"
         "at_rest: the field at which 63.2 %% break of films of %.4g um and %.4g mm^2, ",
         fit->rows, fit->fit.broken, 1e6 * fit->data.thickness0_m, 1e6 * fit->data.area0_m2);
  const double alike = dea_breakdown_fit_stretch(fit);
  if (fabs(alike - 1) < 1e-9) {
    printf("unstretched\n\n");
  } else {
    printf("at the stretch %.4g\n\n", alike);
  }
  for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
    const struct dea_quantity *given =
        k == DEA_WEIBULL_STRETCH ? &fit->file->exponent : &fit->file->thickness_exponent;
    if (fit->data.held[k] && given->origin == DEA_ABSENT) {
      printf("  %-20s    unknown: all films were alike in it, and it was not given\n",
             rows[k].name);
    } else {
      print_weibull(&fit->fit, k, rows[k].name, &rows[k].shown, fit->data.held[k]);
    }
  }
  print_shares(&fit->fit, "of such films break", &rows[0].shown);
}

// Lives -------------------------------------------------------------------------------------------

static void print_lives(const struct dea_life_fit *fit)
{
  printf("  %-20s %-10s", "specimen", "");
  for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
    char title[32];
    snprintf(title, sizeof title, k == DEA_LIFE_CYCLES ? "%s" : "%s (%s)",
             k == DEA_LIFE_UNDER_VOLTAGE ? "under voltage" : dea_life_clock_names[k],
             dea_life_clock_units[k]);
    printf(" %*s", k == DEA_LIFE_UNDER_VOLTAGE ? 17 : 12, title);
  }
  printf(" %10s\n", "stroke");
  for (size_t i = 0; i < fit->rows; i++) {
    const struct dea_life *life = &fit->lives[i];
    printf("  %-20.20s %-10s", fit->file->specimens[i].name.text, dea_life_end_names[life->end]);
    for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
      const int width = k == DEA_LIFE_UNDER_VOLTAGE ? 17 : 12;
      if (isnan(life->clock[k])) {
        printf(" %*s", width, "-");
      } else {
        printf(" %*.6g", width, dea_life_clock_factors[k] * life->clock[k]);
      }
    }
    if (isnan(life->last_stroke) || isnan(life->first_stroke)) {
      printf(" %10s\n", "-");
    } else {
      printf(" %8.1f %%\n", 100 * fabs(life->last_stroke) / life->first_stroke);
    }
  }
}

static void print_life_law(const struct dea_life_fit *fit)
{
  static const char *const names[2] = {"scale", "shape"};
  const int clock = fit->file->clock.value;
  const struct shown shown[2] = {{dea_life_clock_units[clock], dea_life_clock_factors[clock]},
                                 {"", 1}};
  printf("\nWeibull's law of the life in %s; scale: by when 63.2 %% have failed\n\n",
         dea_life_clock_units[clock]);
  for (size_t k = 0; k < 2; k++) {
    print_weibull(&fit->fit, k, names[k], &shown[k], false);
  }
  print_shares(&fit->fit, "fail", &shown[0]);
}

static void print_life_fit(const struct dea_life_fit *fit)
{
  printf("Life tests: %zu specimens, of which %zu failed\n\n", fit->rows, fit->failed);
  print_lives(fit);
  if (fit->has_law) {
    print_life_law(fit);
    return;
  }
  double life;
  const double bound = dea_life_fit_bound(fit, &life);
  const int clock = fit->file->clock.value;
  printf("\nno law: two failures at different lives are needed\n");
  if (!isnan(bound)) {
    printf("with 95 %% certainty less than %.3g %% fail by %.6g %s\n", 100 * bound,
           dea_life_clock_factors[clock] * life, dea_life_clock_units[clock]);
  }
}

struct request {
  const char *file, *output;
  bool json, force, profile;
  struct dea_plot_format format;
};

/* fit_KIND: reads a file of a kind, fits (`run`: file into &fit), writes the folder and prints what
 * there is. */
#define FIT_KIND(kind, form, its_fit, run)                                                         \
  static dea_status fit_##kind(struct dea_cli *cli, const struct request *request)                 \
  {                                                                                                \
    struct dea_context *ctx = cli->ctx;                                                            \
    const struct dea_fit_folder to = {request->output, request->force, cli->command_line,          \
                                      &request->format};                                           \
    void *file;                                                                                    \
    struct dea_##its_fit fit = {0};                                                                \
    dea_status status = dea_fit_head_read(ctx, request->file, &form, &file);                       \
    status = status == DEA_OK ? run : status;                                                      \
    const bool fitted = status == DEA_OK;                                                          \
    status = fitted ? dea_##its_fit##_write(ctx, &fit, &to) : status;                              \
    cli_progress_clear(cli);                                                                       \
    if (fitted && request->json) {                                                                 \
      cli_print_json(dea_##its_fit##_json(&fit, cli->command_line));                               \
    } else if (fitted) {                                                                           \
      print_##its_fit(&fit);                                                                       \
      if (status == DEA_OK) {                                                                      \
        printf("\nwritten to %s\n", request->output);                                              \
      }                                                                                            \
    }                                                                                              \
    dea_##its_fit##_free(&fit);                                                                    \
    dea_fit_head_destroy(ctx, file);                                                               \
    return status;                                                                                 \
  }
FIT_KIND(material, dea_fit_form, fit, dea_fit_file_run(ctx, file, request->profile, &fit))
FIT_KIND(device, dea_device_form, device_fit, dea_device_fit_run(ctx, file, request->profile, &fit))
FIT_KIND(breakdown, dea_breakdown_form, breakdown_fit, dea_breakdown_fit_run(ctx, file, &fit))
FIT_KIND(life, dea_life_form, life_fit, dea_life_fit_run(ctx, file, &fit))

/* Kinds of fit files other than that of a material, by the key that tells them. */
static const struct {
  const char *key;
  dea_status (*fit)(struct dea_cli *cli, const struct request *request);
} kinds[] = {{"design", fit_device}, {"breakdown", fit_breakdown}, {"life", fit_life}};

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  DEA_TRY(cli->ctx, cli_output_name(cli, request->file, "fit", &request->output));
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    bool has;
    DEA_TRY(cli->ctx, dea_fit_file_has(cli->ctx, request->file, kinds[k].key, &has));
    if (has) {
      return kinds[k].fit(cli, request);
    }
  }
  return fit_material(cli, request);
}

static const struct request defaults = {.format = {.svg = true, .width_m = 85e-3}};

static const struct cli_option options[] = {
    CLI_ONE(CLI_DESIGN, "FIT", "fit file", file, "a fit file is needed", "one fit file at a time"),
    {"profile", 0, CLI_FLAG, NULL,
     "profile likelihood of every parameter, not only where the normal form is poor",
     CLI_AT(profile)},
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "write into DIR (default: the file's name + .fit)"),
    CLI_FORCE_ROW('f', "replace an earlier fit in that folder"),
    CLI_FORMAT_ROW("formats of the figures with commas between, svg if not given"),
    CLI_WIDTH_ROW("width of the figures (default 85)"),
    CLI_JSON_ROW("print fit.json in place of the tables"),
    {0}};

const struct dea_command cmd_fit = {
    .name = "fit",
    .summary = "Fit a material or a device to measurements, with error bars and what they cannot "
               "tell",
    .about = "Writes the material, or the design of the device as it was built, as NAME.yaml, "
             "fit.csv (measurements, model, band), fit.json and figures. What a fit file holds "
             "says 'dea schema --fit', that of a device (with the key design) 'dea schema "
             "--fit-device', of breakdown tests (with the key breakdown) 'dea schema "
             "--fit-breakdown', of life tests (with the key life) 'dea schema --fit-life'.",
    .defaults = &defaults,
    CLI_RUN};
