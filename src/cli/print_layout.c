#include "cli/print_layout.h"

#include "base/rounded.h"

#include <stdio.h>

static const double degree = 57.29577951308232;

static const char *plural(size_t count)
{
  return count == 1 ? "" : "s";
}

static void print_symmetry(const struct dea_symmetry *s)
{
  printf("\nSymmetry about (%.4g, %.4g) mm\n  ", dea_rounded(1e3 * s->centre_m[0]),
         dea_rounded(1e3 * s->centre_m[1]));
  if (s->order == 0) {
    puts("every turn and every mirror");
  } else if (s->order == 1 && s->mirrors == 0) {
    puts("none");
  } else if (s->order == 1) {
    printf("one mirror, at %.4g degree\n", dea_rounded(degree * s->mirror_rad));
  } else {
    printf("%zu turns, %zu mirror%s", s->order, s->mirrors, plural(s->mirrors));
    printf(s->mirrors > 0 ? ", the first at %.4g degree\n" : "\n",
           dea_rounded(degree * s->mirror_rad));
  }
}

void cli_layout_print(const struct dea_layout *l)
{
  puts("\nShapes");
  for (size_t i = 0; i < l->region_count; i++) {
    printf("  %-32s  %.6g mm2\n", l->regions[i].name,
           1e6 * dea_region_area_m2(&l->regions[i].region));
  }
  puts("\nPlies from bottom to top, as they are stretched");
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    printf("  %-32s  %.6g um, %s%s\n", ply->name, 1e6 * ply->thickness_m, ply->material.name,
           dea_layout_is_dielectric(l, i) ? ", between electrodes" : "");
  }
  puts("\nChannels");
  for (size_t i = 0; i < l->channel_count; i++) {
    const struct dea_layout_channel *c = &l->channels[i];
    printf("  %-32s  ", c->name);
    if (i == 0) {
      puts("0 V");
      continue;
    }
    printf("%g x voltage", c->ratio);
    if (c->own_V != 0) {
      printf(" %+g V", c->own_V);
    }
    if (c->waveform != NULL) {
      printf("; in time a waveform of its own (%s)", c->waveform);
    }
    puts("");
  }
  print_symmetry(&l->symmetry);
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
    json_array_append_new(plies, json_pack("{s:s, s:s, s:s, s:f, s:b}", "name", ply->name, "shape",
                                           l->regions[ply->region].name, "material",
                                           ply->material.name, "thickness_m", ply->thickness_m,
                                           "dielectric", dea_layout_is_dielectric(l, i)));
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
