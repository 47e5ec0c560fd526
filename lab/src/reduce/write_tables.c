#include "reduce/output.h"

#include "base/csv_line.h"
#include "base/write_file.h"

#include <stdio.h>

const struct dea_reduced_meaning dea_reduced_meanings[DEA_REDUCED_KINDS] = {
    [DEA_REDUCED_CENTRE] = {"z centre", "centre", "m", "um", 1e6},
    [DEA_REDUCED_FIBRE_TIP] = {"z fibre tip", "fibre_tip", "m", "um", 1e6},
    [DEA_REDUCED_DISPLACEMENT] = {"z point laser", "point_laser", "m", "um", 1e6},
    [DEA_REDUCED_FORCE] = {"force", "force", "N", "mN", 1e3},
};

bool dea_reduced_has(const struct dea_reduction *reduction, enum dea_reduced_kind kind)
{
  for (size_t l = 0; l < reduction->level_count; l++) {
    if (!isnan(reduction->levels[l].mean[kind])) {
      return true;
    }
  }
  return false;
}

static const enum dea_reduced_kind in_order[] = {DEA_REDUCED_CENTRE, DEA_REDUCED_DISPLACEMENT,
                                                 DEA_REDUCED_FORCE};
enum { IN_ORDER = sizeof in_order / sizeof in_order[0] };

enum dea_reduced_kind dea_reduced_main(const struct dea_reduction *reduction)
{
  for (size_t k = 0; k < IN_ORDER; k++) {
    if (dea_reduced_has(reduction, in_order[k])) {
      return in_order[k];
    }
  }
  return DEA_REDUCED_KINDS;
}

enum dea_reduced_kind dea_reduced_timed(const struct dea_reduction *reduction)
{
  for (size_t k = 0; k < IN_ORDER; k++) {
    for (size_t l = 0; l < reduction->level_count; l++) {
      if (!isnan(reduction->levels[l].rise_s[in_order[k]])) {
        return in_order[k];
      }
    }
  }
  return dea_reduced_main(reduction);
}

/* Standard uncertainty of the mean of all cycles of some levels: that of each, and what their means
 * differ by where that is more. */
static double row_uncertainty(const struct dea_voltage_level *first, size_t levels, int kind,
                              double mean)
{
  double n = 0.0, own = 0.0, between = 0.0;
  for (size_t l = 0; l < levels; l++) {
    const double m = (double)first[l].cycles, off = first[l].mean[kind] - mean;
    if (!isnan(off)) {
      n += m;
      own += pow(m * first[l].uncertainty[kind], 2.0);
      between += m * off * off;
    }
  }
  between = levels > 1 ? between / n / (double)(levels - 1) : 0.0;
  return sqrt(isnan(own) ? NAN : fmax(own / (n * n), between));
}

double dea_reduced_highest_V(const struct dea_reduction *reduction)
{
  const size_t n = reduction->level_count;
  return n > 0
             ? fmax(fabs(reduction->levels[0].voltage_V), fabs(reduction->levels[n - 1].voltage_V))
             : 0.0;
}

struct dea_reduced_row dea_reduced_row_at(const struct dea_reduction *reduction, size_t level)
{
  const struct dea_voltage_level *first = &reduction->levels[level];
  const struct dea_voltage_level *last = &reduction->levels[reduction->level_count - 1];
  double within_V = 0.01 * dea_reduced_highest_V(reduction);
  struct dea_reduced_row row = {0};
  while (first + row.levels <= last && first[row.levels].voltage_V - first->voltage_V <= within_V) {
    double n = (double)first[row.levels].cycles;
    row.voltage_V += n * first[row.levels].voltage_V;
    row.cycles += first[row.levels++].cycles;
  }
  row.voltage_V /= (double)row.cycles;
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    double n = 0.0, sum = 0.0, squares = 0.0, noise = 0.0;
    for (size_t l = 0; l < row.levels; l++) {
      double m = isnan(first[l].mean[kind]) ? 0.0 : (double)first[l].cycles;
      n += m;
      sum += m > 0.0 ? m * first[l].mean[kind] : 0.0;
      noise += isnan(first[l].noise[kind]) ? 0.0 : m * first[l].noise[kind] * first[l].noise[kind];
    }
    row.mean[kind] = sum / n; // NAN without any
    for (size_t l = 0; l < row.levels && n > 0.0; l++) {
      double m = (double)first[l].cycles, off = first[l].mean[kind] - row.mean[kind];
      squares += isnan(off) ? 0.0 : m * off * off;
      squares += isnan(first[l].std[kind]) ? 0.0 : (m - 1.0) * pow(first[l].std[kind], 2.0);
    }
    double scatter = n > 1.0 ? sqrt(squares / (n - 1.0)) : 0.0;
    double std = fmax(scatter, n > 0.0 ? sqrt(noise / n) : 0.0);
    row.std[kind] = std > 0.0 ? std : NAN;
    row.uncertainty[kind] = row_uncertainty(first, row.levels, kind, row.mean[kind]);
  }
  return row;
}

