#include "identify/life_fit.h"

#include "base/file.h"
#include "base/write_file.h"
#include "table/csv_columns.h"

#include <math.h>
#include <string.h>

const char *const dea_life_end_names[DEA_LIFE_ENDS] = {"survived", "stroke", "leakage", "breakdown",
                                                       "as told"};

/* ---- the fit file ---- */

#define AT(member) offsetof(struct dea_life_file, member)
#define OF(member) offsetof(struct dea_life_specimen, member)

const char *const dea_life_clock_names[] = {"cycles", "time", "under_voltage", "charge", NULL};
const char *const dea_life_clock_units[] = {"cycles", "h", "h", "mC"};
const double dea_life_clock_factors[] = {1, 1 / 3600.0, 1 / 3600.0, 1e3};

static const struct dea_field specimen_fields[] = {
    DEA_LABEL_ROW("name", OF(name), "F12", "name of the specimen", .required = true),
    DEA_LABEL_ROW("reduced", OF(reduced), "[F12-week1.reduced, F12-week2.reduced]",
                  "folders that dea reduce wrote of its recordings, in time, counted from the "
                  "folder of this file",
                  DEA_LIST(1, DEA_LIFE_PARTS_MAX, struct dea_label, OF(reduced_count)),
                  .lone = true, .absent_text = "its life is given"),
    DEA_NUMBER_ROW(
        "life", OF(life), "1", "120000",
        "its life in the unit of the clock (cycles, h, h, mC), where it is known already",
        .above_min = true, .max = 1e15, .absent_text = "from its recordings"),
    DEA_CHOICE_ROW("failed", OF(failed), dea_no_yes, "yes",
                   "of a given life whether it ended by a failure; of recordings whether the "
                   "specimen failed at their end where no criterion says so",
                   .default_text = "no"),
};

static const struct dea_field fields[] = {
    DEA_FIT_HEAD_FIELDS("name of what is fitted", "batch-7", "none", "what was cycled",
                        "discs of batch 7 at 3 kV, 10 Hz"),
    DEA_FIELD_ROW(
        RECORD, "life", AT(specimens), .record = DEA_ROWS(specimen_fields), .required = true,
        .doc = "the specimens, those that survived too",
        .example = "[{name: F12, reduced: F12.reduced}, {name: F13, life: 120000, failed: yes}]",
        DEA_LIST(1, DEA_LIFE_SPECIMENS_MAX, struct dea_life_specimen, AT(specimen_count))),
    DEA_CHOICE_ROW("clock", AT(clock), dea_life_clock_names, "under_voltage",
                   "what a life is counted in: cycles, time (h), time under voltage (h), charge "
                   "brought to the film (mC)",
                   .default_text = "cycles"),
    DEA_NUMBER_ROW("stroke_loss", AT(stroke_loss), "1", "20 %",
                   "share of its first stroke that a specimen may lose", .above_min = true,
                   .max = 1, .absent_text = "no failure"),
    DEA_NUMBER_ROW("largest_leakage", AT(leakage_A), "A", "2 uA",
                   "current at the held voltage beyond which a specimen has failed",
                   .above_min = true, .max = 1, .absent_text = "no failure"),
    DEA_CHOICE_ROW("at_breakdown", AT(breakdown), dea_no_yes, "no",
                   "whether a breakdown is a failure", .default_text = "yes"),
    DEA_INTEGER_ROW("reference_cycles", AT(reference_cycles), "100",
                    "cycles whose mean is the first stroke", .min = 1, .max = 1e6,
                    .default_text = "10"),
    DEA_INTEGER_ROW("lasting", AT(lasting), "10",
                    "cycles in a row that a lost stroke or a leakage has to last; the first of "
                    "them is the failure",
                    .min = 1, .max = 1e6, .default_text = "3"),
};
/* A finding where a recording stands before this one already: its cycles would count twice. */
static dea_status check_once(struct dea_context *ctx, const struct dea_life_file *fit, size_t i,
                             size_t part)
{
  const struct dea_label *own = &fit->specimens[i].reduced[part];
  for (size_t k = 0; k <= i; k++) {
    const struct dea_life_specimen *other = &fit->specimens[k];
    for (size_t p = 0; p < (k < i ? other->reduced_count : part); p++) {
      if (strcmp(other->reduced[p].text, own->text) == 0) {
        return dea_finding_add(ctx, DEA_ERROR, own->location,
                               "'%.80s' is a recording of '%.60s' already, in line %zu", own->text,
                               other->name.text, other->reduced[p].location.line);
      }
    }
  }
  return DEA_OK;
}

