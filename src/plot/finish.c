#include "plot/finish.h"

#include "base/file.h"
#include "base/html.h"
#include "base/write_file.h"
#include "plot/script.h"

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
    dea_html_element(&copy->out, "title", caption);
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

/* The chunk pHYs of the PNG specification: 11811 dots a metre along both axes, and its check. */
static const char resolution[] = "\0\0\0\11pHYs\0\0\x2e\x23\0\0\x2e\x23\1\x78\xa5\x3f\x76";
enum { CHUNK = sizeof resolution - 1 };

dea_status dea_png_finish(struct dea_context *ctx, const char *bytes, size_t length, char **out,
                          size_t *out_length)
{
  enum { HEAD = 8 + 25 }; // signature with IHDR
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
  memcpy(*out, bytes, HEAD);
  memcpy(*out + HEAD, resolution, CHUNK);
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

/* directory/name.ending */
static dea_status find_named(struct dea_context *ctx, const char *directory, const char *name,
                             const char *ending, char out[DEA_PATH_SIZE])
{
  char file[128];
  snprintf(file, sizeof file, "%.119s.%s", name, ending);
  return dea_path_build(ctx, directory, file, out);
}

/* Text of a file; *bytes NULL where there is none. */
static dea_status read_if_there(struct dea_context *ctx, const char *path, char **bytes,
                                size_t *length)
{
  *bytes = NULL;
  return dea_path_exists(path) ? dea_file_read(ctx, path, FILE_MAX, bytes, length) : DEA_OK;
}

/* Completes one picture. A gnuplot that ends well may have drawn nothing, on a full disk or as
 * something else of that name; a PDF or an animation, which may be large, is only looked at. */
static dea_status finish_one(struct dea_context *ctx, const char *pictures, const char *name,
                             const char *outcome, const char *caption, bool wanted)
{
  char path[DEA_PATH_SIZE], *bytes = NULL, *done = NULL, first;
  size_t length = 0;
  const bool svg = strcmp(outcome, "svg") == 0, png = strcmp(outcome, "png") == 0;
  dea_status status = find_named(ctx, pictures, name, outcome, path);
  if (status == DEA_OK && (svg || png)) {
    status = read_if_there(ctx, path, &bytes, &length);
  } else if (status == DEA_OK) {
    (void)dea_file_head(path, &first, 1, &length);
  }
  if (status == DEA_OK && wanted && length == 0) {
    status = dea_fail(ctx, DEA_E_TOOL, "gnuplot has drawn nothing into %s", dea_path_name(path));
  }
  if (status == DEA_OK && bytes != NULL && svg) {
    status = dea_svg_finish(ctx, bytes, caption, &done);
    length = done != NULL ? strlen(done) : 0;
  } else if (status == DEA_OK && bytes != NULL) {
    status = dea_png_finish(ctx, bytes, length, &done, &length);
  }
  if (status == DEA_OK && done != NULL) {
    status = dea_file_write(ctx, path, done, length);
  }
  dea_free(ctx, done);
  dea_free(ctx, bytes);
  return status;
}

dea_status dea_picture_finish(struct dea_context *ctx, const char *pictures, const char *scripts,
                              const char *name, const struct dea_plot_format *format)
{
  static const char *const outcomes[] = {"svg", "pdf", "png", "gif"};
  char caption[400], path[DEA_PATH_SIZE], *bytes = NULL;
  size_t length;
  dea_status status = find_named(ctx, scripts, name, "gp", path);
  status = status == DEA_OK ? read_if_there(ctx, path, &bytes, &length) : status;
  const char *script = bytes != NULL ? bytes : "";
  const bool all = strstr(script, "in formats]") != NULL; // else it is an animation
  const bool wanted[] = {all && format->svg, all && format->pdf, all && format->png, !all};
  read_caption(script, name, caption, sizeof caption);
  for (size_t i = 0; i < sizeof outcomes / sizeof outcomes[0] && status == DEA_OK; i++) {
    status = finish_one(ctx, pictures, name, outcomes[i], caption, wanted[i]);
  }
  dea_free(ctx, bytes);
  return status;
}
