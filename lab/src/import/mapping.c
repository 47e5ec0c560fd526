#include "import/mapping.h"

#include "base/file.h"

#include <ctype.h>
#include <math.h>

#define AT(member) offsetof(struct dea_mapping, member)
#define OF(member) offsetof(struct dea_mapped, member)

static const struct dea_field column_fields[] = {
    DEA_LABEL_ROW("column", OF(column), "Dev1/ai0",
                  "name of the column, as `dea import --list` shows it", .required = true),
    DEA_CHOICE_ROW("as", OF(as), dea_channel_names, "voltage", "what it is", .required = true),
    DEA_LABEL_ROW("name", OF(name), "high voltage", "name of the channel",
                  .absent_text = "the column's name", .one_line = true),
    DEA_LABEL_ROW("unit", OF(unit), "kV", "unit of the column's numbers",
                  .absent_text = "the file's"),
    DEA_LABEL_ROW(
        "per_unit", OF(per_unit), "1 kV",
        "what 1 in the column stands for: a quantity, or a number of its units; a monitor of "
        "1 V a kV: 1 kV",
        .absent_text = "1"),
    DEA_LABEL_ROW("at_zero", OF(at_zero), "-2.5 mm", "what 0 in the column stands for",
                  .absent_text = "0"),
    DEA_LABEL_ROW("time", OF(time), "t laser", "column with the times of this one",
                  .absent_text = "that of all"),
    DEA_NUMBER_ROW("filter", OF(filter_Hz), "Hz", "200 Hz", "low-pass that `dea reduce` applies",
                   .max = 1e9, .above_min = true, .absent_text = "none"),
};
static const struct dea_record column_record = {"columns", "a column that becomes a channel",
                                                column_fields, DEA_COUNT(column_fields)};

static const struct dea_field profile_fields[] = {
    DEA_LABEL_ROW("columns", AT(profile.columns), "z*",
                  "names of the points' columns in their order, * for any text", .required = true),
    DEA_LABEL_ROW("unit", AT(profile.unit), "mm", "unit of the heights",
                  .absent_text = "the file's"),
    DEA_LABEL_ROW("per_unit", AT(profile.per_unit), "-1",
                  "what 1 stands for; negative for a sensor that looks from below",
                  .absent_text = "1"),
    DEA_LABEL_ROW("at_zero", AT(profile.at_zero), "0 mm", "what 0 stands for", .absent_text = "0"),
    DEA_FIELD_ROW(NUMBER, "x_from", AT(profile.x_from_m), .unit = "m",
                  .doc = "where the first point is along the line", .example = "-15 mm"),
    DEA_FIELD_ROW(NUMBER, "x_to", AT(profile.x_to_m), .unit = "m", .doc = "where the last one is",
                  .example = "15 mm"),
    DEA_LABEL_ROW("x", AT(profile.x), "x",
                  "column with a place for each point, in place of x_from and x_to",
                  .absent_text = "x_from to x_to"),
    DEA_LABEL_ROW("x_unit", AT(profile.x_unit), "mm", "unit of that column",
                  .absent_text = "the file's"),
    DEA_LABEL_ROW("time", AT(profile.time), "frame time", "column with the times of the frames",
                  .absent_text = "that of all"),
};
static const struct dea_record profile_record = {"profile",
                                                 "columns that are the points of a profile sensor",
                                                 profile_fields, DEA_COUNT(profile_fields)};

static const struct dea_field mapping_fields[] = {
    DEA_INTEGER_ROW("dea-import", AT(version), "1", "version of the format of mappings",
                    .min = DEA_MAPPING_VERSION, .max = DEA_MAPPING_VERSION, .required = true),
    DEA_LABEL_ROW("title", AT(title), "FRDEA-4, 1 Hz", "what was measured", .absent_text = "none",
                  .one_line = true),
    DEA_NUMBER_ROW("rate", AT(rate_Hz), "Hz", "10 kHz", "samples a second, of a file without times",
                   .max = 1e12, .above_min = true, .group = 1, .option = 1,
                   .absent_text = "from the file"),
    DEA_LABEL_ROW("time", AT(time), "Time", "column with the times", .group = 1, .option = 2,
                  .absent_text = "guessed"),
    DEA_LABEL_ROW("time_unit", AT(time_unit), "ms", "unit of the times",
                  .absent_text = "the file's, else s"),
    DEA_FIELD_ROW(RECORD, "columns", AT(columns), .record = &column_record, .absent_text = "none",
                  .doc = "columns that become channels",
                  .example = "[{column: Dev1/ai0, as: voltage, per_unit: 1 kV}]",
                  DEA_LIST(0, DEA_MAPPED_MAX, struct dea_mapped, AT(column_count))),
    DEA_FIELD_ROW(RECORD, "profile", 0, .record = &profile_record,
                  .present_offset = AT(has_profile), .absent_text = "none",
                  .doc = "columns that are the points of a profile sensor, a frame a row"),
    DEA_LABEL_ROW("ignore", AT(ignore), "[Comment, Dev1/ai7]",
                  "columns to leave without a note, * for any text", .list_max = DEA_IGNORED_MAX,
                  .element_size = sizeof(struct dea_label), .count_offset = AT(ignore_count),
                  .absent_text = "none"),
};