// Fields -----------------------------------------------------------------------------------------

/* "name what (unit)", in place of "name (unit)" for what "". */
static void add_title(struct dea_text *text, const char *name, const char *what, const char *unit)
{
  dea_text_add(text, ",%s%s%s (%s)", name, what[0] != '\0' ? " " : "", what, unit);
}

/* Where a file's numbers come from, as a comment. */
static void add_source(struct dea_text *text, const struct dea_recording *recording)
{
  dea_text_add(text, "# Reduced from ");
  for (const char *c = recording->file != NULL ? recording->file : ""; *c != '\0'; c++) {
    dea_text_add(text, "%c", *c == '\n' || *c == '\r' ? ' ' : *c);
  }
  dea_text_add(text, "%s\n",
               recording->file == NULL || recording->file[0] == '\0' ? "a recording" : "");
}

// Tables -----------------------------------------------------------------------------------------

/* The kind behind a column of `dea compare`: the point laser's where there is no profile. */
static const enum dea_reduced_kind measured_centre[2] = {DEA_REDUCED_CENTRE,
                                                         DEA_REDUCED_DISPLACEMENT};

/* Kinds of the columns that `dea compare` and `dea fit` read. */
static size_t measured_kinds(const struct dea_reduction *r, enum dea_reduced_kind kinds[3])
{
  size_t count = 0;
  for (int k = 0; k < 2 && count == 0; k++) {
    if (dea_reduced_has(r, measured_centre[k])) {
      kinds[count++] = measured_centre[k];
    }
  }
  if (dea_reduced_has(r, DEA_REDUCED_FIBRE_TIP)) {
    kinds[count++] = DEA_REDUCED_FIBRE_TIP;
  }
  if (dea_reduced_has(r, DEA_REDUCED_FORCE)) {
    kinds[count++] = DEA_REDUCED_FORCE;
  }
  return count;
}

/* Mean square of the uncertainties of a kind over the rows that have one; NAN without any. */
static double usual_variance(const struct dea_reduction *r, enum dea_reduced_kind kind)
{
  double sum = 0.0, count = 0.0;
  for (size_t l = 0; l < r->level_count;) {
    const struct dea_reduced_row row = dea_reduced_row_at(r, l);
    if (!isnan(row.uncertainty[kind])) {
      sum += row.uncertainty[kind] * row.uncertainty[kind];
      count += 1.0;
    }
    l += row.levels;
  }
  return sum / count;
}

/* Uncertainty of a mean. Few cycles tell their scatter badly (five to 35 %), which would give some
 * rows far too much weight: theirs is drawn to that of all rows as if that were ten cycles more. */
static double mean_uncertainty(const struct dea_reduced_row *row, enum dea_reduced_kind kind,
                               double usual)
{
  const bool known = row->cycles > 1 && !isnan(row->uncertainty[kind]);
  const double own = known ? (double)row->cycles - 1.0 : 0.0, more = 10.0;
  const double variance = known ? row->uncertainty[kind] * row->uncertainty[kind] : 0.0;
  return sqrt((own * variance + more * usual) / (own + more));
}

