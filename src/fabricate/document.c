#include "fabricate/document.h"

#include "fabricate/labels.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char style[] =
    "body{font:15px/1.5 'DejaVu Sans',Arial,sans-serif;color:#202020;max-width:60em;"
    "margin:2em auto;padding:0 1em}h1{font-size:1.6em;border-bottom:1px solid #202020}"
    "h2{font-size:1.15em;margin-top:1.8em}table{border-collapse:collapse;width:100%;font-size:."
    "92em}"
    "th,td{text-align:left;vertical-align:top;padding:.35em .6em;border-bottom:1px solid #d5d8dd}"
    "th{border-bottom:1px solid #202020}.note{color:#6a6a6a;font-size:.88em}"
    "ol{padding-left:2.4em}li{margin:.5em 0}svg{width:100%;height:auto}"
    "@page{size:A4;margin:14mm}@media "
    "print{body{margin:0;max-width:none;font-size:10.5px}svg{max-height:150mm}h2{break-after:avoid}"
    "tr,li{break-inside:"
    "avoid}}";

/* How a kind of block begins and ends, and what encloses several of it; of cells, their tag. */
static const struct {
  const char *begin, *end, *enclosure, *cell;
} looks[] = {
    [DEA_BLOCK_TITLE] = {"<h1>", "</h1>\n", "", NULL},
    [DEA_BLOCK_HEADING] = {"<h2>", "</h2>\n", "", NULL},
    [DEA_BLOCK_TEXT] = {"<p>", "</p>\n", "", NULL},
    [DEA_BLOCK_NOTE] = {"<p class=\"note\">", "</p>\n", "", NULL},
    [DEA_BLOCK_STEP] = {"<li>\xe2\x98\x90 ", "</li>\n", "ol", NULL},
    [DEA_BLOCK_HEAD] = {"<tr>", "</tr>\n", "table", "th"},
    [DEA_BLOCK_ROW] = {"<tr>", "</tr>\n", "table", "td"},
};

static void add_words(struct dea_document *document, const char *format, va_list args)
{
  struct dea_text *html = &document->html;
  va_list again;
  va_copy(again, args);
  const int length = vsnprintf(NULL, 0, format, args);
  char *text = html->failed ? NULL : dea_alloc(html->ctx, (size_t)length + 1, 1);
  if (text != NULL) {
    vsnprintf(text, (size_t)length + 1, format, again);
    dea_xml_add(html, text);
  }
  va_end(again);
  html->failed = html->failed || text == NULL;
  dea_free(html->ctx, text);
}

static void add_cell(struct dea_document *document, const char *format, va_list args)
{
  const char *tag = looks[document->kind].cell;
  if (tag != NULL) {
    dea_text_add(&document->html, "<%s>", tag);
  }
  add_words(document, format, args);
  if (tag != NULL) {
    dea_text_add(&document->html, "</%s>", tag);
  }
}

/* Ends the last block, and what encloses it unless it goes on. */
static void end_block(struct dea_document *document, const char *wanted, bool new_table)
{
  const char *open = looks[document->kind].enclosure;
  dea_text_add(&document->html, "%s", looks[document->kind].end);
  if (document->count == 2) {
    dea_text_add(&document->html,
                 "<div role=\"img\" aria-label=\"Drawing of the actuator\">%s</div>\n",
                 document->drawing != NULL ? document->drawing : "");
  }
  document->open = open[0] != '\0' && strcmp(open, wanted) == 0 && !new_table;
  if (open[0] != '\0' && !document->open) {
    dea_text_add(&document->html, "</%s>\n", open);
  }
}

/* The title is that of the file too. */
static void begin_file(struct dea_document *document, const char *format, va_list args)
{
  va_list again;
  va_copy(again, args);
  dea_text_add(&document->html,
               "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
               "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
               "style-src 'unsafe-inline'\">\n"
               "<meta name=\"viewport\" content=\"width=device-width\">\n<title>");
  add_words(document, format, again);
  dea_text_add(&document->html, "</title>\n<style>%s</style>\n</head>\n<body>\n", style);
  va_end(again);
}

void dea_document_add(struct dea_document *document, enum dea_block_kind kind, const char *format,
                      ...)
{
  const char *wanted = looks[kind].enclosure;
  va_list args;
  va_start(args, format);
  if (document->count == 0) {
    begin_file(document, format, args);
  } else {
    end_block(document, wanted, kind == DEA_BLOCK_HEAD);
  }
  if (wanted[0] != '\0' && !document->open) {
    dea_text_add(&document->html, "<%s>\n", wanted);
  }
  document->kind = kind;
  document->count++;
  dea_text_add(&document->html, "%s", looks[kind].begin);
  add_cell(document, format, args);
  va_end(args);
}

void dea_document_cell(struct dea_document *document, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  add_cell(document, format, args);
  va_end(args);
}

void dea_document_end(struct dea_document *document)
{
  end_block(document, "", false);
  dea_text_add(&document->html, "</body>\n</html>\n");
}
