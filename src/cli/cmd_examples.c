#define _GNU_SOURCE // GLOB_BRACE
#include "base/file.h"
#include "base/write_file.h"
#include "base/yaml.h"
#include "cli/cli.h"

#include <glob.h>
#include <string.h>

enum { EXAMPLE_SIZE_MAX = 1 << 26 };

struct request {
  const char *name, *folder; // NULL: not given
  bool force;
};

static dea_status read_files(struct dea_context *ctx, const char *folder, const char *ending,
                             const glob_t *found, struct cli_data_list *list)
{
  list->folder = dea_copy_text(ctx, folder, strlen(folder));
  list->files = dea_alloc(ctx, found->gl_pathc, sizeof *list->files);
  DEA_TRY_MEMORY(list->folder != NULL && list->files != NULL);
  for (size_t i = 0; i < found->gl_pathc; i++) {
    const char *path = found->gl_pathv[i];
    if (!dea_text_ends_with(path, ending) || dea_path_is_folder(path)) {
      continue;
    }
    struct cli_data_file *file = &list->files[list->count];
    file->path = dea_copy_text(ctx, path, strlen(path));
    DEA_TRY_MEMORY(file->path != NULL);
    file->name = file->path + strlen(folder) + 1;
    list->count++;
  }
  return DEA_OK;
}

/* Files of a folder, whose own name is taken literally, and of two levels below it
 * (fit/silicone/uniaxial.csv). */
static dea_status find_in(struct dea_context *ctx, const char *folder, const char *ending,
                          struct cli_data_list *list)
{
  glob_t found = {.gl_pathc = 0};
  struct dea_text pattern = {.ctx = ctx};
  for (const char *p = folder; *p != '\0'; p++) {
    dea_text_add(&pattern, "%s%c", strchr("*?[\\{,}", *p) != NULL ? "\\" : "", *p);
  }
  dea_text_add(&pattern, "/{*,*/*,*/*/*}");
  const bool failed =
      pattern.failed || glob(dea_text_get(&pattern), GLOB_BRACE, NULL, &found) == GLOB_NOSPACE;
  dea_text_free(&pattern);
  const dea_status status = failed ? DEA_E_MEMORY : read_files(ctx, folder, ending, &found, list);
  globfree(&found);
  return status;
}

dea_status cli_examples_find(struct dea_context *ctx, const char *ending,
                             struct cli_data_list *list)
{
  static const char *const places[] = {DEA_INSTALL_DATA_DIR "/examples",
                                       DEA_SOURCE_DIR "/examples"};
  *list = (struct cli_data_list){.count = 0};
  for (size_t i = 0; i < 2 && list->count == 0; i++) {
    cli_data_free(ctx, list);
    DEA_TRY(ctx, find_in(ctx, places[i], ending, list));
  }
  return DEA_OK;
}

void cli_data_free(struct dea_context *ctx, struct cli_data_list *list)
{
  for (size_t i = 0; i < list->count; i++) {
    dea_free(ctx, list->files[i].path);
  }
  dea_free(ctx, list->files);
  dea_free(ctx, list->folder);
  *list = (struct cli_data_list){.count = 0};
}

size_t cli_data_stem(const char *name)
{
  const char *dot = strrchr(name, '.');
  return dot != NULL ? (size_t)(dot - name) : strlen(name);
}

/* Prints a name and the top-level key "title" of its file, "" when it has none. */
static dea_status print_title(struct dea_context *ctx, const struct cli_data_file *file)
{
  char *bytes;
  size_t length;
  struct dea_yaml *document = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file->path, DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = dea_yaml_parse(ctx, file->path, bytes, length, &document);
  if (status == DEA_OK) {
    const struct dea_node *title = dea_node_find(dea_yaml_root(document), "title");
    printf("%-18.*s %s\n", (int)cli_data_stem(file->name), file->name,
           title != NULL ? title->text : "");
  }
  dea_yaml_destroy(ctx, document);
  dea_free(ctx, bytes);
  return status;
}

static dea_status list_examples(struct dea_cli *cli, const struct cli_data_list *list)
{
  for (size_t i = 0; i < list->count; i++) {
    DEA_TRY(cli->ctx, print_title(cli->ctx, &list->files[i]));
  }
  if (!cli->quiet) {
    fprintf(stderr, "\nStart with one of them:  dea examples NAME > my.yaml && dea run my.yaml\n");
  }
  return DEA_OK;
}