static dea_status check_file(struct dea_context *ctx, const void *file)
{
  const struct dea_life_file *fit = file;
  for (size_t i = 0; i < fit->specimen_count; i++) {
    const struct dea_life_specimen *own = &fit->specimens[i];
    for (size_t p = 0; p < own->reduced_count; p++) {
      DEA_TRY(ctx, check_once(ctx, fit, i, p));
    }
    if ((own->reduced_count > 0) == (own->life.origin != DEA_ABSENT)) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, own->name.location,
                                   "'%.60s' needs %s: its recordings, or its life", own->name.text,
                                   own->reduced_count > 0 ? "one" : "something"));
    }
  }
  return dea_fit_names_check(ctx, fit->specimens, fit->specimen_count, sizeof fit->specimens[0],
                             "specimen");
}

const struct dea_fit_form dea_life_form = {
    {"fit file", "life tests, for Weibull's law of them", fields, DEA_COUNT(fields)},
    sizeof(struct dea_life_file),
    check_file};

/* ---- a life ---- */

/* A cycle; NAN: not known. */
struct cycle {
  double clock[DEA_LIFE_CLOCKS]; // at its end
  double asked_V, stroke, leakage_A;
  double breakdown; // how many
};

/* Those of all recordings of a specimen, in time. */
struct cycles {
  size_t count;
  struct cycle *cycle; // [count]
};

static const double same_voltage = 0.99;

/* Whether a cycle is one of the test itself, not of a look at the specimen at a lower voltage. */
static bool is_judged(const struct cycle *cycle, double largest_V)
{
  return fabs(cycle->asked_V) >= same_voltage * largest_V;
}

static double largest_voltage(const struct cycles *c)
{
  double largest_V = 0;
  for (size_t i = 0; i < c->count; i++) {
    largest_V = fmax(largest_V, fabs(c->cycle[i].asked_V)); // not NAN
  }
  return largest_V;
}

/* Mean stroke of the first `count` cycles, and the row behind them; NAN where there are not so
 * many. */
static double first_stroke(const struct cycles *c, double largest_V, size_t count, size_t *behind)
{
  double sum = 0;
  size_t n = 0;
  for (*behind = 0; *behind < c->count && n < count; ++*behind) {
    const struct cycle *cycle = &c->cycle[*behind];
    if (is_judged(cycle, largest_V) && !isnan(cycle->stroke)) {
      sum += fabs(cycle->stroke);
      n++;
    }
  }
  return n == count && n > 0 ? sum / (double)n : NAN;
}

/* First of `lasting` judged cycles in a row whose stroke is below a limit, or whose leakage is
 * above it; those without a value neither count nor part the others. c->count: there are none. */
static size_t first_beyond(const struct cycles *c, bool stroke, size_t from, double largest_V,
                           double limit, size_t lasting)
{
  size_t first = c->count, n = 0;
  for (size_t i = from; i < c->count; i++) {
    const double value = stroke ? c->cycle[i].stroke : c->cycle[i].leakage_A;
    if (!is_judged(&c->cycle[i], largest_V) || isnan(value)) {
      continue;
    }
    bool beyond = stroke ? fabs(value) < limit : fabs(value) > limit;
    first = beyond && n == 0 ? i : first;
    n = beyond ? n + 1 : 0;
    if (n == lasting) {
      return first;
    }
  }
  return c->count;
}

/* Of the last judged cycle up to a row; NAN without. */
static double last_stroke(const struct cycles *c, double largest_V, size_t row)
{
  for (size_t i = row + 1; i > 0; i--) {
    if (is_judged(&c->cycle[i - 1], largest_V) && !isnan(c->cycle[i - 1].stroke)) {
      return c->cycle[i - 1].stroke;
    }
  }
  return NAN;
}

static size_t first_breakdown(const struct cycles *c)
{
  size_t i = 0;
  while (i < c->count && !(c->cycle[i].breakdown > 0)) {
    i++;
  }
  return i;
}

/* When a specimen failed by the file's criterion, or that it survived. It is applied to what was
 * recorded, so that a recording goes on behind a failure and another criterion may be asked later
 * (docs/theory/reduction.md, "Lives"). Only cycles within 1 % of the largest voltage are judged by
 * stroke and leakage; a breakdown counts in any. c->count > 0. */
