/* Waveform "table": times and voltages from a CSV file, straight in between. */
#include "base/file.h"
#include "table/csv_columns.h"
#include "waveform/wave_make.h"

#include <math.h>

enum { TIME, VOLTAGE };
static const double voltage_max_V = 1e6; // as of the other kinds

struct raw {
  struct dea_label kind, file;
  struct dea_quantity repeat;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_LABEL_ROW(
        "file", offsetof(struct raw, file), "drive.csv",
        "CSV file with a header such as 'time (s),voltage (kV)', times rising from 0; two rows of "
        "one time are a jump; its path counts from the folder of the design file",
        .required = true),
    DEA_WAVE_CYCLES(struct raw, repeat, "repeat", "how often the table is played", "1"),
};

static const struct dea_csv_wanted columns[2] = {
    [TIME] = {.name = "time",
              .title = "time (s)",
              .measure = {"s", "1 s"},
              .needed = true,
              .filled = true,
              .other = {"t"}},
    [VOLTAGE] = {.name = "voltage",
                 .title = "voltage (kV)",
                 .measure = {"V", "1 kV"},
                 .needed = true,
                 .filled = true,
                 .other = {"v", "u"}},
};

/* Knots of the rows. Errors are findings. */
static dea_status get_rows(struct dea_context *ctx, const struct dea_csv_columns *table,
                           struct dea_waveform *w)
{
  const double *time_s = table->values[TIME], *voltage_V = table->values[VOLTAGE];
  for (size_t i = 0; i < table->rows; i++) {
    const struct dea_location here = {table->file, table->line[i], 1};
    if (i == 0 ? time_s[i] != 0 : time_s[i] < time_s[i - 1]) {
      return dea_finding_add(
          ctx, DEA_ERROR, here,
          i == 0 ? "times start at 0, not at %g s" : "times rise; %g s comes too late", time_s[i]);
    }
    if (!(fabs(voltage_V[i]) <= voltage_max_V)) {
      return dea_finding_add(ctx, DEA_ERROR, here, "a voltage is at most 1 MV");
    }
    dea_wave_add(w, 0, time_s[i], voltage_V[i]);
  }
  const size_t last = table->rows > 0 ? table->rows - 1 : 0;
  return table->rows > 0 && time_s[last] > 0
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR,
                               (struct dea_location){table->file, table->line[last], 1},
                               "a table needs two times at least");
}

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  const struct raw *raw = data;
  struct dea_context *ctx = reader->ctx;
  struct dea_csv_columns table;
  char *path = dea_path_beside(ctx, beside, raw->file.text);
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status =
      path != NULL ? dea_csv_columns_read(ctx, path, columns, 2, NULL, &table) : DEA_E_MEMORY;
  dea_free(ctx, path);
  if (status == DEA_E_IO) { // what is wrong in the file is a finding already
    return dea_finding_count(ctx, DEA_ERROR) > errors
               ? DEA_OK
               : dea_finding_add(ctx, DEA_ERROR, raw->file.location, "file: %s",
                                 dea_context_message(ctx));
  }
  DEA_TRY(ctx, status);
  status = dea_wave_room(ctx, out, table.rows, 1);
  if (status == DEA_OK) {
    dea_wave_open(out, 0, 1, 1);
    status = get_rows(ctx, &table, out);
  }
  dea_csv_columns_free(ctx, &table);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    double length_s = out->knots[out->knot_count - 1].offset_s;
    out->blocks[0].frequency_Hz = 1 / length_s;
    out->blocks[0].cycles = (size_t)raw->repeat.si;
    out->end_s = raw->repeat.si * length_s;
  }
  return status;
}

DEA_WAVE_TYPE(table, "times and voltages from a CSV file", .value = NULL);
