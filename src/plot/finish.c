#include "plot/finish.h"

#include "base/file.h"
#include "base/write_file.h"
#include "plot/script.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { FILE_MAX = 1 << 28 };

// SVG --------------------------------------------------------------------------------------------

/* The part of a text between the end of `before` and the next `after`; NULL where it does not begin
 * with `before`. *end: behind `after`. */
static const char *between(const char *text, const char *before, const char *after, size_t *length,
                           const char **end)
{
  size_t n = strlen(before);
  const char *stop = strncmp(text, before, n) == 0 ? strstr(text + n, after) : NULL;
  if (stop == NULL) {
    return NULL;
  }
  *length = (size_t)(stop - text) - n;
  *end = stop + strlen(after);
  return text + n;
}

/* A text that is copied with changes. */
struct copy {
  struct dea_text out;
  const char *done; // up to here
};

/* Copies up to `at` and goes on at `end`; what stands there instead is added next. */
static void replace(struct copy *copy, const char *at, const char *end)
{
  dea_text_add(&copy->out, "%.*s", (int)(at - copy->done), copy->done);
  copy->done = end;
}

static void add_title(struct dea_text *out, const char *caption)
{
  dea_text_add(out, "<title>");
  for (const char *c = caption; *c != '\0'; c++) {
    const char *entity = dea_entity_name((unsigned char)*c);
    dea_text_add(out, entity != NULL ? "%s" : "%.1s", entity != NULL ? entity : c);
  }
  dea_text_add(out, "</title>");
}

/* A facet with a fill that is not half transparent. */
static void replace_facet(struct copy *copy, const char *at)
{
  size_t n;
  const char *end, *colour = between(at, "<polygon fill = '", "' points = ", &n, &end);
  if (colour != NULL && memchr(colour, '\'', n) == NULL) {
    replace(copy, at, end);
    dea_text_add(&copy->out, "<polygon fill='%.*s' stroke='%.*s' points=", (int)n, colour, (int)n,
                 colour);
  }
}

/* Replaces what begins at a "<" or an "f". Facets come without a line around them, in groups that
 * turn smooth edges off: pinholes of the paper's colour stay between them, and thin ones vanish.
 * They get a thin line of their own colour instead. */
static void replace_at(struct copy *copy, const char *at, const char *caption)
{
  static const char facets[] = "<g stroke='none' shape-rendering='crispEdges'>";
  size_t length;
  const char *end;
  if (between(at, "<title>gnuplot_plot_", "</title>", &length, &end) != NULL) {
    replace(copy, at, end); // browsers show it where the pointer rests
  } else if (between(at, "<title>Gnuplot", "</title>", &length, &end) != NULL) {
    replace(copy, at, end);
    add_title(&copy->out, caption);
  } else if (between(at, "font-family=\"" DEA_SCRIPT_FONT, "\"", &length, &end) != NULL) {
    replace(copy, at, end);
    dea_text_add(&copy->out, "font-family=\"" DEA_SCRIPT_FONT ", Verdana, sans-serif\"");
  } else if (between(at, facets, "", &length, &end) != NULL) {
    replace(copy, at, end);
    dea_text_add(&copy->out, "<g stroke='none' stroke-width='0.8' stroke-linejoin='round'>");
  } else {
    replace_facet(copy, at);
  }
}

dea_status dea_svg_finish(struct dea_context *ctx, const char *svg, const char *caption, char **out)
{
  struct copy copy = {{.ctx = ctx}, svg};
  for (const char *at = svg; (at = strpbrk(at, "<f")) != NULL;) {
    replace_at(&copy, at, caption);
    at = copy.done > at ? copy.done : at + 1;
  }
  dea_text_add(&copy.out, "%s", copy.done);
  *out = copy.out.failed ? NULL : copy.out.data;
  if (copy.out.failed) {
    dea_text_free(&copy.out);
    return DEA_E_MEMORY;
  }
  return DEA_OK;
}

// PNG --------------------------------------------------------------------------------------------

/* The check of a chunk: CRC-32 of ISO 3309, as in Annex D of the PNG specification. */
static uint32_t check_of(const unsigned char *bytes, size_t count)
{
  uint32_t check = 0xffffffff;
  for (size_t i = 0; i < count; i++) {
    check ^= bytes[i];
    for (int bit = 0; bit < 8; bit++) {
      check = check & 1 ? 0xedb88320 ^ (check >> 1) : check >> 1;
    }
  }
  return ~check;
}

static void write_u32(unsigned char *to, uint32_t value)
{
  for (int i = 0; i < 4; i++) {
    to[i] = (unsigned char)(value >> (24 - 8 * i));
  }
}