/* measurement.csv with the scatter of one cycle, means.csv with the uncertainty of the mean. */
static dea_status write_measurement(struct dea_context *ctx, const struct dea_recording *recording,
                                    const struct dea_reduction *r, bool means,
                                    const char *directory)
{
  enum dea_reduced_kind kinds[3];
  const size_t count = measured_kinds(r, kinds);
  if (count == 0) {
    return DEA_OK;
  }
  struct dea_text text = {.ctx = ctx};
  double usual[3];
  add_source(&text, recording);
  dea_text_add(&text, means ? "# std: of the mean of all cycles; what is common to them (gain, "
                              "position) is not in it\nV (kV)"
                            : "# std: of one cycle, the larger of the standard deviation from "
                              "cycle to cycle and of what the noise of its samples gives\nV (kV)");
  for (size_t k = 0; k < count; k++) {
    enum dea_reduced_kind named =
        kinds[k] == DEA_REDUCED_DISPLACEMENT ? DEA_REDUCED_CENTRE : kinds[k];
    const struct dea_reduced_meaning *m = &dea_reduced_meanings[named];
    usual[k] = usual_variance(r, kinds[k]);
    add_title(&text, m->name, "", m->unit);
    add_title(&text, m->name, "std", m->unit);
  }
  for (size_t l = 0; l < r->level_count;) {
    struct dea_reduced_row row = dea_reduced_row_at(r, l);
    dea_text_add(&text, "\n%.10g", 1e-3 * row.voltage_V);
    for (size_t k = 0; k < count; k++) {
      const double std = means ? mean_uncertainty(&row, kinds[k], usual[k]) : row.std[kinds[k]];
      DEA_CSV_ADD(&text, 10, dea_reduced_meanings[kinds[k]].factor * row.mean[kinds[k]],
                  dea_reduced_meanings[kinds[k]].factor * std);
    }
    l += row.levels;
  }
  dea_text_add(&text, "\n");
  return dea_text_write(ctx, &text, directory, means ? "means.csv" : "measurement.csv");
}

static dea_status write_levels(struct dea_context *ctx, const struct dea_reduction *r,
                               const char *directory)
{
  struct dea_text text = {.ctx = ctx};
  const bool current = r->current.samples > 0;
  dea_text_add(&text, "V (kV),step,cycles,shape,shape uncertainty");
  if (current) {
    dea_text_add(&text, ",capacitance (pF),capacitance std (pF),sensed stretch");
  }
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    const struct dea_reduced_meaning *m = &dea_reduced_meanings[kind];
    if (dea_reduced_has(r, (enum dea_reduced_kind)kind)) {
      char each[32];
      snprintf(each, sizeof each, "%s/cycle", m->unit);
      add_title(&text, m->name, "", m->unit);
      add_title(&text, m->name, "std", m->unit);
      add_title(&text, m->name, "noise", m->unit);
      add_title(&text, m->name, "uncertainty", m->unit);
      add_title(&text, m->name, "rise", "s");
      add_title(&text, m->name, "fall", "s");
      add_title(&text, m->name, "creep", m->unit);
      add_title(&text, m->name, "drift", each);
      add_title(&text, m->name, "drift uncertainty", each);
    }
  }
  for (size_t l = 0; l < r->level_count; l++) {
    const struct dea_voltage_level *level = &r->levels[l];
    dea_text_add(&text, "\n%.10g,%zu,%zu", 1e-3 * level->voltage_V, level->step, level->cycles);
    DEA_CSV_ADD(&text, 10, level->shape, level->shape_uncertainty);
    if (current) {
      DEA_CSV_ADD(&text, 10, 1e12 * level->capacitance_F, 1e12 * level->capacitance_std_F,
                  level->sensed_stretch);
    }
    for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
      if (dea_reduced_has(r, (enum dea_reduced_kind)kind)) {
        double f = dea_reduced_meanings[kind].factor;
        DEA_CSV_ADD(&text, 10, f * level->mean[kind], f * level->std[kind], f * level->noise[kind],
                    f * level->uncertainty[kind], level->rise_s[kind], level->fall_s[kind],
                    f * level->creep[kind], f * level->drift[kind],
                    f * level->drift_uncertainty[kind]);
      }
    }
  }
  dea_text_add(&text, "\n");
  return dea_text_write(ctx, &text, directory, "levels.csv");
}

