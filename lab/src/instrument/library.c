#include "instrument/library.h"

#include "base/file.h"
#include "base/schema_value.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What may be loaded -----------------------------------------------------------------------------

enum { LISTED_MAX = 32, LIST_SIZE_MAX = 1 << 16 };

struct list {
  struct dea_label libraries[LISTED_MAX];
  size_t count;
};

static const struct dea_field fields[] = {
    DEA_LABEL_ROW("libraries", offsetof(struct list, libraries), "[/opt/ni/lib/libnidaqmx.so.1]",
                  "libraries that protocols may name besides the usual ones",
                  DEA_LIST(0, LISTED_MAX, struct dea_label, offsetof(struct list, count))),
};
static const struct dea_record record = {"list", "what instruments may load", fields, 1};

/* Name of the user's own list; false when there is no place for it. */
static bool name_list(char out[DEA_PATH_SIZE])
{
  const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
  bool own = config != NULL && config[0] == '/';
  if (!own && home == NULL) {
    return false;
  }
  int length = snprintf(out, DEA_PATH_SIZE, "%s%s/dea/instruments.yaml", own ? config : home,
                        own ? "" : "/.config");
  return length < DEA_PATH_SIZE;
}

/* Whether the list has it. What is wrong with the list is a finding. */
static dea_status find_symbol(struct dea_context *ctx, const char *file, const char *text,
                              size_t length, const char *wanted, bool *found)
{
  struct dea_yaml *yaml;
  struct list list = {.count = 0};
  dea_status status = dea_yaml_parse(ctx, file, text, length, &yaml);
  if (status != DEA_OK) {
    return status == DEA_E_DESIGN ? DEA_OK : status;
  }
  const struct dea_reader reader = {ctx, yaml, NULL};
  status = dea_schema_read(&reader, &record, dea_yaml_root(yaml), "", &list);
  for (size_t i = 0; i < list.count && status == DEA_OK; i++) {
    const char *name = list.libraries[i].text;
    if (strchr(name, '/') != NULL && name[0] != '/') {
      status = dea_schema_error(&reader, list.libraries[i].location,
                                "write the whole path of '%.60s', or its name alone: which file it "
                                "is must not depend on where dea runs",
                                name);
    } else {
      *found = *found || strcmp(name, wanted) == 0;
    }
  }
  dea_yaml_destroy(ctx, yaml);
  return status;
}

dea_status dea_library_check(const struct dea_reader *reader, const struct dea_label *file,
                             const char *usual)
{
  struct dea_context *ctx = reader->ctx;
  char path[DEA_PATH_SIZE], *text;
  size_t length;
  bool found = strcmp(file->text, usual) == 0, named = name_list(path);
  if (!found && named) {
    dea_status status = dea_file_read(ctx, path, LIST_SIZE_MAX, &text, &length);
    if (status == DEA_OK) {
      status = find_symbol(ctx, path, text, length, file->text, &found);
      dea_free(ctx, text);
    } else if (status == DEA_E_IO) { // there is none
      dea_context_clear(ctx);
      status = DEA_OK;
    }
    DEA_TRY(ctx, status);
  }
  if (found) {
    return DEA_OK;
  }
  return dea_schema_error(reader, file->location,
                          "refused: '%.100s' is neither %s nor on your own list, and loading it "
                          "runs its code; if you trust it, write 'libraries: [%.100s]' into %.200s",
                          file->text, usual, file->text,
                          named ? path : "~/.config/dea/instruments.yaml");
}

// Loading ----------------------------------------------------------------------------------------

dea_status dea_library_open(struct dea_context *ctx, const char *file, const char *what,
                            const char *advice, const struct dea_library_symbol *symbols,
                            size_t count, void *table)
{
  void *handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (handle == NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "%s is not on this computer (%.200s): %s", what,
                    dlerror(), advice);
  }
  for (size_t i = 0; i < count; i++) {
    void *symbol = dlsym(handle, symbols[i].name);
    if (symbol == NULL) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "%s has no function %s in %.200s: %s", what,
                      symbols[i].name, file, advice);
    }
    // As bytes: C knows no conversion of a data pointer to one of a function.
    memcpy((char *)table + symbols[i].offset, &symbol, sizeof symbol);
  }
  return DEA_OK;
}