dea_status dea_png_finish(struct dea_context *ctx, const char *bytes, size_t length,
                          double dots_per_m, char **out, size_t *out_length)
{
  enum { HEAD = 8 + 25, CHUNK = 21 }; // signature with IHDR; pHYs
  static const char signature[] = "\211PNG\r\n\032\n";
  bool png = length > HEAD && memcmp(bytes, signature, 8) == 0;
  bool has = png && length > HEAD + 8 && memcmp(bytes + HEAD + 4, "pHYs", 4) == 0;
  *out_length = length + (png && !has ? CHUNK : 0);
  *out = dea_alloc(ctx, *out_length + 1, 1);
  DEA_TRY_MEMORY(*out != NULL);
  if (!png || has) {
    memcpy(*out, bytes, length);
    return DEA_OK;
  }
  unsigned char chunk[CHUNK] = {0, 0, 0, 9, 'p', 'H', 'Y', 's'};
  write_u32(chunk + 8, (uint32_t)(dots_per_m + 0.5));
  write_u32(chunk + 12, (uint32_t)(dots_per_m + 0.5));
  chunk[16] = 1; // the unit is the metre
  write_u32(chunk + 17, check_of(chunk + 4, 13));
  memcpy(*out, bytes, HEAD);
  memcpy(*out + HEAD, chunk, CHUNK);
  memcpy(*out + HEAD + CHUNK, bytes + HEAD, length - HEAD);
  return DEA_OK;
}

// Both -------------------------------------------------------------------------------------------

/* What stands behind "# NAME: " in the first line of a script; the name where there is nothing. */
static void read_caption(const char *script, const char *name, char *out, size_t size)
{
  size_t length;
  const char *end, *words = between(script, "# ", "\n", &length, &end);
  size_t n = strlen(name) + 2;
  bool told = words != NULL && length > n && strncmp(words, name, n - 2) == 0;
  snprintf(out, size, "%.*s", told ? (int)(length - n) : (int)(n - 2), told ? words + n : name);
}

/* Text of directory/name.ending; *bytes NULL where there is no such file. */
static dea_status read_named(struct dea_context *ctx, const char *directory, const char *name,
                             const char *outcome, char **path, char **bytes, size_t *length)
{
  char file[128];
  *bytes = NULL;
  snprintf(file, sizeof file, "%.119s.%s", name, outcome);
  *path = dea_path_join(ctx, directory, file);
  DEA_TRY_MEMORY(*path != NULL);
  return dea_path_exists(*path) ? dea_file_read(ctx, *path, FILE_MAX, bytes, length) : DEA_OK;
}

static dea_status finish_one(struct dea_context *ctx, const char *pictures, const char *name,
                             const char *caption, bool svg)
{
  char *path, *bytes, *done = NULL;
  size_t length = 0;
  dea_status status = read_named(ctx, pictures, name, svg ? "svg" : "png", &path, &bytes, &length);
  if (status == DEA_OK && bytes != NULL) {
    status = svg ? dea_svg_finish(ctx, bytes, caption, &done)
                 : dea_png_finish(ctx, bytes, length, DEA_SCRIPT_PNG_DOTS_PER_M, &done, &length);
  }
  if (status == DEA_OK && done != NULL) {
    status = dea_file_write(ctx, path, done, svg ? strlen(done) : length);
  }
  dea_free(ctx, done);
  dea_free(ctx, bytes);
  dea_free(ctx, path);
  return status;
}

/* A gnuplot that ends well and has drawn nothing, on a full disk or as something else of that name.
 */
static dea_status check_drawn(struct dea_context *ctx, const char *pictures, const char *name,
                              const char *script, const struct dea_plot_format *format)
{
  static const char *const outcomes[] = {"svg", "pdf", "png", "gif"};
  const bool all = strstr(script, "in formats]") != NULL; // else it is an animation
  const bool wanted[] = {all && format->svg, all && format->pdf, all && format->png, !all};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < sizeof outcomes / sizeof outcomes[0] && status == DEA_OK; i++) {
    char file[128], byte;
    size_t length;
    snprintf(file, sizeof file, "%.119s.%s", name, outcomes[i]);
    char *path = dea_path_join(ctx, pictures, file);
    DEA_TRY_MEMORY(path != NULL);
    if (wanted[i] && (!dea_file_head(path, &byte, 1, &length) || length == 0)) {
      status = dea_fail(ctx, DEA_E_TOOL, "gnuplot has drawn nothing into %s", file);
    }
    dea_free(ctx, path);
  }
  return status;
}

dea_status dea_picture_finish(struct dea_context *ctx, const char *pictures, const char *scripts,
                              const char *name, const struct dea_plot_format *format)
{
  char caption[400], *path, *script;
  size_t length;
  dea_status status = read_named(ctx, scripts, name, "gp", &path, &script, &length);
  if (status == DEA_OK) {
    status = check_drawn(ctx, pictures, name, script != NULL ? script : "", format);
  }
  if (status == DEA_OK) {
    read_caption(script != NULL ? script : "", name, caption, sizeof caption);
    status = finish_one(ctx, pictures, name, caption, true);
  }
  status = status == DEA_OK ? finish_one(ctx, pictures, name, caption, false) : status;
  dea_free(ctx, script);
  dea_free(ctx, path);
  return status;
}
