/* Numbers of a run: what matters at a glance, limits, all points. */
#include "io/csv.h"
#include "report/section.h"
#include "result/figure.h"
#include "result/observation.h"
#include "result/trust.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a number at a glance is known by: its digits, or the error that says how many there are. */
enum { DIGITS_FIRM = 3, DIGITS_DOUBTED = 2 };
enum { HEADLINES_MAX = 8 };

/* error: estimated one, NAN: none is. */
static void add_card_with(struct dea_text *out, const char *what, double value, double error,
                          const char *unit, int digits)
{
  if (isfinite(value)) {
    dea_html_add(out, "<div class=\"card\"><dt>%s</dt><dd>", what);
    dea_html_estimate(out, value, error, digits);
    dea_html_add(out, " <span class=\"unit\">%s</span></dd></div>", unit);
  }
}

static void add_card(struct dea_text *out, const char *what, double value, const char *unit,
                     int digits)
{
  add_card_with(out, what, value, NAN, unit, digits);
}

static void add_event(struct dea_text *out, const struct dea_curve *path, enum dea_event_kind kind,
                      const char *what)
{
  const struct dea_event *event = dea_curve_first_event(path, kind);
  add_card(out, what, event != NULL ? 1e-3 * event->point.voltage_V : NAN, "kV", DIGITS_FIRM);
}

/* What the monitors of a device show. */
static void add_headlines(struct dea_report *report, const struct dea_curve *sweep,
                          const struct dea_load_point *p, int digits)
{
  int columns[HEADLINES_MAX];
  const size_t count = dea_curve_headlines(report->ctx, sweep, columns, HEADLINES_MAX);
  for (size_t i = 0; i < count; i++) {
    const struct dea_column *c = dea_column_at(report->ctx, columns[i]);
    const int error = dea_point_error_column(report->ctx, columns[i]);
    char unit[DEA_COLUMN_UNIT_SIZE];
    dea_figure_unit(c->display_unit, unit);
    add_card_with(&report->text, c->header, c->factor * dea_point_get(p, columns[i]),
                  error >= 0 ? c->factor * dea_point_get(p, error) : NAN,
                  strcmp(unit, "1") == 0 ? "" : unit, digits);
  }
}

/* Cards of one point of a sweep. heading: what it is. */
static void add_cards(struct dea_report *report, const struct dea_result *result,
                      const struct dea_curve *sweep, const struct dea_load_point *p,
                      const char *heading)
{
  struct dea_text *out = &report->text;
  const bool bound = dea_load_point_bounds(p);
  const bool z = !dea_figure_leaves_out(result, sweep, dea_point_column_find("fibre_tip_z_m"));
  int digits = dea_load_point_valid(p) ? DIGITS_FIRM : DIGITS_DOUBTED;
  dea_section_heading(report, heading);
  dea_text_add(out, "<dl class=\"cards\">");
  add_headlines(report, sweep, p, digits);
  add_card(out, "electrode strain", 100 * (p->electrode_stretch - 1), "%", digits);
  add_card_with(out, bound ? "centre, at most" : "centre", z ? 1e6 * p->centre_z_m : NAN,
                1e6 * p->centre_z_error_m, "\302\265m", digits);
  add_card_with(out, bound ? "fibre tip, at most" : "fibre tip", z ? 1e6 * p->fibre_tip_z_m : NAN,
                1e6 * p->fibre_tip_z_error_m, "\302\265m", digits);
  add_card(out, bound ? "force, at most" : "force", z ? 1e3 * p->force_N : NAN, "mN", digits);
  add_card(out, "true field", 1e-6 * p->true_field_V_per_m, "V/\302\265m", digits);
  add_card(out, "breakdown margin", 100 * p->breakdown_margin, "%", DIGITS_DOUBTED);
  add_card(out, "breakdown probability, at most", 100 * p->breakdown_probability, "%",
           DIGITS_DOUBTED);
  dea_text_add(out, "</dl>");
}

