#include "identify/fit.h"

#include "base/csv_line.h"
#include "base/file.h"
#include "result/provenance.h"
#include "table/csv_columns.h"

#include <stdio.h>
#include <string.h>

/* The other column that says the same; -1: there is none. */
static int twin_of(int column)
{
  static const int twins[DEA_FIT_COLUMNS] = {
      [DEA_FIT_TIME] = -1,
      [DEA_FIT_STRETCH] = DEA_FIT_DISPLACEMENT,
      [DEA_FIT_DISPLACEMENT] = DEA_FIT_STRETCH,
      [DEA_FIT_STRESS] = DEA_FIT_FORCE,
      [DEA_FIT_FORCE] = DEA_FIT_STRESS,
      [DEA_FIT_STRESS_STD] = DEA_FIT_FORCE_STD,
      [DEA_FIT_FORCE_STD] = DEA_FIT_STRESS_STD,
  };
  return twins[column];
}

/* What a test wants of its file, by the titles that it names. */
static void want(const struct dea_fit_test *test, char names[][DEA_CSV_FIELD_MAX],
                 struct dea_csv_wanted *wanted)
{
  for (int c = 0; c < DEA_FIT_COLUMNS; c++) {
    const struct dea_fit_column_type *type = &dea_fit_columns[c];
    const char *title = test->columns[c].text;
    char unit[DEA_CSV_FIELD_MAX];
    dea_csv_split_title(title[0] != '\0' ? title : type->key, names[c], unit);
    wanted[c] = (struct dea_csv_wanted){.name = names[c],
                                        .title = title[0] != '\0' ? title : type->example,
                                        .measure = {type->unit, type->example},
                                        .needed = title[0] != '\0',
                                        .filled = true,
                                        .strain = c == DEA_FIT_STRETCH};
    const int twin = twin_of(c); // another title for the same was chosen
    if (title[0] == '\0' && twin >= 0 && test->columns[twin].text[0] != '\0') {
      wanted[c].name = " "; // none has that
      wanted[c].strain = false;
    }
  }
  for (int c = 0; c < DEA_FIT_COLUMNS && test->use.value == DEA_FIT_PREDICTED; c++) {
    const bool result = c >= DEA_FIT_STRESS;
    wanted[c].filled = !result;
    wanted[c].needed = wanted[c].needed && !result;
  }
}

static dea_status read_path(struct dea_arena *arena, const struct dea_fit_test *test,
                            const char *path, struct dea_fit_series *out)
{
  char names[DEA_FIT_COLUMNS][DEA_CSV_FIELD_MAX];
  struct dea_csv_wanted wanted[DEA_FIT_COLUMNS];
  struct dea_csv_columns columns;
  struct dea_fit_raw raw = {0};
  want(test, names, wanted);
  dea_sha256_file(path, raw.sha256);
  DEA_TRY(arena->ctx,
          dea_csv_columns_read(arena->ctx, path, wanted, DEA_FIT_COLUMNS, NULL, &columns));
  raw.file = columns.file;
  raw.rows = columns.rows;
  raw.line = columns.line;
  for (int c = 0; c < DEA_FIT_COLUMNS; c++) {
    raw.values[c] = columns.values[c];
  }
  dea_status status = dea_fit_series_build(arena, test, &raw, out);
  dea_csv_columns_free(arena->ctx, &columns);
  return status;
}

static dea_status read_test(struct dea_arena *arena, const struct dea_fit_file *file,
                            const struct dea_fit_test *test, struct dea_fit_series *out)
{
  char *path = dea_path_beside(arena->ctx, file->head.file, test->file.text);
  dea_status status = path != NULL ? read_path(arena, test, path, out) : DEA_E_MEMORY;
  dea_free(arena->ctx, path);
  return status;
}

/* All of them, for all that is wrong. */
static dea_status read_tests(struct dea_arena *arena, const struct dea_fit_file *file,
                             struct dea_fit_series *series)
{
  dea_status worst = series != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < file->test_count && series != NULL; i++) {
    dea_status status = read_test(arena, file, &file->tests[i], &series[i]);
    worst = status != DEA_OK ? status : worst;
  }
  return worst;
}

dea_status dea_fit_file_run(struct dea_context *ctx, const struct dea_fit_file *file,
                            const struct dea_fit_options *options, struct dea_fit **out)
{
  struct dea_arena tests = {.ctx = ctx};
  struct dea_fit_series *series = dea_arena_alloc(&tests, file->test_count, sizeof *series);
  *out = NULL;
  dea_status status = read_tests(&tests, file, series);
  status =
      status == DEA_OK ? dea_fit_run(ctx, file, series, file->test_count, options, out) : status;
  if (status != DEA_OK) {
    dea_arena_free(&tests);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  (*out)->tests = tests;
  return DEA_OK;
}