static void find_end(const struct cycles *c, const struct dea_life_file *criterion,
                     struct dea_life *out)
{
  double largest_V = largest_voltage(c);
  size_t behind, at[DEA_LIFE_ENDS];
  const size_t lasting = (size_t)criterion->lasting.si;
  double reference = first_stroke(c, largest_V, (size_t)criterion->reference_cycles.si, &behind);
  at[DEA_LIFE_SURVIVED] = at[DEA_LIFE_TOLD] = c->count;
  // comparisons with NAN are false: what is not known is not beyond
  at[DEA_LIFE_STROKE] = first_beyond(c, true, behind, largest_V,
                                     (1 - criterion->stroke_loss.si) * reference, lasting);
  at[DEA_LIFE_LEAKAGE] = first_beyond(c, false, 0, largest_V, criterion->leakage_A.si, lasting);
  at[DEA_LIFE_BREAKDOWN] = criterion->breakdown.value == 1 ? first_breakdown(c) : c->count;
  *out = (struct dea_life){.row = c->count - 1, .first_stroke = reference};
  for (int end = DEA_LIFE_STROKE; end <= DEA_LIFE_BREAKDOWN; end++) {
    if (at[end] < c->count && (out->end == DEA_LIFE_SURVIVED || at[end] < out->row)) {
      out->end = (enum dea_life_end)end;
      out->row = at[end];
    }
  }
  out->last_stroke = last_stroke(c, largest_V, out->row);
  memcpy(out->clock, c->cycle[out->row].clock, sizeof out->clock);
}

/* ---- the specimens ---- */

enum column {
  END,
  UNDER_VOLTAGE,
  CHARGE,
  ASKED,
  DISPLACEMENT,
  FORCE,
  LEAKAGE,
  BREAKDOWNS,
  ENDED,
  COLUMNS
};

/* life.csv of `dea reduce`. */
static const struct dea_csv_wanted wanted[COLUMNS] = {
    [END] = DEA_CSV_COLUMN("end", "s", "1 s", .title = "end (s)", .needed = true, .filled = true),
    [UNDER_VOLTAGE] = DEA_CSV_COLUMN("under voltage", "s", "1 s", .title = "under voltage (s)",
                                     .needed = true, .filled = true),
    [CHARGE] = DEA_CSV_COLUMN("charge", "C", "1 uC", .title = "charge (uC)"),
    [ASKED] = DEA_CSV_COLUMN("asked v", "V", "1 kV", .title = "asked V (kV)", .needed = true,
                             .filled = true),
    [DISPLACEMENT] = DEA_CSV_COLUMN("displacement", "m", "1 um", .title = "displacement (um)"),
    [FORCE] = DEA_CSV_COLUMN("force", "N", "1 mN", .title = "force (mN)"),
    [LEAKAGE] = DEA_CSV_COLUMN("leakage", "A", "1 nA", .title = "leakage (nA)"),
    [BREAKDOWNS] = DEA_CSV_COLUMN("breakdowns", "1", "1", .title = "breakdowns"),
    [ENDED] = DEA_CSV_COLUMN("ended early", "1", "1", .title = "ended early"),
};

struct specimen {
  struct dea_csv_columns parts[DEA_LIFE_PARTS_MAX];
  size_t count; // of parts
  struct cycles cycles;
};

static dea_status read_part(struct dea_context *ctx, const struct dea_life_file *file,
                            const char *folder, struct dea_csv_columns *out)
{
  char *beside = dea_path_beside(ctx, file->head.file, folder), path[DEA_PATH_SIZE];
  DEA_TRY_MEMORY(beside != NULL);
  const dea_status status = dea_path_build(ctx, beside, "life.csv", path);
  dea_free(ctx, beside);
  DEA_TRY(ctx, status);
  return dea_csv_columns_read(ctx, path, wanted, COLUMNS, NULL, out);
}

static double at(const struct dea_csv_columns *part, enum column column, size_t i)
{
  return part->values[column] != NULL ? part->values[column][i] : (double)NAN;
}

/* What the stroke of all recordings is: that of the first. */
static enum column stroke_of(const struct specimen *s)
{
  return s->parts[0].values[DISPLACEMENT] != NULL || s->parts[0].values[FORCE] == NULL
             ? DISPLACEMENT
             : FORCE;
}

