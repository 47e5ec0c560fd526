/* The film's middle surface at the points of a sweep, as numbers for the page's script: the part
 * that was computed, quantised to 16 bits between the extremes of the sweep, in base64. */
#include "figures/surface_lattice.h"
#include "report/section.h"
#include "result/trust.h"

#include <math.h>
#include <stdint.h>

enum { STEPS_MAX = 40, BYTES_MAX = 700000, LEVELS = 65535 }; // before base64, of one run

/* One component of a field over all steps. */
struct channel {
  const char *field, *label, *unit;
  int component; // -1: the smallest of all
  double factor; // of the display unit
};

static const struct channel channels[] = {
    {"displacement_m", "x", "\302\265m", 0, 1e6},
    {"displacement_m", "y", "\302\265m", 1, 1e6},
    {"displacement_m", "displacement z", "\302\265m", 2, 1e6},
    {"tension_N_per_m", "smallest tension", "N/m", -1, 1},
    {"true_field_V_per_m", "true field", "V/\302\265m", 0, 1e-6},
};
enum { CHANNELS = sizeof channels / sizeof channels[0] };

/* The steps that are shown: surfaces on one mesh. */
struct steps {
  const struct dea_surface_record *at[STEPS_MAX];
  size_t count;
};

static double value_at(const struct dea_mesh_field *field, int component, size_t point)
{
  const double *v = field->values + point * (size_t)field->components;
  double value = v[component >= 0 ? component : 0];
  for (int c = 1; c < field->components && component < 0; c++) {
    value = fmin(value, v[c]);
  }
  return value;
}

/* Whether all steps have the channel's component, at points. */
static bool have(const struct steps *steps, const struct channel *channel)
{
  for (size_t s = 0; s < steps->count; s++) {
    const struct dea_mesh_field *field = dea_field_mesh_find(steps->at[s]->mesh, channel->field);
    if (field == NULL || field->of_cells || channel->component >= field->components) {
      return false;
    }
  }
  return true;
}

static void add_words(struct dea_text *out, const uint16_t *words, size_t count)
{
  dea_text_add(out, "\"");
  uint8_t bytes[1536]; // least significant byte first, whatever the machine
  for (size_t from = 0; from < count; from += sizeof bytes / 2) {
    size_t n = count - from < sizeof bytes / 2 ? count - from : sizeof bytes / 2;
    for (size_t i = 0; i < n; i++) {
      bytes[2 * i] = (uint8_t)(words[from + i] & 0xFF);
      bytes[2 * i + 1] = (uint8_t)(words[from + i] >> 8);
    }
    dea_html_base64(out, bytes, 2 * n);
  }
  dea_text_add(out, "\"");
}

static uint16_t level(double value, double low, double high)
{
  double share = high > low && isfinite(value) ? (value - low) / (high - low) : 0;
  return (uint16_t)lround(LEVELS * fmax(0, fmin(1, share)));
}

static void add_channel(struct dea_text *out, const struct steps *steps,
                        const struct channel *channel, uint16_t *words)
{
  double low = INFINITY, high = -INFINITY;
  size_t points = steps->at[0]->mesh->point_count;
  for (size_t s = 0; s < steps->count; s++) {
    const struct dea_mesh_field *field = dea_field_mesh_find(steps->at[s]->mesh, channel->field);
    for (size_t p = 0; p < points; p++) {
      double value = value_at(field, channel->component, p);
      low = isfinite(value) ? fmin(low, value) : low;
      high = isfinite(value) ? fmax(high, value) : high;
    }
  }
  dea_text_add(out, "{\"label\":\"%s\",\"unit\":\"%s\",\"factor\":%g,\"low\":", channel->label,
               channel->unit, channel->factor);
  dea_html_json_number(out, low, 9);
  dea_text_add(out, ",\"high\":");
  dea_html_json_number(out, high, 9);
  dea_text_add(out, ",\"steps\":[");
  for (size_t s = 0; s < steps->count; s++) {
    const struct dea_mesh_field *field = dea_field_mesh_find(steps->at[s]->mesh, channel->field);
    for (size_t p = 0; p < points; p++) {
      words[p] = level(value_at(field, channel->component, p), low, high);
    }
    dea_text_add(out, "%s", s > 0 ? "," : "");
    add_words(out, words, points);
  }
  dea_text_add(out, "]}");
}

/* Whether a field marks a cell; a file may have one of that name that is none of cells. */
static bool marks(const struct dea_mesh_field *field, size_t cell)
{
  return field != NULL && field->of_cells && field->values[cell * (size_t)field->components] > 0.5;
}

