#include "cli/cli.h"

#include "base/text.h"
#include "material/catalogue.h"

#include <math.h>
#include <string.h>

struct request {
  const char *name; // NULL: all
  bool json;
};

static const char *const kind_names[] = {"elastomer", "plastic", "electrode"};

static const char *kind_of(const struct dea_material_data *data)
{
  return data->kind.value >= 0 ? kind_names[data->kind.value] : "";
}

/* One line of the list of all materials. */
static void print_line(const struct dea_material_data *data)
{
  printf("%-28s %-10s %s\n", data->name.text, kind_of(data), data->title.text);
  for (size_t i = 0; i < data->law_count; i++) {
    printf("%-28s   law %s (%s)%s\n", "", data->laws[i].id.text, data->laws[i].law_name.text,
           i == 0 && data->law_count > 1 ? ", default" : "");
  }
  for (size_t i = 0; i < data->permittivity_count; i++) {
    printf("%-28s   permittivity %s%s\n", "", data->permittivity[i].id.text,
           i == 0 && data->permittivity_count > 1 ? ", default" : "");
  }
}

/* Last key of a path: "laws[0].parameters.c1" -> "c1". */
static const char *leaf(const char *path)
{
  const char *dot = strrchr(path, '.');
  return dot != NULL ? dot + 1 : path;
}

/* Length of the section that a path belongs to: everything before its last key. The parameters of a
 * law are shown with its set. */
static size_t section_length(const char *path)
{
  const char *dot = strrchr(path, '.');
  size_t length = dot != NULL ? (size_t)(dot - path) : 0;
  const char parameters[] = ".parameters";
  size_t tail = sizeof parameters - 1;
  return length > tail && strncmp(path + length - tail, parameters, tail) == 0 ? length - tail
                                                                               : length;
}

/* True when the item belongs to the section `path[0 .. length)`. */
static bool in_section(const struct dea_listed *item, const char *path, size_t length)
{
  return section_length(item->path) == length && strncmp(item->path, path, length) == 0;
}

/* Values of one section, in the words of the file; prose comes after the numbers. */
static void add_section(struct dea_text *out, const struct dea_listing *listing, const char *path,
                        size_t length)
{
  static const char *const prose[] = {"uncertainty", "range", "source", "note"};
  const size_t prose_count = sizeof prose / sizeof prose[0];
  for (size_t pass = 0; pass <= prose_count; pass++) {
    for (size_t i = 0; i < listing->count; i++) {
      if (!in_section(&listing->items[i], path, length)) {
        continue;
      }
      const char *key = leaf(listing->items[i].path);
      size_t which = 0;
      while (which < prose_count && strcmp(prose[which], key) != 0) {
        which++;
      }
      if ((pass == 0 && which == prose_count) || (pass > 0 && which == pass - 1)) {
        const char *text = listing->items[i].text;
        size_t before = out->length;
        dea_text_add(out, "    %-14s ", key);
        cli_add_wrapped(out, (int)(out->length - before), text, strlen(text));
      }
    }
  }
}

static void add_material(struct dea_text *out, const struct dea_catalogue_entry *entry)
{
  const struct dea_listing *listing = &entry->listing;
  const struct dea_material_data *data = &entry->data;
  dea_text_add(out, "%s (%s)\n%s\n%s\n", data->name.text, kind_of(data), data->title.text,
               entry->file);
  for (size_t i = 0; i < listing->count; i++) {
    const char *path = listing->items[i].path;
    size_t length = section_length(path), before = 0;
    if (length == 0) {
      if (listing->items[i].origin == DEA_ABSENT) {
        dea_text_add(out, "\n  %s: %s\n", path, listing->items[i].text);
      }
      continue;
    }
    while (!in_section(&listing->items[before], path, length)) {
      before++;
    }
    if (before == i) { // the first of its section
      dea_text_add(out, "\n  %.*s\n", (int)length, path);
      add_section(out, listing, path, length);
    }
  }
}

static json_t *material_json(const struct dea_catalogue_entry *entry)
{
  const struct dea_listing *listing = &entry->listing;
  json_t *values = json_array();
  for (size_t i = 0; i < listing->count; i++) {
    const struct dea_listed *value = &listing->items[i];
    json_t *row = json_pack("{s:s, s:s}", "key", value->path, "text", value->text);
    if (value->unit != NULL && !isnan(value->si)) {
      json_object_set_new(row, "si", json_real(value->si));
      json_object_set_new(row, "unit", json_string(value->unit));
    }
    json_array_append_new(values, row);
  }
  return json_pack("{s:s, s:s, s:s, s:s, s:o}", "name", entry->data.name.text, "title",
                   entry->data.title.text, "kind", kind_of(&entry->data), "file", entry->file,
                   "values", values);
}

/* Prints one material or adds it to an array. */
static dea_status show(struct dea_cli *cli, const char *name, bool whole, json_t *array)
{
  struct dea_text out = {.ctx = cli->ctx};
  struct dea_catalogue_entry *entry;
  DEA_TRY(cli->ctx, dea_catalogue_read(cli->ctx, name, (struct dea_location){0}, &entry));
  if (array != NULL) {
    json_array_append_new(array, material_json(entry));
  } else if (whole) {
    add_material(&out, entry);
  } else {
    print_line(&entry->data);
  }
  dea_catalogue_destroy(cli->ctx, entry);
  return cli_print_text(DEA_OK, &out);
}

/* Shows all; one file with errors does not hide the others. */
static dea_status show_all(struct dea_cli *cli, json_t *array)
{
  const char **names;
  size_t count;
  dea_status worst = DEA_OK;
  DEA_TRY(cli->ctx, dea_catalogue_names(cli->ctx, &names, &count));
  for (size_t i = 0; i < count; i++) {
    dea_status status = show(cli, names[i], false, array);
    worst = status != DEA_OK ? status : worst;
  }
  dea_free(cli->ctx, names);
  return worst;
}

static int run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  json_t *array = request->json ? json_array() : NULL;
  dea_status status =
      request->name != NULL ? show(cli, request->name, true, array) : show_all(cli, array);
  if (request->json) {
    cli_print_json(array);
  }
  fflush(stdout);
  return cli_report(cli, status);
}

static const struct cli_option options[] = {
    {NULL, 0, CLI_MATERIAL, "NAME", "this material with all that is known of it", CLI_AT(name)},
    CLI_JSON_ROW("as JSON"),
    {0}};

const struct dea_command cmd_materials = {
    .name = "materials",
    .summary = "List the materials of the catalogue, or show one with all its numbers and sources",
    .about = "Own materials: put NAME.yaml into a directory that the environment variable "
             "DEA_MATERIALS names (several, separated by colons). What such a file holds says "
             "'dea schema --material'.",
    .options = options,
    .request_size = sizeof(struct request),
    .run = run,
};
