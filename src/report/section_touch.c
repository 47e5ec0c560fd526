/* Is it fit for the finger: displacement and force against thresholds of touch (paper section 5.2).
 *
 * Reaches are quasi-static; study "frequency" says what is left of a motion at 5 to 10 Hz. */
#include "report/section.h"

#include <math.h>
#include <string.h>

static const struct threshold {
  const char *what, *source;
  bool force;
  double least; // m or N
} thresholds[] = {
    {"felt at the tip of the thumb", "paper section 5.2, its reference 31", false, 30e-6},
    {"felt at the fingertip, at 5 to 10 Hz", "paper section 5.2, its reference 32", true, 10e-3},
    {"device made for touch: displacement", "paper section 5.2, its reference 33", false, 450e-6},
    {"device made for touch: force", "paper section 5.2, its reference 33", true, 14e-3},
};
enum { THRESHOLDS = sizeof thresholds / sizeof thresholds[0] };

/* What a model reaches; NAN: it does not say. */
struct reach {
  const char *model;
  double displacement_m, displacement_V, force_N, force_V;
  const char *how;                        // the force was found
  bool bound;                             // both are upper bounds
  bool displacement_broken, force_broken; // beyond the film's breakdown field
};

/* Largest displacement of the centre, where the finger lies, over points to be
 * trusted. */
static void find_displacement(const struct dea_curve *sweep, struct reach *out)
{
  for (size_t i = 0; i < sweep->count; i++) {
    const struct dea_load_point *p = &sweep->points[i];
    if (dea_load_point_valid(p) && isfinite(p->centre_z_m) &&
        !(fabs(p->centre_z_m - sweep->points[0].centre_z_m) <= out->displacement_m)) {
      out->displacement_m = fabs(p->centre_z_m - sweep->points[0].centre_z_m);
      out->displacement_V = p->voltage_V;
      out->displacement_broken = p->breakdown_margin < 0;
    }
  }
}

/* Largest force of the sweep; of study force the largest change at a depth that is held. */
static void find_force(const struct dea_result *result, struct reach *out)
{
  const struct dea_curve *sweep = dea_result_find(result, out->model, "sweep");
  const struct dea_curve *held = dea_result_find(result, out->model, "force");
  for (size_t i = 0; held != NULL && i < held->count; i++) {
    for (size_t k = 0; k < i; k++) {
      const struct dea_load_point *a = &held->points[k], *b = &held->points[i];
      double change = fabs(b->force_N - a->force_N);
      if (a->voltage_V == 0 && dea_load_point_valid(b) &&
          fabs(a->tip_depth_m - b->tip_depth_m) < 1e-9 && !(change <= out->force_N)) {
        out->force_N = change;
        out->force_V = b->voltage_V;
        out->force_broken = b->breakdown_margin < 0;
        out->how = "change of the force on a tip that is held";
      }
    }
  }
  for (size_t i = 0; held == NULL && sweep != NULL && i < sweep->count; i++) {
    if (dea_load_point_valid(&sweep->points[i]) && !(sweep->points[i].force_N <= out->force_N) &&
        isfinite(sweep->points[i].force_N)) {
      out->force_N = sweep->points[i].force_N;
      out->force_V = sweep->points[i].voltage_V;
      out->force_broken = sweep->points[i].breakdown_margin < 0;
      out->how = "largest of the load line";
    }
  }
}

static void add_row(struct dea_text *out, const struct threshold *t, const struct reach *r)
{
  double has = t->force ? r->force_N : r->displacement_m, factor = t->force ? 1e3 : 1e6;
  const char *unit = t->force ? "mN" : "\302\265m";
  if (!isfinite(has)) {
    return;
  }
  bool enough = has >= t->least, broken = t->force ? r->force_broken : r->displacement_broken;
  dea_html_add(out,
               "<tr><th scope=\"row\">%s</th><td class=\"n\">%g %s</td><td>%s</td>"
               "<td class=\"n\">%.3G %s</td><td class=\"n\">%.4G kV</td><td class=\"n\">%.3G</td>"
               "<td class=\"%s\">%s%s</td><td>%s%s%s</td></tr>",
               t->what, factor * t->least, unit, r->model, factor * has, unit,
               1e-3 * (t->force ? r->force_V : r->displacement_V), has / t->least,
               !enough              ? "bad"
               : r->bound || broken ? ""
                                    : "good",
               !enough    ? "below"
               : r->bound ? "not known: an upper bound, which model 3d replaces"
                          : "above",
               enough && !r->bound && broken ? ", but beyond the breakdown field" : "", t->source,
               t->force ? "; " : "", t->force ? r->how : "");
}