/* The cycles of all recordings one behind the other: clocks go on where the one before ended. */
static dea_status join_parts(struct dea_context *ctx, struct specimen *s)
{
  static const enum column clocks[DEA_LIFE_CLOCKS] = {COLUMNS, END, UNDER_VOLTAGE, CHARGE};
  const enum column stroke = stroke_of(s);
  double so_far[DEA_LIFE_CLOCKS] = {0};
  size_t n = 0;
  for (size_t p = 0; p < s->count; p++) {
    s->cycles.count += s->parts[p].rows;
  }
  s->cycles.cycle = dea_alloc(ctx, s->cycles.count + 1, sizeof *s->cycles.cycle);
  DEA_TRY_MEMORY(s->cycles.cycle != NULL);
  for (size_t p = 0; p < s->count; p++) {
    const struct dea_csv_columns *part = &s->parts[p];
    for (size_t i = 0; i < part->rows; i++, n++) {
      struct cycle *cycle = &s->cycles.cycle[n];
      *cycle = (struct cycle){.clock = {[DEA_LIFE_CYCLES] = (double)(n + 1)},
                              .asked_V = at(part, ASKED, i),
                              .stroke = at(part, stroke, i),
                              .leakage_A = at(part, LEAKAGE, i),
                              .breakdown = at(part, BREAKDOWNS, i)};
      for (int k = DEA_LIFE_TIME; k < DEA_LIFE_CLOCKS; k++) {
        cycle->clock[k] = so_far[k] + at(part, clocks[k], i);
      }
    }
    if (part->rows > 0) {
      memcpy(so_far, s->cycles.cycle[n - 1].clock, sizeof so_far);
    }
  }
  return DEA_OK;
}

/* What a criterion asks for and the table does not have is an error: it would never act. */
static dea_status check_columns(struct dea_context *ctx, const struct dea_life_file *file,
                                const struct dea_life_specimen *own, const struct specimen *s)
{
  for (size_t p = 0; p < s->count; p++) {
    const struct dea_csv_columns *part = &s->parts[p];
    const bool strokes = file->stroke_loss.origin != DEA_ABSENT;
    const char *lacks = strokes && part->values[DISPLACEMENT] == NULL && part->values[FORCE] == NULL
                            ? "stroke, which stroke_loss asks for"
                        : strokes && part->values[stroke_of(s)] == NULL
                            ? stroke_of(s) == FORCE
                                  ? "force, which is the stroke of the first"
                                  : "displacement, which is the stroke of the first"
                        : file->leakage_A.origin != DEA_ABSENT && part->values[LEAKAGE] == NULL
                            ? "current, which largest_leakage asks for"
                        : file->clock.value == DEA_LIFE_CHARGE && part->values[CHARGE] == NULL
                            ? "current, which the clock 'charge' asks for"
                        : file->clock.value == DEA_LIFE_CHARGE && part->rows > 0 &&
                                isnan(part->values[CHARGE][part->rows - 1])
                            ? "known charge, which the clock 'charge' asks for"
                            : NULL;
    if (lacks != NULL) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, own->reduced[p].location, "'%.80s' has no %s",
                                   own->reduced[p].text, lacks));
    }
  }
  return s->cycles.count > 0 ? DEA_OK
                             : dea_finding_add(ctx, DEA_ERROR, own->name.location,
                                               "'%.60s' has no completed cycle", own->name.text);
}

static dea_status judge(struct dea_context *ctx, const struct dea_life_file *file,
                        const struct dea_life_specimen *own, const struct specimen *s,
                        struct dea_life *out)
{
  const struct dea_csv_columns *last = &s->parts[s->count - 1];
  find_end(&s->cycles, file, out);
  if (file->stroke_loss.origin != DEA_ABSENT && isnan(out->first_stroke)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, own->name.location,
                                 "'%.60s' has fewer than %zu cycles with a stroke at its largest "
                                 "voltage (reference_cycles): its stroke is not judged",
                                 own->name.text, (size_t)file->reference_cycles.si));
  }
  if (out->end == DEA_LIFE_SURVIVED && own->failed.value == 1) {
    out->end = DEA_LIFE_TOLD;
  } else if (out->end == DEA_LIFE_SURVIVED && last->rows > 0 &&
             at(last, ENDED, last->rows - 1) > 0) {
    return dea_finding_add(ctx, DEA_WARNING, own->name.location,
                           "the last recording of '%.60s' ended early, and no criterion says why: "
                           "it counts as a survivor; write 'failed: yes' where it was the specimen",
                           own->name.text);
  }
  return DEA_OK;
}