/* Places and elements: those of the first step, which all share. */
static void add_mesh(struct dea_text *out, const struct dea_field_mesh *mesh, uint16_t *words)
{
  const double radius = dea_field_mesh_radius_m(mesh);
  dea_text_add(out, "\"radius\":%.9g,\"fold\":%d,\"angle\":%.9g,\"points\":%zu,\"X\":[", radius,
               mesh->fold, mesh->symmetry_angle, mesh->point_count);
  for (size_t i = 0; i < 2; i++) {
    for (size_t p = 0; p < mesh->point_count; p++) {
      words[p] = level(mesh->X[3 * p + i], -radius, radius);
    }
    dea_text_add(out, "%s", i > 0 ? "," : "");
    add_words(out, words, mesh->point_count);
  }
  const struct dea_mesh_field *between = dea_field_mesh_find(mesh, "between_electrodes"),
                              *under = dea_field_mesh_find(mesh, "under_fibre");
  dea_text_add(out, "],\"blocks\":[");
  size_t cell = 0;
  for (size_t b = 0; b < mesh->block_count; b++) {
    const struct dea_mesh_block *block = &mesh->blocks[b];
    size_t each = (size_t)dea_mesh_block_nodes(block);
    dea_text_add(out, "%s{\"order\":%d,\"nodes\":[", b > 0 ? "," : "", block->order);
    for (size_t i = 0; i < block->count * each; i++) {
      dea_text_add(out, "%s%d", i > 0 ? "," : "", block->nodes[i]);
    }
    dea_text_add(out, "],\"flags\":[");
    for (size_t i = 0; i < block->count; i++, cell++) {
      int flags = marks(between, cell) + 2 * marks(under, cell);
      dea_text_add(out, "%s%d", i > 0 ? "," : "", flags);
    }
    dea_text_add(out, "]}");
  }
  dea_text_add(out, "],");
}

/* As many surfaces as there is room for, evenly. */
static struct steps choose_steps(const struct dea_result *result)
{
  struct steps steps = {.count = 0};
  if (result->surface_count > 0) {
    size_t bytes = 2 * CHANNELS * result->surfaces[0].mesh->point_count;
    size_t most = BYTES_MAX / (bytes > 0 ? bytes : 1);
    most = most < 2 ? 2 : most > STEPS_MAX ? STEPS_MAX : most;
    steps.count = dea_surface_spread_same(result, most, steps.at);
  }
  return steps;
}

dea_status dea_section_membrane(struct dea_report *report, const struct dea_report_run *run)
{
  struct steps steps = choose_steps(run->run->result);
  struct dea_text *out = &report->text;
  if (steps.count == 0 || !have(&steps, &channels[2]) || !(steps.at[0]->mesh->cell_count > 0)) {
    return DEA_OK;
  }
  uint16_t *words = dea_alloc(report->ctx, steps.at[0]->mesh->point_count, sizeof *words);
  DEA_TRY_MEMORY(words != NULL);
  dea_section_begin(report, "membrane", run->number, "Deformed membrane");
  dea_text_add(out,
               "<div class=\"membrane interactive\" hidden></div><p class=\"still\">The page's "
               "script shows the film in space here. Without it, see the profiles among the "
               "curves.</p><script type=\"application/json\" class=\"surface\">{");
  add_mesh(out, steps.at[0]->mesh, words);
  dea_text_add(out, "\"voltages\":[");
  for (size_t s = 0; s < steps.count; s++) {
    dea_text_add(out, "%s%.9g", s > 0 ? "," : "", steps.at[s]->voltage_V);
  }
  dea_text_add(out, "],\"doubts\":[");
  for (size_t s = 0; s < steps.count; s++) {
    char flags[DEA_FLAGS_SIZE];
    const struct dea_surface_record *at = steps.at[s];
    unsigned doubts = dea_result_doubts(run->run->result, at->model, at->voltage_V);
    dea_text_add(out, "%s\"%s\"", s > 0 ? "," : "", dea_flags_text(doubts, flags));
  }
  dea_text_add(out, "],\"channels\":[");
  for (size_t c = 0; c < CHANNELS; c++) {
    if (have(&steps, &channels[c])) {
      dea_text_add(out, "%s", c > 0 ? "," : "");
      add_channel(out, &steps, &channels[c], words);
    }
  }
  dea_text_add(out, "]}</script>");
  dea_section_end(report);
  dea_free(report->ctx, words);
  return DEA_OK;
}