static dea_status write_cycles(struct dea_context *ctx, const struct dea_reduction *r,
                               const char *directory)
{
  struct dea_text text = {.ctx = ctx};
  const bool current = r->current.samples > 0;
  dea_text_add(&text, "step,cycle,start (s),end (s),under voltage (s),asked V (kV),V (kV),shape");
  if (current) {
    dea_text_add(&text, ",capacitance (pF),leakage (nA),charge (uC),discharges,breakdowns");
  }
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    const struct dea_reduced_meaning *m = &dea_reduced_meanings[kind];
    if (dea_reduced_has(r, (enum dea_reduced_kind)kind)) {
      add_title(&text, m->name, "", m->unit);
      add_title(&text, m->name, "uncertainty", m->unit);
      add_title(&text, m->name, "rest", m->unit);
      add_title(&text, m->name, "active", m->unit);
      add_title(&text, m->name, "rise", "s");
      add_title(&text, m->name, "fall", "s");
      add_title(&text, m->name, "creep", m->unit);
    }
  }
  for (size_t k = 0; k < r->cycle_count; k++) {
    const struct dea_reduced_cycle *c = &r->cycles[k];
    dea_text_add(&text, "\n%zu,%zu", c->cycle.step, c->cycle.number);
    DEA_CSV_ADD(&text, 10, c->cycle.start_s, c->cycle.end_s, c->under_voltage_s,
                1e-3 * c->cycle.level_V, 1e-3 * c->voltage_V, c->shape);
    if (current) {
      DEA_CSV_ADD(&text, 10, 1e12 * c->capacitance_F, 1e9 * c->leakage_A, 1e6 * c->charge_C);
      dea_text_add(&text, ",%zu,%zu", c->discharges, c->breakdowns);
    }
    for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
      const struct dea_cycle_value *v = &c->values[kind];
      double f = dea_reduced_meanings[kind].factor;
      const double fields[] = {f * v->amplitude, f * v->uncertainty, f * v->rest, f * v->active,
                               v->rise_s,        v->fall_s,          f * v->creep};
      for (size_t i = 0; i < 7 && dea_reduced_has(r, (enum dea_reduced_kind)kind); i++) {
        DEA_CSV_ADD(&text, 10, fields[i]);
      }
    }
  }
  dea_text_add(&text, "\n");
  return dea_text_write(ctx, &text, directory, "cycles.csv");
}

/* A row a cycle of what `dea fit` judges lives by: the main displacement, or the force. */
static dea_status write_life(struct dea_context *ctx, const struct dea_recording *recording,
                             const struct dea_reduction *r, const char *directory)
{
  const enum dea_reduced_kind kind = dea_reduced_main(r);
  const bool current = r->current.samples > 0, stroke = kind != DEA_REDUCED_KINDS;
  struct dea_text text = {.ctx = ctx};
  add_source(&text, recording);
  dea_text_add(&text, "end (s),under voltage (s),asked V (kV)");
  if (stroke) {
    dea_text_add(&text, ",%s (%s)", kind == DEA_REDUCED_FORCE ? "force" : "displacement",
                 dea_reduced_meanings[kind].unit);
  }
  dea_text_add(&text,
               current ? ",charge (uC),leakage (nA),breakdowns,ended early\n" : ",ended early\n");
  for (size_t k = 0; k < r->cycle_count; k++) {
    const struct dea_reduced_cycle *c = &r->cycles[k];
    dea_text_add(&text, "%.12g", c->cycle.end_s - r->cycles[0].cycle.start_s);
    DEA_CSV_ADD(&text, 10, c->under_voltage_s, 1e-3 * c->cycle.level_V);
    if (stroke) {
      DEA_CSV_ADD(&text, 10, dea_reduced_meanings[kind].factor * c->values[kind].amplitude);
    }
    if (current) {
      DEA_CSV_ADD(&text, 10, 1e6 * c->charge_C, 1e9 * c->leakage_A);
      dea_text_add(&text, ",%zu", c->breakdowns);
    }
    dea_text_add(&text, ",%d\n", k + 1 == r->cycle_count && !recording->complete);
  }
  return dea_text_write(ctx, &text, directory, "life.csv");
}