/* File that a name means: "paper/fig02", "fig02" or either with ".yaml"; NULL when none. */
static const struct cli_data_file *find_example(const struct cli_data_list *list, const char *name)
{
  const size_t length = strlen(name) - (dea_text_ends_with(name, ".yaml") ? strlen(".yaml") : 0);
  for (size_t i = 0; i < list->count; i++) {
    const char *whole = list->files[i].name, *last = dea_path_name(whole);
    if ((cli_data_stem(whole) == length && strncmp(whole, name, length) == 0) ||
        (cli_data_stem(last) == length && strncmp(last, name, length) == 0)) {
      return &list->files[i];
    }
  }
  return NULL;
}

static dea_status unknown_example(struct dea_context *ctx, const struct cli_data_list *list,
                                  const char *name)
{
  const char **names = dea_alloc(ctx, list->count, sizeof *names);
  DEA_TRY_MEMORY(names != NULL);
  const char *nearest = NULL;
  for (size_t i = 0; i < list->count; i++) {
    list->files[i].name[cli_data_stem(list->files[i].name)] = '\0';
    names[i] = list->files[i].name;
  }
  nearest = dea_nearest_name(name, names, list->count);
  for (size_t i = 0; i < list->count && nearest == NULL; i++) {
    nearest = strstr(names[i], name) != NULL ? names[i] : NULL;
  }
  dea_free(ctx, names);
  return nearest != NULL ? dea_fail(ctx, DEA_E_USAGE,
                                    "there is no example '%s'; did you mean '%s'?", name, nearest)
                         : dea_fail(ctx, DEA_E_USAGE,
                                    "there is no example '%s'; 'dea examples' lists them", name);
}

/* Copies an example into a folder; NULL: to stdout. */
static dea_status copy_one(struct dea_context *ctx, const struct cli_data_file *file,
                           const char *folder, bool force)
{
  char *bytes;
  size_t length;
  DEA_TRY(ctx, dea_file_read(ctx, file->path, EXAMPLE_SIZE_MAX, &bytes, &length));
  dea_status status = DEA_OK;
  if (folder == NULL) {
    fwrite(bytes, 1, length, stdout);
  } else {
    char parent[DEA_PATH_SIZE];
    status = dea_path_build(ctx, folder, file->name, parent);
    parent[dea_path_name(parent) - parent] = '\0';
    status = status == DEA_OK ? dea_folder_create(ctx, parent) : status;
    status = status == DEA_OK ? dea_path_create_folders(ctx, folder, file->name, force) : status;
    status =
        status == DEA_OK ? dea_file_write_into(ctx, folder, file->name, bytes, length) : status;
  }
  dea_free(ctx, bytes);
  return status;
}

static dea_status copy_all(struct dea_cli *cli, const char *folder, bool force)
{
  struct cli_data_list list;
  dea_status status = cli_examples_find(cli->ctx, "", &list);
  for (size_t i = 0; i < list.count && status == DEA_OK; i++) {
    status = copy_one(cli->ctx, &list.files[i], folder, force);
    if (status == DEA_OK && !cli->quiet) {
      fprintf(stderr, "%s/%s\n", folder, list.files[i].name);
    }
  }
  cli_data_free(cli->ctx, &list);
  return status;
}

static dea_status show(struct dea_cli *cli, const char *name)
{
  struct cli_data_list list;
  dea_status status = cli_examples_find(cli->ctx, ".yaml", &list);
  if (status == DEA_OK && list.count == 0) {
    status = dea_fail(cli->ctx, DEA_E_IO, "no examples were found in %s", list.folder);
  }
  if (status == DEA_OK && name != NULL) {
    const struct cli_data_file *file = find_example(&list, name);
    status = file != NULL ? copy_one(cli->ctx, file, NULL, false)
                          : unknown_example(cli->ctx, &list, name);
  } else if (status == DEA_OK) {
    status = list_examples(cli, &list);
  }
  cli_data_free(cli->ctx, &list);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  if (request->folder != NULL && request->folder[0] == '\0') {
    return cli_usage_error(cli, "--copy needs a folder");
  }
  if (request->folder != NULL && request->name != NULL) {
    return cli_usage_error(cli, "'%s' is one argument too many", request->name);
  }
  return request->folder != NULL ? copy_all(cli, request->folder, request->force)
                                 : show(cli, request->name);
}

static const struct cli_option options[] = {
    {NULL, 0, CLI_EXAMPLE, "EXAMPLE", "print this design file to standard output", CLI_AT(name)},
    {"copy", 0, CLI_FOLDER, "DIR", "copy all examples to a folder", CLI_AT(folder)},
    CLI_FORCE_ROW('f', "overwrite files that are there"),
    {0}};

const struct dea_command cmd_examples = {
    .name = "examples",
    .summary = "List the example designs, print one, or copy all of them",
    .about = "Without arguments the examples are listed with their titles.",
    CLI_RUN};
