/* The specimen's own file: what it stands, which no option of a command changes. */
#include "base/file.h"
#include "base/schema_value.h"
#include "protocol/protocol_schema.h"

#include <math.h>

struct raw {
  struct dea_quantity version, highest_V;
  struct dea_label name, note;
};

static const struct dea_field fields[] = {
    DEA_INTEGER_ROW("dea-specimen", offsetof(struct raw, version), "1",
                    "version of the format of specimens", .min = 1, .max = 1, .required = true),
    DEA_LABEL_ROW("name", offsetof(struct raw, name), "F12", "what is written on it",
                  .required = true, .one_line = true),
    DEA_NUMBER_ROW("max_voltage", offsetof(struct raw, highest_V), "V", "6 kV",
                   "largest voltage that it may see, of either sign", .above_min = true, .max = 1e6,
                   .required = true),
    DEA_LABEL_ROW("note", offsetof(struct raw, note), "cleared once at 6.2 kV",
                  "why that voltage; what has happened to it", .absent_text = "none"),
};
static const struct dea_record record = {"specimen", "what one film stands", fields,
                                         sizeof fields / sizeof fields[0]};

static dea_status read_text(struct dea_context *ctx, const char *path, const char *text,
                            size_t length, struct dea_specimen *out)
{
  struct dea_yaml *yaml;
  struct raw raw = {.version.si = 0};
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status = dea_yaml_parse(ctx, path, text, length, &yaml);
  if (status != DEA_OK) {
    return status == DEA_E_DESIGN ? DEA_OK : status;
  }
  const struct dea_reader reader = {ctx, yaml, NULL};
  status = dea_schema_read(&reader, &record, dea_yaml_root(yaml), "", &raw);
  dea_yaml_destroy(ctx, yaml);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    *out = (struct dea_specimen){raw.name, raw.highest_V};
  }
  return status;
}

dea_status dea_specimen_read(struct dea_context *ctx, const char *beside,
                             const struct dea_label *file, struct dea_specimen *out)
{
  char *text = NULL;
  size_t length;
  *out = (struct dea_specimen){.highest_V = {NAN, DEA_ABSENT, file->location}};
  if (file->origin == DEA_OVERRIDE) {
    return dea_finding_add(ctx, DEA_ERROR, file->location,
                           "specimen: only the protocol itself says which specimen it is for; no "
                           "option changes that");
  }
  if (file->origin == DEA_ABSENT) {
    return DEA_OK;
  }
  char *path = dea_path_beside(ctx, beside, file->text);
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = dea_file_read(ctx, path, DEA_YAML_SIZE_MAX, &text, &length);
  if (status == DEA_OK) {
    status = read_text(ctx, path, text, length, out);
  } else if (status == DEA_E_IO) {
    status = dea_finding_add(ctx, DEA_ERROR, file->location,
                             "specimen: %s; a path counts from the protocol's folder",
                             dea_context_message(ctx));
  }
  dea_free(ctx, text);
  dea_free(ctx, path);
  return status == DEA_E_DESIGN ? DEA_OK : status; // counted with the others
}