/* Cards of a sweep at one of its voltages, NAN for none. what: it is, before words of flags. */
static void add_cards_at(struct dea_report *report, const struct dea_result *result,
                         const struct dea_curve *sweep, double voltage_V, const char *what,
                         unsigned flags)
{
  const struct dea_load_point *p = NULL;
  for (size_t i = 0; i < sweep->count; i++) {
    p = sweep->points[i].voltage_V == voltage_V ? &sweep->points[i] : p;
  }
  if (p != NULL) {
    char heading[3 * DEA_NAME_SIZE], words[DEA_FLAGS_SIZE];
    snprintf(heading, sizeof heading, "Model %s at %.4g kV%s%s", sweep->model, 1e-3 * p->voltage_V,
             what, dea_flags_text(flags, words));
    add_cards(report, result, sweep, p, heading);
  }
}

/* How far one model's sweep is to be trusted, and its cards: at the largest voltage that is to be
 * trusted and safe, at the largest that is to be trusted, at the last. */
static void add_glance(struct dea_report *report, const struct dea_result *result,
                       const struct dea_curve *sweep)
{
  struct dea_text *out = &report->text, text = {.ctx = report->ctx};
  struct dea_trust trust = dea_curve_trust(sweep);
  const struct dea_curve *path = dea_result_find(result, sweep->model, "path");
  double last_V = sweep->points[sweep->count - 1].voltage_V;
  dea_trust_text(&trust, &text);
  dea_html_add(out, "<p class=\"%s\"><strong>Model %s</strong>: %s.</p>",
               trust.doubts != 0 || trust.dangers != 0 ? "warning" : "verdict", sweep->model,
               dea_text_get(&text));
  dea_text_free_in(&text, out);
  add_cards_at(report, result, sweep, trust.good_V,
               ", the largest voltage that is valid and below breakdown", 0);
  if (trust.trusted_V > trust.good_V || isnan(trust.good_V)) {
    add_cards_at(report, result, sweep, trust.trusted_V,
                 ", the largest voltage to be trusted, but ", trust.dangers);
  }
  if (!(last_V <= trust.trusted_V)) {
    add_cards_at(report, result, sweep, last_V,
                 ", not to be trusted: ", dea_result_doubts(result, sweep->model, last_V));
  }
  dea_text_add(out, "<dl class=\"cards\">");
  add_event(out, path, DEA_EVENT_SLACK, "slack from");
  add_event(out, path, DEA_EVENT_BREAKDOWN, "breakdown at");
  add_event(out, path, DEA_EVENT_PULL_IN, "pull-in at");
  dea_text_add(out, "</dl>");
}

dea_status dea_section_glance(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  dea_section_begin(report, "glance", run->number, "At a glance");
  for (size_t i = 0; i < 2 * result->curve_count; i++) { // bounds after predictions
    const struct dea_curve *curve = &result->curves[i % result->curve_count];
    const bool bounds = curve->count > 0 && dea_load_point_bounds(&curve->points[0]);
    if (bounds != (i >= result->curve_count)) {
      continue;
    }
    if (strcmp(curve->kind, "sweep") == 0 && curve->count > 0) {
      add_glance(report, result, curve);
    }
    if (!curve->complete) {
      dea_html_add(&report->text, "<p class=\"warning\">Model %s, %s, was stopped: %s</p>",
                   curve->model, curve->kind, curve->stopped);
    }
  }
  if (run->note_count > 0) {
    dea_section_heading(report, "What the run says of itself");
    dea_text_add(&report->text, "<ul class=\"notes\">");
    for (size_t i = 0; i < run->note_count; i++) {
      dea_html_element(&report->text, "li", run->notes[i]);
    }
    dea_text_add(&report->text, "</ul>");
  }
  dea_section_end(report);
  return DEA_OK;
}

/* A limit's row: where it is, and how far the sweep stays below it. */
static void add_limit(struct dea_text *out, const char *model, const char *what,
                      const struct dea_event *event, double last_V)
{
  double at_V = event->point.voltage_V;
  dea_html_add(out,
               "<tr><th scope=\"row\">%s</th><td>%s</td><td class=\"n\">%.5G</td>"
               "<td class=\"n\">%.5G</td><td class=\"n\">%.4G</td><td class=\"%s\">%s</td></tr>",
               model, what, 1e-3 * at_V, event->point.electrode_stretch, 1e-3 * (at_V - last_V),
               last_V < at_V ? "good" : "bad",
               last_V < at_V ? "the sweep stays below" : "the sweep goes beyond");
}

