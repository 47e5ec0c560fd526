#include "cli/cli.h"

#include "base/text.h"
#include "material/catalogue.h"

#include <math.h>
#include <string.h>

struct request {
  const char *name; // NULL: all
  bool json, markdown;
};

static const char *const kind_names[] = {"elastomer", "plastic", "electrode"};

static const char *kind_of(const struct dea_material_data *data)
{
  return data->kind.value >= 0 ? kind_names[data->kind.value] : "";
}

/* One line of the list of all materials, and what there are several of. */
static void add_line(struct dea_text *out, const struct dea_material_data *data)
{
  dea_text_add(out, "%-28s %-10s %s\n", data->name.text, kind_of(data), data->title.text);
  for (size_t i = 0; i < data->law_count; i++) {
    dea_text_add(out, "%-28s   law %s (%s)%s\n", "", data->laws[i].head.id.text,
                 data->laws[i].law_name.text, i == 0 && data->law_count > 1 ? ", default" : "");
  }
  for (size_t i = 0; i < data->permittivity_count; i++) {
    dea_text_add(out, "%-28s   permittivity %s%s\n", "", data->permittivity[i].head.id.text,
                 i == 0 && data->permittivity_count > 1 ? ", default" : "");
  }
}

// The table of docs/materials.md -----------------------------------------------------------------

static void add_band(struct dea_text *out, double value, const struct dea_data_range *values,
                     double factor)
{
  dea_text_add(out, "%.4g", factor * value);
  if (values->count == 2 && values->limits[0].si < values->limits[1].si) {
    dea_text_add(out, " (%.4g to %.4g)", factor * values->limits[0].si,
                 factor * values->limits[1].si);
  }
}

/* Shear moduli at rest of all laws [kPa] with the stretch to which each has data, or Young's. */
static void add_stiffness(struct dea_text *out, const struct dea_material_data *data)
{
  for (size_t i = 0; i < data->law_count; i++) {
    const struct dea_law_set *set = &data->laws[i];
    double param[DEA_LAW_PARAM_MAX];
    for (size_t j = 0; j < DEA_LAW_PARAM_MAX; j++) {
      param[j] = isnan(set->param[j].si) ? 0 : set->param[j].si;
    }
    dea_text_add(out, "%s%s %.4g kPa", i > 0 ? "; " : "", set->law_name.text,
                 1e-3 * set->law->shear_modulus(param));
    if (set->head.range.count == 2) {
      dea_text_add(out, " to %g", set->head.range.limits[1].si);
    }
  }
  if (data->has_elastic) {
    dea_text_add(out, "E ");
    add_band(out, data->elastic.young_modulus_Pa.si, &data->elastic.values, 1e-9);
    dea_text_add(out, " GPa");
  }
  dea_text_add(out, data->law_count == 0 && !data->has_elastic ? "unknown" : "");
}

static void add_breakdown(struct dea_text *out, const struct dea_material_data *data)
{
  for (size_t i = 0; i < data->breakdown_count; i++) {
    const struct dea_breakdown_set *set = &data->breakdown[i];
    dea_text_add(out, "%s", i > 0 ? "; " : "");
    add_band(out, set->at_rest_V_per_m.si, &set->values, 1e-6 * set->electrode_factor.si);
    if (!isnan(set->exponent.si) && set->exponent.si != 0) {
      dea_text_add(out, " s^%g", set->exponent.si);
    }
    if (!isnan(set->thickness_exponent.si)) {
      dea_text_add(out, " (h / %g um)^%g", 1e6 * set->thickness_m.si, set->thickness_exponent.si);
    }
    if (!isnan(set->weibull_shape.si)) {
      dea_text_add(out, ", Weibull %g", set->weibull_shape.si);
    }
  }
  dea_text_add(out, data->breakdown_count == 0 ? "unknown" : "");
}

