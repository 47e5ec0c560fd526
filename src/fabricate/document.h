/* A document for people: headings, text and tables. */
#pragma once

#include "base/text.h"

enum { DEA_CELLS_MAX = 6 };

enum dea_block_kind {
  DEA_BLOCK_TITLE,
  DEA_BLOCK_HEADING,
  DEA_BLOCK_TEXT,
  DEA_BLOCK_NOTE, // small
  DEA_BLOCK_STEP, // numbered, with a box to tick
  DEA_BLOCK_HEAD, // first row of a table
  DEA_BLOCK_ROW,
};

struct dea_document_block {
  enum dea_block_kind kind;
  char *cell[DEA_CELLS_MAX]; // text; rows of tables have several; owned
  size_t cells;
};

struct dea_document {
  struct dea_context *ctx;
  struct dea_document_block *block; // owned
  size_t count, capacity;
  bool failed; // memory was short; stays set, as in struct dea_text
};

/* Adds a block with one cell, or the next cell of a row (printf style). */
void dea_document_add(struct dea_document *document, enum dea_block_kind kind, const char *format,
                      ...) DEA_PRINTF(3, 4);
void dea_document_cell(struct dea_document *document, const char *format, ...) DEA_PRINTF(2, 3);
void dea_document_free(struct dea_document *document);

/* One HTML file that needs nothing else; drawing: SVG text that is put after the title, or "". */
void dea_document_html(const struct dea_document *document, const char *drawing,
                       struct dea_text *out);