static const struct {
  enum dea_event_kind kind;
  const char *what;
} limits[] = {{DEA_EVENT_SLACK, "first loss of tension"},
              {DEA_EVENT_BREAKDOWN, "breakdown"},
              {DEA_EVENT_PULL_IN, "pull-in"},
              {DEA_EVENT_SNAP_BACK, "snap-back"}};
enum { LIMITS = sizeof limits / sizeof limits[0] };

/* What a path was followed for and did not meet. Of a model without a path that is not known. */
static void add_unmet(struct dea_text *out, const struct dea_curve *path)
{
  const char *join = "";
  for (size_t k = 0; k < LIMITS; k++) {
    if (limits[k].kind != DEA_EVENT_SNAP_BACK &&
        dea_curve_first_event(path, limits[k].kind) == NULL) {
      dea_text_add(out, "%s%s", *join != '\0' ? join : "; on its path no ", limits[k].what);
      join = ", no ";
    }
  }
}

/* What the sweep itself says of stability: models without a path have nothing else. */
static void add_worst(struct dea_text *out, const struct dea_curve *sweep,
                      const struct dea_curve *path)
{
  double margin = INFINITY, tension = INFINITY, margin_V = NAN, tension_V = NAN;
  size_t unstable = 0;
  for (size_t i = 0; i < sweep->count; i++) {
    const struct dea_load_point *p = &sweep->points[i];
    unstable += !p->stable;
    if (p->breakdown_margin < margin) {
      margin = p->breakdown_margin;
      margin_V = p->voltage_V;
    }
    if (p->min_tension_N_per_m < tension) {
      tension = p->min_tension_N_per_m;
      tension_V = p->voltage_V;
    }
  }
  dea_html_add(out, "<li>Model %s: ", sweep->model);
  dea_text_add(out, unstable == 0 ? "all %zu points of the sweep are stable" : "of %zu points",
               sweep->count);
  if (unstable > 0) {
    dea_text_add(out, " %zu are unstable", unstable);
  }
  if (isfinite(margin)) {
    dea_html_add(out, "; smallest breakdown margin %.3G %% at %.4G kV", 100 * margin,
                 1e-3 * margin_V);
  }
  if (isfinite(tension)) {
    dea_html_add(out, "; smallest tension %.3G N/m at %.4G kV%s", tension, 1e-3 * tension_V,
                 tension < 0 ? ": a part of the film is slack there" : "");
  }
  if (path != NULL && path->count > 0) {
    add_unmet(out, path);
  }
  dea_text_add(out, ".</li>");
}

/* The first limit of a kind of a model: on its path, or of one without a path the first point of
 * the sweep that is beyond it. Whether *out is set. */
static bool find_limit(const struct dea_curve *path, const struct dea_curve *sweep,
                       enum dea_event_kind kind, struct dea_event *out)
{
  const struct dea_event *event = dea_curve_first_event(path != NULL ? path : sweep, kind);
  if (event != NULL) {
    *out = *event;
    return true;
  }
  for (size_t i = 0; path == NULL && i < sweep->count; i++) {
    const struct dea_load_point *p = &sweep->points[i];
    if (kind == DEA_EVENT_SLACK       ? p->min_tension_N_per_m < 0
        : kind == DEA_EVENT_BREAKDOWN ? !dea_load_point_safe(p)
                                      : false) {
      *out = (struct dea_event){.kind = kind, .point = *p};
      return true;
    }
  }
  return false;
}

/* Rows of a model. */
static void add_model_limits(struct dea_text *out, const struct dea_result *result,
                             const char *model)
{
  const struct dea_curve *path = dea_result_find(result, model, "path");
  const struct dea_curve *sweep = dea_result_find(result, model, "sweep");
  double last_V =
      sweep != NULL && sweep->count > 0 ? sweep->points[sweep->count - 1].voltage_V : NAN;
  for (size_t k = 0; k < LIMITS; k++) {
    struct dea_event event;
    if (find_limit(path, sweep, limits[k].kind, &event)) {
      add_limit(out, model, limits[k].what, &event, last_V);
    }
  }
}

/* Whether a curve is the one that rows of its model come from: the path, or without one a sweep
 * that met a limit. */
