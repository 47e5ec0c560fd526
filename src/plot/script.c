#include "plot/script.h"

#include "base/version.h"
#include "base/write_file.h"

#include <stdio.h>

void dea_script_head(struct dea_text *gp, const char *name, const char *caption,
                     const struct dea_plot_format *format, double width_mm, double height_mm)
{
  dea_text_add(gp,
               "# %s: %s\n# Written by dea %s. Change it and run in this folder: gnuplot %s.gp\n"
               "reset\nname = \"%s\"\nformats = \"%s%s%s\"\nwidth_mm = %.6g\nheight_mm = %.6g\n"
               "font = \"" DEA_SCRIPT_FONT "\" # of all formats; one that is installed\n"
               "font_pt = 8\n\n",
               name, caption, DEA_VERSION, name, name, format->svg ? "svg " : "",
               format->pdf ? "pdf " : "", format->png ? "png" : "", width_mm, height_mm);
  dea_text_add(gp, "data = name.\".dat\"\n"
                   "out = exists(\"dea_folder\") ? dea_folder : \"\"\n"
                   "small = sprintf(\",%%g\", 0.85 * font_pt)\n"
                   "set encoding utf8\nset minussign\n"
                   "set datafile missing \"?\"\n"
                   "set border lw 0.8\nset tics scale 0.6 nomirror\nset bars 0.5\n"
                   "set key Left reverse samplen 2.2 font small\n");
}

void dea_script_terminals(struct dea_text *gp)
{
  dea_text_add(
      gp, "do for [format in formats] {\n"
          "  if (format eq \"svg\") {\n"
          "    px = 96 / 25.4 # of an SVG, per mm\n"
          "    x_shift = 0.6; y_shift = 1.0; key_width = -1; key_spacing = 0.9\n"
          "    facets = \"noborder\"\n"
          "    small = sprintf(\",%%g\", 0.85 * font_pt * 96 / 72.0)\n"
          "    set terminal svg size width_mm * px, height_mm * px enhanced \\\n"
          "      font sprintf(\"%%s,%%g\", font, font_pt * 96 / 72.0) linewidth 1\n"
          "  }\n"
          "  if (format eq \"pdf\") {\n"
          "    x_shift = 0.2; y_shift = 0.3; key_width = 0; key_spacing = 1.05\n"
          "    facets = \"border retrace\" # no seams between them\n"
          "    small = sprintf(\",%%g\", 0.85 * font_pt)\n"
          "    set terminal pdfcairo size width_mm / 10.0 cm, height_mm / 10.0 cm enhanced \\\n"
          "      font sprintf(\"%%s,%%g\", font, font_pt) fontscale 0.75 linewidth 1.5\n"
          "  }\n"
          "  if (format eq \"png\") {\n"
          "    px = 300 / 25.4 # 300 dots an inch\n"
          "    x_shift = 0.2; y_shift = 0.3; key_width = 0; key_spacing = 1.05\n"
          "    facets = \"border retrace\" # no seams between them\n"
          "    small = sprintf(\",%%g\", 0.85 * font_pt)\n"
          "    set terminal pngcairo size width_mm * px, height_mm * px enhanced \\\n"
          "      font sprintf(\"%%s,%%g\", font, font_pt) fontscale 300 / 96.0 linewidth 3.1 "
          "pointscale 3.1\n"
          "  }\n"
          "  set key font small spacing key_spacing\n"
          "  set output out.name.\".\".format\n");
}

dea_status dea_script_write(const char *directory, const char *name, struct dea_text *gp,
                            struct dea_text *dat)
{
  char file[80];
  snprintf(file, sizeof file, "%.70s.dat", name);
  dea_status status = dea_text_write(dat->ctx, dat, directory, file);
  snprintf(file, sizeof file, "%.70s.gp", name);
  status = status == DEA_OK ? dea_text_write(gp->ctx, gp, directory, file) : status;
  dea_text_free(gp);
  dea_text_free(dat);
  return status;
}
