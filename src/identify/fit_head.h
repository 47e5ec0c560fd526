/* What the fit files of materials and of devices have in common, and how both are read. */
#pragma once

#include "base/schema.h"

#include <stddef.h>

enum { DEA_FIT_VERSION = 1 };

/* First member of both. */
struct dea_fit_head {
  const char *file; // interned
  char sha256[65];
  struct dea_quantity version;
  struct dea_label name, title, source;
  struct dea_yaml *document; // owned
};

struct dea_fit_parameter_text {
  struct dea_label name, start, low, high, prior, prior_std;
  struct dea_choice fixed;
};

/* Rows of both tables: the first keys of a file ... */
#define DEA_FIT_HEAD_AT(member) offsetof(struct dea_fit_head, member)
#define DEA_FIT_HEAD_FIELDS(name_doc, name_example, title_absent, title_doc, title_example)        \
  DEA_INTEGER_ROW("dea_fit", DEA_FIT_HEAD_AT(version), "1", "version of the format",               \
                  .min = DEA_FIT_VERSION, .max = DEA_FIT_VERSION, .required = true),               \
      DEA_LABEL_ROW("name", DEA_FIT_HEAD_AT(name), name_example, name_doc, .required = true),      \
      DEA_LABEL_ROW("title", DEA_FIT_HEAD_AT(title), title_example, title_doc,                     \
                    .absent_text = title_absent),                                                  \
      DEA_LABEL_ROW("source", DEA_FIT_HEAD_AT(source), "our lab, June 2026",                       \
                    "where the measurements come from", .absent_text = "none")

/* ... and those of a parameter: a text, and whether it keeps its start. */
#define DEA_FIT_PARAMETER_FIELD(word, meaning, shown, without)                                     \
  DEA_LABEL_ROW(#word, offsetof(struct dea_fit_parameter_text, word), shown, meaning,              \
                .absent_text = without)
#define DEA_FIT_FIXED_FIELD                                                                        \
  DEA_CHOICE_ROW("fixed", offsetof(struct dea_fit_parameter_text, fixed), dea_no_yes, "yes",       \
                 "whether it keeps its start", .default_text = "no")

/* Whether a file has a key, by which the kinds of fit files are told apart: `design` of a device,
 * `breakdown` of breakdown tests, `life` of life tests, none of a material. Status as of reading.
 */
dea_status dea_fit_file_has(struct dea_context *ctx, const char *file, const char *key, bool *out);

/* A kind of file: its keys, and its struct of `size` bytes, which begins with a head; check: what
 * the table cannot say, asked where the table is kept, NULL: nothing. */
struct dea_fit_form {
  struct dea_record record;
  size_t size;
  dea_status (*check)(struct dea_context *ctx, const void *fit);
};

/* Reads a file into a new struct of that kind. Errors are findings with their places; DEA_E_DESIGN
 * then. out: owned by the caller (dea_fit_head_destroy), NULL on failure. */
dea_status dea_fit_head_read(struct dea_context *ctx, const char *file,
                             const struct dea_fit_form *form, void **out);
/* fit: begins with its head, or NULL. */
void dea_fit_head_destroy(struct dea_context *ctx, void *fit);

/* A finding for each name that stands twice. items: [count] of `size` bytes that begin with their
 * name; what: "test". */
dea_status dea_fit_names_check(struct dea_context *ctx, const void *items, size_t count,
                               size_t size, const char *what);
