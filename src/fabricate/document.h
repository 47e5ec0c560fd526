/* A document for people, headings, text and tables, as one HTML file that needs nothing else. */
#pragma once

#include "base/text.h"

enum dea_block_kind {
  DEA_BLOCK_TITLE, // the first block
  DEA_BLOCK_HEADING,
  DEA_BLOCK_TEXT,
  DEA_BLOCK_NOTE, // small
  DEA_BLOCK_STEP, // numbered, with a box to tick
  DEA_BLOCK_HEAD, // first row of a table
  DEA_BLOCK_ROW,
};

struct dea_document {
  struct dea_text html;     // with its context; to be freed
  const char *drawing;      // SVG text that is put after the second block, NULL: none
  size_t count;             // of blocks so far
  enum dea_block_kind kind; // of the last one
  bool open;                // what encloses it stays open for the next one
};

/* Adds a block with one cell, or the next cell of a row (printf style). */
void dea_document_add(struct dea_document *document, enum dea_block_kind kind, const char *format,
                      ...) DEA_PRINTF(3, 4);
void dea_document_cell(struct dea_document *document, const char *format, ...) DEA_PRINTF(2, 3);
/* Ends the file, which has blocks. */
void dea_document_end(struct dea_document *document);