const struct dea_record dea_mapping_record = {"mapping",
                                              "what the columns of a measurement's file mean",
                                              mapping_fields, DEA_COUNT(mapping_fields)};

bool dea_mapping_matches(const char *name, const char *wanted, bool pattern)
{
  const char *star = NULL, *again = NULL; // the last '*', and where what follows it was tried
  while (*name != '\0') {
    if (pattern && *wanted == '*') {
      star = wanted++;
      again = name;
    } else if (tolower((unsigned char)*name) == tolower((unsigned char)*wanted)) {
      name++;
      wanted++;
    } else if (star != NULL) {
      wanted = star + 1;
      name = ++again;
    } else {
      return false;
    }
  }
  while (pattern && *wanted == '*') {
    wanted++;
  }
  return *wanted == '\0';
}

/* What the schema cannot say. */
static dea_status check(struct dea_context *ctx, const struct dea_mapping *mapping)
{
  for (size_t i = 0; i < mapping->column_count; i++) {
    const struct dea_label *name = &mapping->columns[i].column;
    for (size_t k = 0; k < i && name->text[0] != '\0'; k++) {
      if (dea_mapping_matches(mapping->columns[k].column.text, name->text, false)) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, name->location,
                                     "the column '%.60s' is taken in line %zu already", name->text,
                                     mapping->columns[k].column.location.line));
      }
    }
  }
  if (!mapping->has_profile) {
    return DEA_OK;
  }
  bool named = mapping->profile.x.text[0] != '\0';
  bool from = !isnan(mapping->profile.x_from_m.si), to = !isnan(mapping->profile.x_to_m.si);
  if (named ? from || to : !from || !to) {
    return dea_finding_add(ctx, DEA_ERROR, mapping->profile.columns.location,
                           "profile: where its points are is said by x_from and x_to, or by x");
  }
  if (!named && mapping->profile.x_from_m.si == mapping->profile.x_to_m.si) {
    return dea_finding_add(ctx, DEA_ERROR, mapping->profile.x_to_m.location,
                           "x_to is where x_from is");
  }
  return DEA_OK;
}

static dea_status read_bytes(struct dea_context *ctx, const char *bytes, size_t length,
                             struct dea_mapping *mapping)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx, dea_yaml_parse(ctx, mapping->file, bytes, length, &mapping->document));
  struct dea_reader reader = {ctx, mapping->document, NULL};
  const struct dea_node *root = dea_yaml_root(mapping->document);
  DEA_TRY(ctx, dea_schema_read(&reader, &dea_mapping_record, root, "", mapping));
  DEA_TRY(ctx, root->kind == DEA_NODE_SECTION ? check(ctx, mapping) : DEA_OK);
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "'%s' has %zu error%s", mapping->file, found,
                    found > 1 ? "s" : "");
  }
  return DEA_OK;
}

dea_status dea_mapping_read_memory(struct dea_context *ctx, const char *file, const char *bytes,
                                   size_t length, struct dea_mapping **out)
{
  *out = NULL;
  struct dea_mapping *mapping = dea_alloc(ctx, 1, sizeof *mapping);
  DEA_TRY_MEMORY(mapping != NULL);
  mapping->file = dea_intern(ctx, file);
  dea_status status =
      mapping->file != NULL ? read_bytes(ctx, bytes, length, mapping) : DEA_E_MEMORY;
  DEA_TRY_ELSE(ctx, status, dea_mapping_destroy(ctx, mapping));
  *out = mapping;
  return DEA_OK;
}

dea_status dea_mapping_read(struct dea_context *ctx, const char *file, struct dea_mapping **out)
{
  char *bytes;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = dea_mapping_read_memory(ctx, file, bytes, length, out);
  dea_free(ctx, bytes);
  return status;
}

void dea_mapping_destroy(struct dea_context *ctx, struct dea_mapping *mapping)
{
  if (mapping != NULL) {
    dea_yaml_destroy(ctx, mapping->document);
    dea_free(ctx, mapping);
  }
}
