#include "fabricate/document.h"

#include "fabricate/labels.h"

#include <stdarg.h>
#include <stdio.h>

/* Text of any length; NULL after a failure. */
static char *format_text(struct dea_document *document, const char *format, va_list args)
{
  va_list again;
  va_copy(again, args);
  int length = vsnprintf(NULL, 0, format, args);
  char *text = document->failed ? NULL : dea_alloc(document->ctx, (size_t)length + 1, 1);
  if (text != NULL) {
    vsnprintf(text, (size_t)length + 1, format, again);
  }
  va_end(again);
  document->failed = text == NULL;
  return text;
}

static void add_cell(struct dea_document *document, const char *format, va_list args)
{
  struct dea_document_block *block = &document->block[document->count - 1];
  char *text = format_text(document, format, args);
  if (text != NULL) {
    block->cell[block->cells++] = text;
  }
}

void dea_document_add(struct dea_document *document, enum dea_block_kind kind, const char *format,
                      ...)
{
  if (document->failed) {
    return;
  }
  if (document->count == document->capacity) {
    size_t capacity = document->capacity > 0 ? 2 * document->capacity : 32;
    void *bigger = dea_resize(document->ctx, document->block, capacity, sizeof *document->block);
    if (bigger == NULL) {
      document->failed = true;
      return;
    }
    document->block = bigger;
    document->capacity = capacity;
  }
  document->block[document->count++] = (struct dea_document_block){.kind = kind};
  va_list args;
  va_start(args, format);
  add_cell(document, format, args);
  va_end(args);
}

void dea_document_cell(struct dea_document *document, const char *format, ...)
{
  if (!document->failed && document->block[document->count - 1].cells < DEA_CELLS_MAX) {
    va_list args;
    va_start(args, format);
    add_cell(document, format, args);
    va_end(args);
  }
}

void dea_document_free(struct dea_document *document)
{
  for (size_t i = 0; i < document->count; i++) {
    for (size_t c = 0; c < document->block[i].cells; c++) {
      dea_free(document->ctx, document->block[i].cell[c]);
    }
  }
  dea_free(document->ctx, document->block);
  *document = (struct dea_document){.ctx = document->ctx};
}

/* ---- HTML ---- */

static const char style[] =
    "body{font:15px/1.5 'DejaVu Sans',Arial,sans-serif;color:#202020;max-width:60em;"
    "margin:2em auto;padding:0 1em}h1{font-size:1.6em;border-bottom:1px solid #202020}"
    "h2{font-size:1.15em;margin-top:1.8em}table{border-collapse:collapse;width:100%;font-size:."
    "92em}"
    "th,td{text-align:left;vertical-align:top;padding:.35em .6em;border-bottom:1px solid #d5d8dd}"
    "th{border-bottom:1px solid #202020}.note{color:#6a6a6a;font-size:.88em}"
    "ol{padding-left:2.4em}li{margin:.5em 0}svg{width:100%;height:auto}"
    "@media print{body{margin:0;max-width:none}h2{break-after:avoid}tr,li{break-inside:avoid}}";

static void add_row(struct dea_text *out, const struct dea_document_block *block, const char *tag)
{
  dea_text_add(out, "<tr>");
  for (size_t c = 0; c < block->cells; c++) {
    dea_text_add(out, "<%s>", tag);
    dea_xml_add(out, block->cell[c]);
    dea_text_add(out, "</%s>", tag);
  }
  dea_text_add(out, "</tr>\n");
}

static void add_element(struct dea_text *out, const char *begin, const char *text, const char *end)
{
  dea_text_add(out, "%s", begin);
  dea_xml_add(out, text);
  dea_text_add(out, "%s\n", end);
}

static void add_block(struct dea_text *out, const struct dea_document_block *block)
{
  const char *text = block->cells > 0 ? block->cell[0] : "";
  switch (block->kind) {
  case DEA_BLOCK_TITLE:
    add_element(out, "<h1>", text, "</h1>");
    break;
  case DEA_BLOCK_HEADING:
    add_element(out, "<h2>", text, "</h2>");
    break;
  case DEA_BLOCK_TEXT:
    add_element(out, "<p>", text, "</p>");
    break;
  case DEA_BLOCK_NOTE:
    add_element(out, "<p class=\"note\">", text, "</p>");
    break;
  case DEA_BLOCK_STEP:
    add_element(out, "<li>\xe2\x98\x90 ", text, "</li>");
    break;
  case DEA_BLOCK_HEAD:
    add_row(out, block, "th");
    break;
  case DEA_BLOCK_ROW:
    add_row(out, block, "td");
    break;
  }
}

/* What encloses blocks of a kind. */
static const char *enclosure(enum dea_block_kind kind)
{
  return kind == DEA_BLOCK_STEP                            ? "ol"
         : kind == DEA_BLOCK_HEAD || kind == DEA_BLOCK_ROW ? "table"
                                                           : "";
}

void dea_document_html(const struct dea_document *document, const char *drawing,
                       struct dea_text *out)
{
  const char *open = "";
  dea_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                    "style-src 'unsafe-inline'\">\n"
                    "<meta name=\"viewport\" content=\"width=device-width\">\n<title>");
  dea_xml_add(out, document->count > 0 ? document->block[0].cell[0] : "");
  dea_text_add(out, "</title>\n<style>%s</style>\n</head>\n<body>\n", style);
  for (size_t i = 0; i < document->count; i++) {
    const struct dea_document_block *block = &document->block[i];
    const char *wanted = enclosure(block->kind);
    bool new_table = block->kind == DEA_BLOCK_HEAD;
    if (open[0] != '\0' && (wanted != open || new_table)) {
      dea_text_add(out, "</%s>\n", open);
      open = "";
    }
    if (wanted[0] != '\0' && open[0] == '\0') {
      dea_text_add(out, "<%s>\n", wanted);
    }
    open = wanted;
    add_block(out, block);
    if (i == 1) {
      dea_text_add(out, "<div role=\"img\" aria-label=\"Drawing of the actuator\">%s</div>\n",
                   drawing);
    }
  }
  if (open[0] != '\0') {
    dea_text_add(out, "</%s>\n", open);
  }
  dea_text_add(out, "</body>\n</html>\n");
}
