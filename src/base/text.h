/* A growing text or growing bytes, and small things on text. */
#pragma once

#include "base/context.h"

/* Zero-initialise with the context set: struct dea_text t = {.ctx = ctx}. After a failed append the
 * text keeps what it had and `failed` stays set, so that it can be checked once at the end. */
struct dea_text {
  struct dea_context *ctx;
  char *data; // NULL or NUL-terminated; owned
  size_t length, capacity;
  bool failed;
};

/* Numbers have a decimal point whatever the program's locale. */
void dea_text_add(struct dea_text *text, const char *format, ...) DEA_PRINTF(2, 3);
/* The same of any bytes, zeros too; a text's end stays behind them. */
void dea_text_add_bytes(struct dea_text *text, const void *bytes, size_t length);
/* The text so far, "" if nothing was added; lent until the next change. */
const char *dea_text_get(const struct dea_text *text);
/* Frees it; DEA_E_MEMORY where an append has failed. */
dea_status dea_text_free(struct dea_text *text);
/* The same of one that has gone into another text, which then has failed too. */
void dea_text_free_in(struct dea_text *text, struct dea_text *outer);

/* First letter of UTF-8 text into *code, and the bytes that it takes: 0 (and code 0xfffd) where no
 * letter is: a stray or missing byte, one written longer than need be, a surrogate, beyond
 * 0x10ffff. Control characters are letters like others; the text's end is code 0 of one byte. */
size_t dea_letter_read(const char *text, unsigned *code);
/* Whether a letter is a control character (C0, DEL, C1), which a terminal obeys, a line end among
 * them, or turns the direction of what follows (Unicode's Bidi_Control), so that a text shows as
 * another one. */
bool dea_letter_is_control(unsigned code);
/* Bytes of a text, at most so many, cut between letters. */
size_t dea_text_cut(const char *text, size_t most);
/* Control characters of UTF-8 text become blanks, in place. */
void dea_text_flatten(char *text);
/* How XML and HTML write a letter that means something to them ("&lt;"); NULL for others. */
const char *dea_entity_name(unsigned code);

/* Candidate nearest to `word` by edit distance (case folded), or NULL when none is near enough to
 * be what was meant (distance above a third of the word's length, at least 1), nor the only one
 * that begins with the word or that the word begins with (of three characters or more). */
const char *dea_nearest_name(const char *word, const char *const candidates[], size_t count);
/* "a, b, c", as much of it as there is room for. Returns out. */
enum { DEA_HINT_SIZE = 1024 };
const char *dea_names_list(const char *const names[], size_t count, char out[DEA_HINT_SIZE]);
/* What a message says behind a word that is none of `names`: "; did you mean 'b'?", "" where none
 * is near. Returns out. */
const char *dea_name_hint(const char *word, const char *const names[], size_t count,
                          char out[DEA_HINT_SIZE]);
/* The same with their list, "none" of an empty one: "; did you mean 'b'?" with `near` and the list
 * behind it (NULL: without), or `far` and the list where none is near: " All laws: ", "; there are:
 * ". */
const char *dea_name_hint_list(const char *word, const char *const names[], size_t count,
                               const char *near, const char *far, char out[DEA_HINT_SIZE]);
/* DEA_E_ARGUMENT with "there is no WHAT 'NAME'" and dea_name_hint. */
dea_status dea_unknown_name(struct dea_context *ctx, const char *what, const char *name,
                            const char *const known[], size_t count);

bool dea_text_ends_with(const char *text, const char *end);

/* Number of a text in the C locale, whatever the program's locale; *end as in strtod. */
double dea_text_to_double(const char *text, const char **end);