// Frequency ---------------------------------------------------------------------------------------

static const double touch_Hz = 10; // the faster end of what the thresholds speak of

/* Points [first, end) of one bias, rising in frequency: amplitude of the centre at touch_Hz over
 * that at the lowest frequency, straight between the points; NAN outside them. */
static double left_at_touch(const struct dea_load_point *points, size_t first, size_t end)
{
  for (size_t i = first; i + 1 < end; i++) {
    const struct dea_load_point *a = &points[i], *b = &points[i + 1];
    if (a->frequency_Hz <= touch_Hz && touch_Hz <= b->frequency_Hz) {
      double share = (touch_Hz - a->frequency_Hz) / (b->frequency_Hz - a->frequency_Hz);
      return (a->centre_amplitude_m + share * (b->centre_amplitude_m - a->centre_amplitude_m)) /
             points[first].centre_amplitude_m;
    }
  }
  return NAN;
}

/* A sentence for each bias of study frequency whose points reach touch_Hz; returns their number. */
static size_t add_frequency(struct dea_text *out, const struct dea_result *result,
                            const char *model)
{
  const struct dea_curve *curve = dea_result_find(result, model, "frequency");
  size_t said = 0;
  for (size_t first = 0, end = 0; curve != NULL && first < curve->count; first = end) {
    const struct dea_load_point *points = curve->points;
    end = first + 1;
    while (end < curve->count && points[end].voltage_V == points[first].voltage_V &&
           points[end].frequency_Hz > points[end - 1].frequency_Hz) {
      end++;
    }
    double left = left_at_touch(points, first, end);
    if (isfinite(left)) {
      dea_html_add(
          out, "%s about %.3G kV the centre follows at 10 Hz by %.4G times its motion at %.2G Hz",
          said++ > 0 ? ";" : " Of a small AC excitation of the voltage",
          1e-3 * points[first].voltage_V, left, points[first].frequency_Hz);
    }
  }
  if (said > 0) {
    dea_html_add(out, " (study frequency of model %s).", model);
  }
  return said;
}

static void add_introduction(struct dea_text *out, const struct dea_result *result,
                             const char *const models[], size_t count)
{
  size_t said = 0;
  dea_text_add(out, "<p>Displacement of the centre and force, against thresholds of touch. "
                    "<strong>Quasi-static</strong>.");
  for (size_t m = 0; m < count; m++) {
    said += add_frequency(out, result, models[m]);
  }
  dea_text_add(out, "%s</p>",
               said > 0 ? ""
                        : " The run says nothing of 5 to 10 Hz, where viscosity takes some of both "
                          "(study frequency does).");
}

dea_status dea_section_touch(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  struct reach reaches[DEA_DESIGN_MODELS_MAX];
  bool any = false, predicted = false;
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *sweep = dea_result_find(result, models[m], "sweep");
    reaches[m] = (struct reach){.model = models[m],
                                .displacement_m = NAN,
                                .displacement_V = NAN,
                                .force_N = NAN,
                                .force_V = NAN,
                                .how = "",
                                .bound = strcmp(models[m], "lumped") == 0};
    if (sweep != NULL) {
      find_displacement(sweep, &reaches[m]);
    }
    find_force(result, &reaches[m]);
    if (strcmp(models[m], "reduced") == 0 && run->reduced != NULL && isfinite(run->blocked_N)) {
      reaches[m].force_N = run->blocked_N;
      reaches[m].force_V = run->blocked_V;
      reaches[m].how = "blocked force, held where it is at 0 V";
    }
    const bool says = isfinite(reaches[m].displacement_m) || isfinite(reaches[m].force_N);
    any = any || says;
    predicted = predicted || (says && !reaches[m].bound);
  }
  if (!any) {
    return DEA_OK;
  }
  dea_section_begin(report, "touch", run->number, "Touch: can a finger feel it?");
  add_introduction(&report->text, result, models, count);
  dea_table_begin(report, "Thresholds of touch and what this actuator reaches");
  dea_table_head(report, "Threshold|#Needed|Model|#Reached|#at|#Ratio|Verdict|Source; how");
  for (size_t t = 0; t < THRESHOLDS; t++) {
    for (size_t m = 0; m < count; m++) {
      if (!predicted || !reaches[m].bound) {
        add_row(&report->text, &thresholds[t], &reaches[m]);
      }
    }
  }
  dea_table_end(report);
  dea_section_end(report);
  return DEA_OK;
}
