#define _POSIX_C_SOURCE 200809L // mkdir
#include "base/file.h"
#include "base/text.h"
#include "cli/cli.h"
#include "cli/data_files.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

struct request {
  const char *name, *folder; // NULL: not given
  bool force;
};

/* Value of the top-level key "title" of a YAML file; "" when it has none. */
static void read_title(const char *path, char *title, size_t size)
{
  title[0] = '\0';
  FILE *file = fopen(path, "rb");
  yaml_parser_t parser;
  if (file == NULL || yaml_parser_initialize(&parser) == 0) {
    if (file != NULL) {
      fclose(file);
    }
    return;
  }
  yaml_parser_set_input_file(&parser, file);
  yaml_document_t document;
  if (yaml_parser_load(&parser, &document) != 0) {
    yaml_node_t *root = yaml_document_get_root_node(&document);
    if (root != NULL && root->type == YAML_MAPPING_NODE) {
      for (yaml_node_pair_t *pair = root->data.mapping.pairs.start;
           pair < root->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key = yaml_document_get_node(&document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(&document, pair->value);
        if (key->type == YAML_SCALAR_NODE && value->type == YAML_SCALAR_NODE &&
            strcmp((const char *)key->data.scalar.value, "title") == 0) {
          snprintf(title, size, "%s", (const char *)value->data.scalar.value);
        }
      }
    }
    yaml_document_delete(&document);
  }
  yaml_parser_delete(&parser);
  fclose(file);
}

static int list_examples(struct dea_cli *cli, const struct cli_data_list *list)
{
  for (size_t i = 0; i < list->count; i++) {
    char title[256];
    read_title(list->files[i].path, title, sizeof title);
    printf("%-18.*s %s\n", (int)cli_data_stem(list->files[i].name), list->files[i].name, title);
  }
  if (!cli->quiet) {
    fprintf(stderr, "\nStart with one of them:  dea examples NAME > my.yaml && dea run my.yaml\n");
  }
  return 0;
}

/* File that a name means: "paper/fig02", "fig02" or either with ".yaml"; NULL when none. */
static const struct cli_data_file *find_example(const struct cli_data_list *list, const char *name)
{
  size_t length = strlen(name);
  if (length > 5 && strcmp(name + length - 5, ".yaml") == 0) {
    length -= 5;
  }
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

/* Copies a file to an open stream; name: of the stream, for messages. */
static dea_status copy_to(struct dea_context *ctx, const char *from, FILE *out, const char *name)
{
  FILE *in = fopen(from, "rb");
  if (in == NULL) {
    return dea_fail(ctx, DEA_E_IO, "cannot read %s: %s", from, strerror(errno));
  }
  char block[4096];
  size_t n;
  bool written = true;
  while (written && (n = fread(block, 1, sizeof block, in)) > 0) {
    written = fwrite(block, 1, n, out) == n;
  }
  bool read = ferror(in) == 0;
  fclose(in);
  if (!read) {
    return dea_fail(ctx, DEA_E_IO, "cannot read %s", from);
  }
  if (!written || fflush(out) != 0) {
    return dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", name, strerror(errno));
  }
  return DEA_OK;
}

/* Makes the folders in `path` that come before its last "/". */
static dea_status create_parents(struct dea_context *ctx, char *path)
{
  for (char *p = strchr(path + 1, '/'); p != NULL; p = strchr(p + 1, '/')) {
    *p = '\0';
    int code = mkdir(path, 0777) == 0 || errno == EEXIST ? 0 : errno;
    if (code != 0) {
      dea_fail(ctx, DEA_E_IO, "cannot make the folder %s: %s", path, strerror(code));
    }
    *p = '/';
    if (code != 0) {
      return DEA_E_IO;
    }
  }
  return DEA_OK;
}

static dea_status copy_one(struct dea_context *ctx, const struct cli_data_file *file,
                           const char *folder, bool force)
{
  struct dea_text path = {.ctx = ctx};
  dea_text_add(&path, "%s/%s", folder, file->name);
  if (path.failed) {
    dea_text_free(&path);
    return DEA_E_MEMORY;
  }
  dea_status status = create_parents(ctx, path.data);
  status = status == DEA_OK ? dea_path_check_target(ctx, path.data) : status;
  FILE *out = status == DEA_OK ? fopen(path.data, force ? "wb" : "wbx") : NULL;
  if (status == DEA_OK && out == NULL) {
    status = dea_fail(ctx, DEA_E_IO, "cannot write %s: %s%s", path.data, strerror(errno),
                      errno == EEXIST ? " (--force overwrites)" : "");
  }
  if (out != NULL) {
    status = copy_to(ctx, file->path, out, path.data);
    if (fclose(out) != 0 && status == DEA_OK) {
      status = dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", path.data, strerror(errno));
    }
  }
  dea_text_free(&path);
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

static int show(struct dea_cli *cli, const char *name)
{
  struct cli_data_list list;
  int code;
  dea_status status = cli_examples_find(cli->ctx, ".yaml", &list);
  if (status == DEA_OK && list.count == 0) {
    status = dea_fail(cli->ctx, DEA_E_IO, "no examples were found in %s", list.folder);
  }
  if (status == DEA_OK && name != NULL) {
    const struct cli_data_file *file = find_example(&list, name);
    status = file != NULL ? copy_to(cli->ctx, file->path, stdout, "standard output")
                          : unknown_example(cli->ctx, &list, name);
  }
  if (status == DEA_OK && name == NULL) {
    code = list_examples(cli, &list);
  } else {
    code = cli_report(cli, status);
  }
  cli_data_free(cli->ctx, &list);
  return code;
}

static int run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  if (request->folder != NULL && request->folder[0] == '\0') {
    return cli_usage_error(cli, &cmd_examples, "--copy needs a folder");
  }
  if (request->folder != NULL && request->name != NULL) {
    return cli_usage_error(cli, &cmd_examples, "'%s' is one argument too many", request->name);
  }
  return request->folder != NULL ? cli_report(cli, copy_all(cli, request->folder, request->force))
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
