#include "cli/print_layout.h"

#include "base/rounded.h"
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

enum { NAME_WIDTH = 14, LABEL_SIZE = 128 };

static const double degree = 57.29577951308232;

dea_status cli_row_print(const char *name, size_t length, struct dea_text *text)
{
  struct dea_text row = {.ctx = text->ctx};
  if (text->length > 0) {
    const int width = length > NAME_WIDTH ? (int)length : NAME_WIDTH;
    dea_text_add(&row, "  %-*.*s  ", width, (int)length, name);
    cli_add_wrapped(&row, NAME_WIDTH + 4, dea_text_get(text), text->length);
    fputs(dea_text_get(&row), stdout);
  }
  const bool failed = row.failed || text->failed;
  dea_text_free(&row);
  dea_text_free(text);
  return failed ? DEA_E_MEMORY : DEA_OK;
}

static void add_material(const struct dea_material *m, struct dea_text *out)
{
  dea_text_add(out, ", %s", m->name);
  if (m->law != NULL) {
    dea_text_add(out, ", %s (%s)", m->law->name, m->law_id);
  }
  if (m->permittivity.at_rest > 0) {
    dea_text_add(out, ", eps_r %g", m->permittivity.at_rest);
  }
  if (m->permittivity.slope != 0) {
    dea_text_add(out, " %+g (s - 1)", m->permittivity.slope);
  }
  const struct dea_breakdown *b = &m->breakdown;
  if (b->known) {
    dea_text_add(out, ", E_b %.4g V/um", 1e-6 * b->at_rest_V_per_m);
  }
  if (b->known && b->exponent != 0) {
    dea_text_add(out, " s^%g", b->exponent);
  }
  if (b->known && b->law.high > b->law.low) {
    dea_text_add(out, " (%.4g to %.4g by source)", 1e-6 * b->law.low * b->at_rest_V_per_m,
                 1e-6 * b->law.high * b->at_rest_V_per_m);
  }
  if (b->known && b->law.shape > 0) {
    dea_text_add(out, ", Weibull shape %g", b->law.shape);
  }
  if (m->young_modulus_Pa > 0) {
    dea_text_add(out, ", E %g MPa", 1e-6 * m->young_modulus_Pa);
  }
}

static void add_channel(const struct dea_layout_channel *c, struct dea_text *out)
{
  dea_text_add(out, "%s%s %g x voltage", out->length > 0 ? ", " : "", c->name, c->ratio);
  if (c->own_V != 0) {
    dea_text_add(out, " %+g V", c->own_V);
  }
  if (c->waveform != NULL) {
    dea_text_add(out, " (in time a waveform of its own, %s)", c->waveform);
  }
}

static void add_symmetry(const struct dea_symmetry *s, struct dea_text *out)
{
  if (s->order == 0) {
    dea_text_add(out, "every turn and every mirror");
  } else if (s->order == 1 && s->mirrors == 0) {
    dea_text_add(out, "none");
    return;
  } else if (s->order == 1) {
    dea_text_add(out, "one mirror, at %.4g degree", dea_rounded(degree * s->mirror_rad));
  } else {
    dea_text_add(out, "%zu turns, %zu mirror%s", s->order, s->mirrors, s->mirrors == 1 ? "" : "s");
  }
  if (s->order > 1 && s->mirrors > 0) {
    dea_text_add(out, ", the first at %.4g degree", dea_rounded(degree * s->mirror_rad));
  }
  dea_text_add(out, ", about (%.4g, %.4g) mm", dea_rounded(1e3 * s->centre_m[0]),
               dea_rounded(1e3 * s->centre_m[1]));
}

dea_status cli_layout_print(struct dea_context *ctx, const struct dea_layout *l)
{
  struct dea_text text = {.ctx = ctx};
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    char name[LABEL_SIZE];
    snprintf(name, sizeof name, "ply %zu, %s", i + 1, ply->name);
    const size_t layers = dea_ply_layers(ply);
    if (layers > 1) {
      dea_text_add(&text, "%zu layers of ", layers);
    }
    dea_text_add(&text, "%.6g um", 1e6 * dea_ply_stretched_layer_m(ply));
    add_material(&ply->material, &text);
    dea_text_add(&text, "%s", dea_layout_is_dielectric(l, i) ? ", between electrodes" : "");
    DEA_TRY(ctx, cli_row_print(name, strlen(name), &text));
  }
  for (size_t i = 0; i < l->region_count; i++) {
    dea_text_add(&text, "%s%s %.6g mm2", i > 0 ? ", " : "", l->regions[i].name,
                 1e6 * dea_region_area_m2(&l->regions[i].region));
  }
  DEA_TRY(ctx, cli_row_print("areas", strlen("areas"), &text));
  for (size_t i = 1; i < l->channel_count; i++) {
    add_channel(&l->channels[i], &text);
  }
  DEA_TRY(ctx, cli_row_print("channels", strlen("channels"), &text));
  add_symmetry(&l->symmetry, &text);
  return cli_row_print("symmetry", strlen("symmetry"), &text);
}

json_t *cli_layout_json(const struct dea_layout *l)
{
  const struct dea_symmetry *s = &l->symmetry;
  json_t *regions = json_object(), *plies = json_array(), *channels = json_array();
  for (size_t i = 0; i < l->region_count; i++) {
    json_object_set_new(regions, l->regions[i].name,
                        json_real(dea_region_area_m2(&l->regions[i].region)));
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    json_array_append_new(plies, json_pack("{s:s, s:s, s:s, s:f, s:I, s:b}", "name", ply->name,
                                           "shape", l->regions[ply->region].name, "material",
                                           ply->material.name, "thickness_m", ply->thickness_m,
                                           "layers", (json_int_t)dea_ply_layers(ply), "dielectric",
                                           dea_layout_is_dielectric(l, i)));
  }
  for (size_t i = 1; i < l->channel_count; i++) {
    const struct dea_layout_channel *c = &l->channels[i];
    json_array_append_new(channels, json_pack("{s:s, s:f, s:f}", "name", c->name, "ratio", c->ratio,
                                              "own_V", c->own_V));
  }
  return json_pack("{s:o, s:o, s:o, s:{s:[ff], s:I, s:I, s:f}}", "area_m2", regions, "plies", plies,
                   "channels", channels, "symmetry", "centre_m", s->centre_m[0], s->centre_m[1],
                   "order", (json_int_t)s->order, "mirrors", (json_int_t)s->mirrors, "mirror_rad",
                   s->mirrors > 0 ? s->mirror_rad : 0.0);
}