static void add_table_row(struct dea_text *out, const struct dea_material_data *data)
{
  dea_text_add(out, "| `%s` | ", data->name.text);
  if (data->has_density) {
    add_band(out, data->density.value_kg_per_m3.si, &data->density.values, 1);
  }
  dea_text_add(out, "%s | ", data->has_density ? "" : "unknown");
  add_stiffness(out, data);
  dea_text_add(out, " | ");
  for (size_t i = 0; i < data->viscosity_count; i++) {
    const struct dea_viscosity_set *set = &data->viscosity[i];
    dea_text_add(out, "%s%zu to %.3g s%s", i > 0 ? "; " : "", set->branch_count,
                 set->branches[set->branch_count - 1].time_s.si,
                 set->assumed.value == 1 ? " (assumed)" : "");
  }
  dea_text_add(out, "%s | ", data->viscosity_count > 0 ? "" : "unknown");
  for (size_t i = 0; i < data->permittivity_count; i++) {
    dea_text_add(out, "%s", i > 0 ? "; " : "");
    add_band(out, data->permittivity[i].at_rest.si, &data->permittivity[i].values, 1);
  }
  dea_text_add(out, "%s | ", data->permittivity_count > 0 ? "" : "unknown");
  add_breakdown(out, data);
  dea_text_add(out, " | ");
  if (data->has_resistivity) {
    add_band(out, data->resistivity.value_ohm_m.si, &data->resistivity.values, 1);
  }
  dea_text_add(out, "%s |\n", data->has_resistivity ? "" : "unknown");
}

// One material ------------------------------------------------------------------------------------

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

enum { PROSE = 4 };

/* Place of a key in its section: prose comes in this order, after the numbers. */
static int rank_of(const char *key)
{
  static const char *const prose[PROSE] = {"uncertainty", "range", "source", "note"};
  int rank = PROSE;
  while (rank > 0 && strcmp(prose[rank - 1], key) != 0) {
    rank--;
  }
  return rank;
}

/* Values of one section, in the words of the file. */
static void add_section(struct dea_text *out, const struct dea_listing *listing, const char *path,
                        size_t length)
{
  for (int rank = 0; rank <= PROSE; rank++) {
    for (size_t i = 0; i < listing->count; i++) {
      const char *key = leaf(listing->items[i].path), *text = listing->items[i].text;
      if (in_section(&listing->items[i], path, length) && rank_of(key) == rank) {
        const size_t before = out->length;
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

/* Shows a material; in JSON it goes to the array. */
static dea_status show(struct dea_cli *cli, const struct request *request, const char *name,
                       json_t *array)
{
  struct dea_text out = {.ctx = cli->ctx};
  struct dea_catalogue_entry *entry;
  DEA_TRY(cli->ctx, dea_catalogue_read(cli->ctx, name, (struct dea_location){0}, &entry));
  if (request->json) {
    json_array_append_new(array, material_json(entry));
  } else if (request->markdown) {
    add_table_row(&out, &entry->data);
  } else if (request->name != NULL) {
    add_material(&out, entry);
  } else {
    add_line(&out, &entry->data);
  }
  dea_catalogue_destroy(cli->ctx, entry);
  return cli_print_text(DEA_OK, &out);
}

/* Shows all; one file with errors does not hide the others. */
static dea_status show_all(struct dea_cli *cli, const struct request *request, json_t *array)
{
  const char **names;
  size_t count;
  dea_status worst = DEA_OK;
  DEA_TRY(cli->ctx, dea_catalogue_names(cli->ctx, &names, &count));
  for (size_t i = 0; i < count; i++) {
    dea_status status = show(cli, request, names[i], array);
    worst = status != DEA_OK ? status : worst;
  }
  dea_free(cli->ctx, names);
  return worst;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  json_t *array = request->json ? json_array() : NULL;
  if (request->markdown && !request->json) {
    puts("| material | density (kg/m3) | stiffness | branches | permittivity | breakdown (V/um) | "
         "resistivity (ohm m) |\n|---|---|---|---|---|---|---|");
  }
  dea_status status = request->name != NULL ? show(cli, request, request->name, array)
                                            : show_all(cli, request, array);
  if (request->json) {
    cli_print_json(array);
  }
  return status;
}

static const struct cli_option options[] = {
    {NULL, 0, CLI_MATERIAL, "NAME", "this material with all that is known of it", CLI_AT(name)},
    CLI_JSON_ROW("as JSON"),
    {"markdown", 0, CLI_FLAG, NULL, "as a table: values, bands and what is unknown",
     CLI_AT(markdown)},
    {0}};

const struct dea_command cmd_materials = {
    .name = "materials",
    .summary = "List the materials of the catalogue, or show one with all its numbers and sources",
    .about = "Own materials: put NAME.yaml into a directory that the environment variable "
             "DEA_MATERIALS names (several, separated by colons). What such a file holds says "
             "'dea schema --material'.",
    CLI_RUN};