static dea_status read_specimen(struct dea_context *ctx, const struct dea_life_file *file,
                                const struct dea_life_specimen *own, struct dea_life *out)
{
  struct specimen *s = dea_alloc(ctx, 1, sizeof *s);
  DEA_TRY_MEMORY(s != NULL);
  dea_status status = DEA_OK;
  for (size_t p = 0; p < own->reduced_count && status == DEA_OK; p++) {
    status = read_part(ctx, file, own->reduced[p].text, &s->parts[p]);
    s->count += status == DEA_OK ? 1 : 0;
  }
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  status = status == DEA_OK ? join_parts(ctx, s) : status;
  status = status == DEA_OK ? check_columns(ctx, file, own, s) : status;
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) > errors) {
    status = dea_fail(ctx, DEA_E_IO, "specimen '%.60s' cannot be judged", own->name.text);
  }
  status = status == DEA_OK ? judge(ctx, file, own, s, out) : status;
  for (size_t p = 0; p < s->count; p++) {
    dea_csv_columns_free(ctx, &s->parts[p]);
  }
  dea_free(ctx, s->cycles.cycle);
  dea_free(ctx, s);
  return status;
}

/* A life that was given: of the other clocks nothing is known. */
static struct dea_life given_life(const struct dea_life_file *file,
                                  const struct dea_life_specimen *own)
{
  const int clock = file->clock.value;
  struct dea_life life = {.end = own->failed.value == 1 ? DEA_LIFE_TOLD : DEA_LIFE_SURVIVED,
                          .first_stroke = NAN,
                          .last_stroke = NAN};
  for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
    life.clock[k] = k == clock ? own->life.si / dea_life_clock_factors[k] : (double)NAN;
  }
  return life;
}

/* ---- the law ---- */

static dea_status find_law(struct dea_context *ctx, struct dea_life_fit *fit)
{
  const struct dea_weibull_data data = {
      .rows = fit->rows,
      .field_V_per_m = fit->value,
      .survived = fit->survived,
      .held = {[DEA_WEIBULL_STRETCH] = true, [DEA_WEIBULL_THICKNESS] = true},
  };
  fit->has_law = true;
  return dea_weibull_solve(ctx, &data, &fit->fit);
}

/* Whether two failed at different lives: a law has two numbers. */
static bool tells_law(const struct dea_life_fit *fit)
{
  double low = INFINITY, high = 0;
  for (size_t i = 0; i < fit->rows; i++) {
    low = fit->survived[i] ? low : fmin(low, fit->value[i]);
    high = fit->survived[i] ? high : fmax(high, fit->value[i]);
  }
  return high > low;
}

dea_status dea_life_fit_run(struct dea_context *ctx, const struct dea_life_file *file,
                            struct dea_life_fit *fit)
{
  *fit = (struct dea_life_fit){.file = file, .memory = {.ctx = ctx}};
  const size_t n = fit->rows = file->specimen_count;
  fit->lives = dea_arena_alloc(&fit->memory, n, sizeof *fit->lives);
  fit->value = dea_arena_alloc(&fit->memory, n, sizeof *fit->value);
  fit->survived = dea_arena_alloc(&fit->memory, n, sizeof *fit->survived);
  DEA_TRY(ctx, dea_arena_status(&fit->memory));
  for (size_t i = 0; i < n; i++) {
    const struct dea_life_specimen *own = &file->specimens[i];
    if (own->reduced_count > 0) {
      DEA_TRY(ctx, read_specimen(ctx, file, own, &fit->lives[i]));
    } else {
      fit->lives[i] = given_life(file, own);
    }
    fit->value[i] = fit->lives[i].clock[file->clock.value];
    fit->survived[i] = fit->lives[i].end == DEA_LIFE_SURVIVED;
    fit->failed += fit->survived[i] ? 0 : 1;
    if (!(fit->value[i] > 0)) {
      return dea_fail(ctx, DEA_E_IO, "the life of '%.60s' is not known by the clock '%s'",
                      own->name.text, dea_life_clock_names[file->clock.value]);
    }
  }
  return tells_law(fit) ? find_law(ctx, fit) : DEA_OK;
}

void dea_life_fit_free(struct dea_life_fit *fit)
{
  dea_arena_free(&fit->memory);
}

double dea_life_fit_bound(const struct dea_life_fit *fit, double *life)
{
  *life = INFINITY;
  for (size_t i = 0; i < fit->rows; i++) {
    *life = fmin(*life, fit->value[i]);
  }
  return fit->failed == 0 ? -expm1(log(0.05) / (double)fit->rows) : (double)NAN;
}