static bool has_limits(const struct dea_result *result, const struct dea_curve *curve)
{
  struct dea_event event;
  bool path = strcmp(curve->kind, "path") == 0, sweep = strcmp(curve->kind, "sweep") == 0;
  bool alone = sweep && dea_result_find(result, curve->model, "path") == NULL;
  return curve->count > 0 &&
         (path || (alone && (find_limit(NULL, curve, DEA_EVENT_SLACK, &event) ||
                             find_limit(NULL, curve, DEA_EVENT_BREAKDOWN, &event) ||
                             find_limit(NULL, curve, DEA_EVENT_PULL_IN, &event))));
}

dea_status dea_section_limits(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  struct dea_text *out = &report->text;
  if (result->curve_count == 0) {
    return DEA_OK;
  }
  bool any = false;
  dea_section_begin(report, "limits", run->number, "Stability and limits");
  for (size_t c = 0; c < result->curve_count; c++) {
    const struct dea_curve *curve = &result->curves[c];
    if (!has_limits(result, curve)) {
      continue;
    }
    if (!any) {
      dea_table_begin(report, "First event of each kind along the equilibrium path; of models "
                              "without one, the first point of the sweep beyond it");
      dea_table_head(report, "Model|Limit|#V (kV)|#electrode stretch|#margin (kV)|Sweep");
      any = true;
    }
    add_model_limits(out, result, curve->model);
  }
  if (any) {
    dea_table_end(report);
  }
  dea_text_add(out, "<ul>");
  for (size_t c = 0; c < result->curve_count; c++) {
    if (strcmp(result->curves[c].kind, "sweep") == 0 && result->curves[c].count > 0) {
      add_worst(out, &result->curves[c], dea_result_find(result, result->curves[c].model, "path"));
    }
  }
  dea_text_add(out, "</ul>");
  dea_section_end(report);
  return DEA_OK;
}

/* Columns of a table of all points: those that have a number. */
static bool is_shown(const struct dea_result *result, const struct dea_curve *curve, int column)
{
  return dea_points_have(curve->points, curve->count, column) &&
         !dea_figure_leaves_out(result, curve, column);
}

static dea_status add_curve_points(struct dea_report *report, const struct dea_result *result,
                                   const struct dea_curve *curve)
{
  struct dea_text *out = &report->text;
  const int count = dea_column_count(report->ctx);
  char caption[3 * DEA_NAME_SIZE], title[DEA_COLUMN_TITLE_SIZE];
  bool *shown = dea_alloc(report->ctx, (size_t)count, sizeof *shown);
  DEA_TRY_MEMORY(shown != NULL);
  snprintf(caption, sizeof caption, "Model %s, %s: %zu points", curve->model, curve->kind,
           curve->count);
  dea_html_add(out, "<details><summary>%s</summary>", caption);
  dea_table_begin(report, caption);
  for (int c = 0; c < count; c++) {
    shown[c] = is_shown(result, curve, c);
    dea_column_title(dea_column_at(report->ctx, c), title, sizeof title);
    if (shown[c]) {
      dea_html_element(out, "th scope=\"col\" class=\"n\"", title);
    }
  }
  dea_table_head(report, "stable|trusted");
  for (size_t i = 0; i < curve->count; i++) {
    dea_text_add(out, "<tr>");
    for (int c = 0; c < count; c++) {
      if (shown[c]) {
        dea_html_cell(
            out, dea_column_at(report->ctx, c)->factor * dea_point_get(&curve->points[i], c), 5);
      }
    }
    const struct dea_load_point *p = &curve->points[i];
    char words[DEA_FLAGS_SIZE];
    dea_flags_text(dea_load_point_flags(p), words);
    dea_text_add(out, "<td>%s</td><td class=\"%s\">%s%s%s</td></tr>", p->stable ? "yes" : "no",
                 dea_load_point_trusted(p) ? "good" : "bad",
                 dea_load_point_trusted(p) ? "yes" : "no", words[0] != '\0' ? ": " : "", words);
  }
  dea_table_end(report);
  dea_text_add(out, "</details>");
  dea_free(report->ctx, shown);
  return DEA_OK;
}

dea_status dea_section_points(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  bool any = false;
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    if (curve->count == 0 || strcmp(curve->kind, "path") == 0) { // a path is for its curve
      continue;
    }
    if (!any) {
      dea_section_begin(report, "points", run->number, "Points");
      any = true;
    }
    DEA_TRY(report->ctx, add_curve_points(report, result, curve));
  }
  if (any) {
    dea_section_end(report);
  }
  return DEA_OK;
}
