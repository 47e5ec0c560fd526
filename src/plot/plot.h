/* A figure before it is drawn: panels with series and marks. What it shows is decided by who fills
 * it, what it looks like in plot/write.c only. */
#pragma once

#include "base/text.h"

enum {
  DEA_PLOT_PANELS_MAX = 2,
  DEA_PANEL_SERIES_MAX = 48,
  DEA_PANEL_MARKS_MAX = 12,
  DEA_LABEL_SIZE = 128,
};

/* Colours of Okabe and Ito (safe for the colour-blind), numbered as in plot/write.c. */
enum dea_colour {
  DEA_BLUE,
  DEA_VERMILLION,
  DEA_GREEN,
  DEA_PURPLE,
  DEA_ORANGE,
  DEA_SKY,
  DEA_BLACK,
  DEA_GREY,
};

enum dea_series_style {
  DEA_LINE,
  DEA_THIN,        // many cycles in time
  DEA_LINE_MARKED, // line with about ten markers
  DEA_DASHED,      // unstable branches, second directions
  DEA_DOTTED,      // limits
  DEA_MARKERS,     // points only
  DEA_ERROR_BARS,  // points with +-error where that is a number
  DEA_BAND, // filled from y up to `error`: pale grey for DEA_GREY, else its colour, that is seen
            // through
};

/* title: key entry, "" for none. marker: 0, 1, 2, ... one shape each. */
struct dea_series {
  char title[DEA_LABEL_SIZE];
  enum dea_series_style style;
  enum dea_colour colour;
  int marker;
  bool secondary; // what is not to be trusted, or only a bound: does not set the axis
  bool to_top;    // a band up to the top of the panel, wherever its upper edge lies
  double width;   // of the line over that of its style; 0: 1
  size_t count;
  double *values; // [3][count]: x, y, error; owned
};

/* A thin line across the panel at y = at with a word on it. */
struct dea_mark {
  double at;
  char text[DEA_LABEL_SIZE]; // gnuplot's enhanced text
};

/* Labels and words are gnuplot's enhanced text in UTF-8. Limits that are NAN are left to gnuplot.
 */
struct dea_panel {
  char x_label[DEA_LABEL_SIZE], y_label[DEA_LABEL_SIZE];
  double x_min, x_max, y_min, y_max;
  bool logarithmic;     // both axes
  bool logarithmic_x;   // the x axis
  const char *key;      // "top left", "above ..."; static storage
  double y_step;        // between tics of the y axis; 0: gnuplot's choice
  const char *y_format; // of the tic labels, "%.1f"; NULL: gnuplot's; static storage
  const char *sides[2]; // words left and right of x = 0, which then is marked; NULL: none; static
  const char *dashed;   // key entry: what dashed parts of curves are; NULL: there are none; static
  size_t series_count, mark_count;
  struct dea_series series[DEA_PANEL_SERIES_MAX];
  struct dea_mark marks[DEA_PANEL_MARKS_MAX];
};

struct dea_plot {
  char name[64], caption[256];
  size_t panel_count;   // 1 or 2, one above the other with the same x axis
  double second_height; // height of the second panel over that of the first
  struct dea_panel panels[DEA_PLOT_PANELS_MAX];
};

/* One panel, all limits open. out: owned by the caller. */
dea_status dea_plot_create(struct dea_context *ctx, const char *name, const char *caption,
                           struct dea_plot **out);
void dea_plot_destroy(struct dea_context *ctx, struct dea_plot *plot);
/* Adds a series with room for count points, values NAN; *out lent until the plot dies, so that the
 * caller fills the values. DEA_E_UNSUPPORTED when the panel is full. */
dea_status dea_panel_add(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                         enum dea_series_style style, enum dea_colour colour, const char *title,
                         struct dea_series **out);
/* The same with title, style, colour and marker of another series. */
dea_status dea_panel_add_as(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                            const struct dea_series *look, struct dea_series **out);
/* Takes all series away. */
void dea_panel_clear(struct dea_context *ctx, struct dea_panel *panel);
/* Adds a mark; one too many is left out. text is plain text. */
void dea_panel_mark(struct dea_panel *panel, double at, const char *text);
/* Range of the values, where x is within the panel's limits. Values of series that are secondary
 * widen it by half of what the others span at most, to either side. False when there are no values.
 */
bool dea_panel_range(const struct dea_panel *panel, double *low, double *high);
/* Limits of the y axis, where it has none, that leave out what dea_panel_range leaves out. */
void dea_panel_limit(struct dea_panel *panel);
/* Voltage axis over the voltages of the panel's series and 0, and its label; the y axis as by
 * dea_panel_limit. */
void dea_panel_voltage_axis(struct dea_panel *panel);
/* Has the y axis begin just below 0 where only noise is below it. */
void dea_panel_begin_at_zero(struct dea_panel *panel);
/* At most about `most` tics on the y axis, all with the same number of decimals. */
void dea_panel_even_tics(struct dea_panel *panel, int most);
/* Puts the key into a corner that the panel's series leave free, or makes room above them; to be
 * called when all series are there. */
void dea_panel_place_key(struct dea_panel *panel);
/* Puts the key above the panel, in so many rows (1 to 9). */
void dea_panel_key_above(struct dea_panel *panel, size_t rows);
/* True when a series, or some series of a plot, has a point to show. */
bool dea_series_shows(const struct dea_series *series);
bool dea_plot_shows(const struct dea_plot *plot);

/* Plain text as gnuplot's enhanced text (signs with a meaning there get a backslash). */
void dea_label_escape(const char *text, char *out, size_t size);

struct dea_plot_format {
  bool svg, pdf, png;
  double width_m;
};
/* The plot as gnuplot draws it: writes NAME.gp and NAME.dat into directory. */
dea_status dea_plot_write(struct dea_context *ctx, const struct dea_plot *plot,
                          const struct dea_plot_format *format, const char *directory);

/* Figures of one folder, drawn together. Zero-initialise with what is lent. */
struct dea_plot_folder {
  struct dea_context *ctx;
  const struct dea_plot_format *format;
  const char *path;
  char (*names)[64]; // owned
  size_t count;
};
/* Writes script and data of a plot, where it shows something and status is good; destroys it. */
dea_status dea_plot_folder_add(struct dea_plot_folder *folder, struct dea_plot *plot,
                               dea_status status);
/* Has a figure drawn whose script and data are there. */
dea_status dea_plot_folder_name(struct dea_plot_folder *folder, const char *name);
/* Draws all in the formats asked for, if any, where status is good; leaves the folder empty.
 * Returns that status, or its own: DEA_E_TOOL when gnuplot is missing, fails (with what it said) or
 * draws nothing; the scripts and their data stay. DEA_E_INTERRUPTED after an interruption. */
dea_status dea_plot_folder_draw(struct dea_plot_folder *folder, dea_status status);

/* Before a folder is written to: removes with `force`, refuses without (DEA_E_IO), a file of that
 * name and all that a drawing of that name leaves: script, data, pictures. */
dea_status dea_gnuplot_create_folders(struct dea_context *ctx, const char *directory,
                                      const char *name, bool force);
