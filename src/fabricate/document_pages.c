/* A document on pages of A4: lines are filled word by word, rows of tables are kept together. */
#include "fabricate/document.h"

#include <stdio.h>
#include <string.h>

enum { INK = 0x202020, GREY = 0x6a6a6a, RULE = 0xc4c8ce, WORDS_MAX = 512 };

static const double width = 210, height = 297, left = 18, top = 18, bottom = 20;
static const double text_size = 2.9, small_size = 2.4, leading = 1.42;

struct writer {
  const struct dea_paper *paper;
  double y; // of the next line's upper edge
  int page, step;
  const struct dea_document_block *head; // of the table
};

/* The part of a text that fits on one line: its length, and where the next one starts. */
static size_t fit(const struct dea_paper *paper, double size, bool bold, double capacity,
                  const char *text, char line[WORDS_MAX], const char **next)
{
  size_t used = 0, taken = 0;
  for (const char *at = text; *at != '\0';) {
    size_t word = strcspn(at, " "), end = (size_t)(at - text) + word;
    if (end >= WORDS_MAX - 1) {
      end = WORDS_MAX - 2;
    }
    memcpy(line, text, end);
    line[end] = '\0';
    if (taken > 0 && paper->type->text_width(paper->canvas, size, bold, line) > capacity) {
      break;
    }
    // a word that is wider than the room is cut, not inside of a letter
    while (taken == 0 && end > 1 &&
           paper->type->text_width(paper->canvas, size, bold, line) > capacity) {
      do {
        end--;
      } while (end > 1 && (text[end] & 0xc0) == 0x80);
      line[end] = '\0';
    }
    used = taken = end;
    if (text + end != at + word) {
      break;
    }
    at += word + strspn(at + word, " ");
  }
  line[used] = '\0';
  memcpy(line, text, used);
  *next = text + taken;
  *next += strspn(*next, " ");
  return taken;
}

/* Draws a text in a column of a table, or only counts its lines. */
static int flow(const struct writer *w, bool draw, double x, bool bold, double capacity,
                const char *text)
{
  int lines = 0;
  do {
    char line[WORDS_MAX];
    const char *next;
    if (fit(w->paper, small_size, bold, capacity, text, line, &next) == 0) {
      break;
    }
    if (draw) {
      w->paper->type->text(w->paper->canvas, x, w->y - 1 - small_size * (lines * leading + 1),
                           small_size, 0, DEA_ALIGN_LEFT, bold, INK, line);
    }
    text = next;
    lines++;
  } while (*text != '\0');
  return lines;
}

static void number_page(const struct writer *w)
{
  char text[16];
  snprintf(text, sizeof text, "%d", w->page);
  w->paper->type->text(w->paper->canvas, width - left, 10, small_size, 0, DEA_ALIGN_RIGHT, false,
                       GREY, text);
}

/* Room of a height, on the next page if need be; true when a page was begun. */
static bool need(struct writer *w, double needed)
{
  if (w->y - needed >= bottom) {
    return false;
  }
  number_page(w);
  w->paper->type->page(w->paper->canvas, width, height);
  w->y = height - top;
  w->page++;
  return true;
}

/* before: room above; also: what has to fit below it on the same page. */
static void write_text(struct writer *w, double before, double indent, double size, bool bold,
                       unsigned colour, double also, const char *text)
{
  double capacity = width - 2 * left - indent, line_height = size * leading;
  need(w, before + line_height + also);
  w->y -= before;
  while (*text != '\0') {
    char line[WORDS_MAX];
    if (fit(w->paper, size, bold, capacity, text, line, &text) == 0) {
      break;
    }
    need(w, line_height);
    w->paper->type->text(w->paper->canvas, left + indent, w->y - size, size, 0, DEA_ALIGN_LEFT,
                         bold, colour, line);
    w->y -= line_height;
  }
}

static void rule(struct writer *w, double thickness, unsigned colour)
{
  w->paper->type->line(w->paper->canvas, left, w->y, width - left, w->y);
  w->paper->type->stroke(w->paper->canvas, thickness, colour, 0);
}

static double row_height(const struct writer *w, const struct dea_document_block *row, bool bold)
{
  int lines = 1;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a table has its head
  for (size_t c = 0; c < row->cells && c < w->head->cells; c++) {
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a table has its head
    double capacity = w->head->width[c] * (width - 2 * left) - 3;
    int its = flow(w, false, 0, bold, capacity, row->cell[c]);
    lines = its > lines ? its : lines;
  }
  return lines * small_size * leading + 2.4;
}

static void draw_row(struct writer *w, const struct dea_document_block *row, bool bold)
{
  double x = left, tall = row_height(w, row, bold);
  for (size_t c = 0; c < row->cells && c < w->head->cells; c++) {
    double column = w->head->width[c] * (width - 2 * left);
    flow(w, true, x, bold, column - 3, row->cell[c]);
    x += column;
  }
  w->y -= tall;
  rule(w, bold ? 0.25 : 0.13, bold ? INK : RULE);
}

static void write_row(struct writer *w, const struct dea_document_block *row, bool is_head)
{
  if (is_head) {
    w->head = row;
    w->y -= 1.5;
    need(w, row_height(w, row, true) + 14);
  } else if (need(w, row_height(w, row, false))) {
    draw_row(w, w->head, true); // again on the new page
  }
  draw_row(w, row, is_head);
}

static void write_step(struct writer *w, const char *text)
{
  static const double box = 2.6;
  char number[16];
  double before = 1.6;
  need(w, before + 2 * text_size * leading);
  double line = w->y - before - text_size;
  w->paper->type->box(w->paper->canvas, left, line - 0.3, box, box);
  w->paper->type->stroke(w->paper->canvas, 0.2, INK, 0);
  snprintf(number, sizeof number, "%d", ++w->step);
  w->paper->type->text(w->paper->canvas, left + 9.5, line, text_size, 0, DEA_ALIGN_RIGHT, true, INK,
                       number);
  write_text(w, before, 12, text_size, false, INK, 0, text);
}

void dea_document_pages(const struct dea_paper *paper, const struct dea_document *document)
{
  struct writer w = {.paper = paper, .y = height - top, .page = 1};
  for (size_t i = 0; i < document->count; i++) {
    const struct dea_document_block *block = &document->block[i];
    const char *text = block->cells > 0 ? block->cell[0] : "";
    switch (block->kind) {
    case DEA_BLOCK_TITLE:
      write_text(&w, 0, 0, 5, true, INK, 10, text);
      rule(&w, 0.25, INK);
      break;
    case DEA_BLOCK_HEADING: // with some of what follows
      write_text(&w, 6, 0, 3.6, true, INK, 25, text);
      break;
    case DEA_BLOCK_TEXT:
      write_text(&w, 2, 0, text_size, false, INK, 0, text);
      break;
    case DEA_BLOCK_NOTE:
      write_text(&w, 1.5, 0, small_size, false, GREY, 0, text);
      break;
    case DEA_BLOCK_STEP:
      write_step(&w, text);
      break;
    case DEA_BLOCK_HEAD:
    case DEA_BLOCK_ROW:
      write_row(&w, block, block->kind == DEA_BLOCK_HEAD);
      break;
    }
  }
  number_page(&w);
}