static dea_status write_discharges(struct dea_context *ctx, const struct dea_reduction *r,
                                   const char *directory)
{
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text, "time (s),kind,V (kV),peak (uA),charge (nC)");
  for (size_t i = 0; i < r->discharge_count; i++) {
    const struct dea_discharge *d = &r->discharges[i];
    dea_text_add(&text, "\n%.10g,%s", d->time_s,
                 d->kind == DEA_BREAKDOWN ? "breakdown" : "discharge");
    DEA_CSV_ADD(&text, 10, 1e-3 * d->voltage_V, 1e6 * d->peak_A, 1e9 * d->charge_C);
  }
  dea_text_add(&text, "\n");
  return dea_text_write(ctx, &text, directory, "discharges.csv");
}

static dea_status write_profiles(struct dea_context *ctx, const struct dea_reduction *r,
                                 const char *directory)
{
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text, "V (kV),x (mm),z (um),z std (um)\n");
  for (size_t l = 0; l < r->level_count; l++) {
    const struct dea_voltage_level *level = &r->levels[l];
    for (size_t i = 0; i < r->points; i++) {
      if (!isnan(level->z_m[i])) {
        dea_text_add(&text, "%.10g", 1e-3 * level->voltage_V);
        DEA_CSV_ADD(&text, 10, 1e3 * r->radius_m[i], 1e6 * level->z_m[i], 1e6 * level->z_std_m[i]);
        dea_text_add(&text, "\n");
      }
    }
  }
  return dea_text_write(ctx, &text, directory, "profiles.csv");
}

static dea_status write_time_series(struct dea_context *ctx, const struct dea_recording *recording,
                                    const struct dea_reduction *r, const char *directory)
{
  struct dea_reduced_series table;
  DEA_TRY(ctx, dea_reduced_series_fill(ctx, recording, r, DEA_REDUCED_SERIES_MAX, &table));
  const bool profile = table.values[DEA_REDUCED_CENTRE] != NULL;
  const double *columns[] = {
      table.values[measured_centre[profile ? 0 : 1]],
      table.values[DEA_REDUCED_FIBRE_TIP],
      table.values[DEA_REDUCED_FORCE],
  };
  static const enum dea_reduced_kind named[] = {DEA_REDUCED_CENTRE, DEA_REDUCED_FIBRE_TIP,
                                                DEA_REDUCED_FORCE};
  struct dea_text text = {.ctx = ctx};
  add_source(&text, recording);
  if (table.thinned) {
    dea_text_add(&text, "# thinned: the smallest and the largest sample of each of even stretches "
                        "of time\n");
  }
  dea_text_add(&text, "time (s),V (kV)");
  for (size_t k = 0; k < 3; k++) {
    if (columns[k] != NULL) {
      add_title(&text, dea_reduced_meanings[named[k]].name, "",
                dea_reduced_meanings[named[k]].unit);
    }
  }
  for (size_t i = 0; i < table.rows; i++) {
    dea_text_add(&text, "\n%.12g", table.time_s[i]);
    DEA_CSV_ADD(&text, 10, 1e-3 * table.voltage_V[i]);
    for (size_t k = 0; k < 3; k++) {
      if (columns[k] != NULL) {
        DEA_CSV_ADD(&text, 10, dea_reduced_meanings[named[k]].factor * columns[k][i]);
      }
    }
  }
  dea_text_add(&text, "\n");
  dea_reduced_series_free(ctx, &table);
  return dea_text_write(ctx, &text, directory, "history.csv");
}

dea_status dea_reduction_write_tables(struct dea_context *ctx,
                                      const struct dea_recording *recording,
                                      const struct dea_reduction *reduction, const char *directory)
{
  if (reduction->level_count > 0) {
    DEA_TRY(ctx, write_measurement(ctx, recording, reduction, false, directory));
    DEA_TRY(ctx, write_measurement(ctx, recording, reduction, true, directory));
    DEA_TRY(ctx, write_levels(ctx, reduction, directory));
    DEA_TRY(ctx, write_cycles(ctx, reduction, directory));
    DEA_TRY(ctx, write_life(ctx, recording, reduction, directory));
  }
  if (reduction->level_count > 0 && reduction->points > 0) {
    DEA_TRY(ctx, write_profiles(ctx, reduction, directory));
  }
  if (reduction->current.samples > 0) {
    DEA_TRY(ctx, write_discharges(ctx, reduction, directory));
  }
  return write_time_series(ctx, recording, reduction, directory);
}
