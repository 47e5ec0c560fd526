/* Tables of numbers in a file: lists of lists. */
#include "base/schema_value.h"

/* A number of a row; NAN after a finding. */
static dea_status read_cell(const struct dea_reader *reader, const struct dea_node *node,
                            const char *key, const struct dea_measure *due, double *out)
{
  char why[DEA_WHY_SIZE];
  if (node->kind != DEA_NODE_VALUE || node->empty) {
    return dea_schema_error(reader, node->location, "%s: a number such as '%s' is missing here",
                            key, due->example);
  }
  if (dea_units_read(reader->ctx, node->text, *due, out, why)) {
    return DEA_OK;
  }
  return why[0] == '\0' ? dea_context_status(reader->ctx)
                        : dea_schema_error(reader, node->location, "%s: %s", key, why);
}

/* "[0 mm, 1 N]" */
static void show_row(const struct dea_measure *due, size_t columns, struct dea_text *out)
{
  for (size_t c = 0; c < columns; c++) {
    dea_text_add(out, "%s%s", c > 0 ? ", " : "[", due[c].example);
  }
  dea_text_add(out, "]");
}

static dea_status read_rows(const struct dea_reader *reader, const struct dea_node *node,
                            const char *key, const struct dea_measure *due, size_t columns,
                            const char *example, double *out)
{
  for (const struct dea_node *row = node->child; row != NULL; row = row->next) {
    if (row->kind != DEA_NODE_LIST || row->child_count != columns) {
      DEA_TRY(reader->ctx, dea_schema_error(reader, row->location,
                                            "%s: this must be a list of %zu numbers such as %s",
                                            key, columns, example));
      continue;
    }
    size_t c = 0;
    for (const struct dea_node *cell = row->child; cell != NULL; cell = cell->next, c++) {
      DEA_TRY(reader->ctx, read_cell(reader, cell, key, &due[c], &out[c]));
    }
    out += columns;
  }
  return DEA_OK;
}

dea_status dea_schema_rows(const struct dea_reader *reader, const struct dea_node *node,
                           const char *key, const struct dea_measure *due, size_t columns,
                           size_t least, double **rows, size_t *count)
{
  struct dea_context *ctx = reader->ctx;
  struct dea_text example = {.ctx = ctx};
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status = DEA_OK;
  *rows = NULL;
  *count = node->child_count;
  show_row(due, columns, &example);
  if (node->child_count < least) {
    status = dea_schema_error(reader, node->location,
                              "%s needs %zu or more of lists such as %s, not %zu", key, least,
                              dea_text_get(&example), node->child_count);
  } else {
    *rows = dea_alloc(ctx, node->child_count * columns, sizeof **rows);
    status = *rows != NULL
                 ? read_rows(reader, node, key, due, columns, dea_text_get(&example), *rows)
                 : DEA_E_MEMORY;
  }
  dea_text_free(&example);
  if (status != DEA_OK || dea_finding_count(ctx, DEA_ERROR) > errors) {
    dea_free(ctx, *rows);
    *rows = NULL;
  }
  return status;
}
