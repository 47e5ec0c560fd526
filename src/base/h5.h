/* Small things on the HDF5 C API for the files that write and read HDF5.
 *
 * A struct h5 remembers the first failure, after which all calls do nothing, so that a row of calls
 * is checked once at its end. Its error stack is turned into the message of dea_fail. */
#pragma once

#include "base/context.h"

#include <hdf5.h>

struct h5 {
  struct dea_context *ctx;
  const char *path;   // of the file, for messages
  const char *not_it; // begins the message about a file that cannot be read; may be replaced
  dea_status status;
  bool reading;      // from a file that was opened, not into one that was made
  H5E_auto2_t print; // what HDF5 did with errors before
  void *print_data;
};

/* Silences HDF5's own printing for this thread until dea_h5_end. */
void dea_h5_begin(struct h5 *h, struct dea_context *ctx, const char *path);
void dea_h5_end(struct h5 *h);
/* Records the failure with the innermost text of HDF5's error stack; what: "cannot write". */
void dea_h5_fail(struct h5 *h, const char *what);

/* A file is made in memory (core driver) and written as a whole or not at all, so that a full disk
 * is an ordinary error; writing closes it. */
hid_t dea_h5_file_create(struct h5 *h);
void dea_h5_file_write(struct h5 *h, hid_t file);

/* Opens a regular file to read it. written: it may be marked as being written, and is then read as
 * it is. One with anything that lies in another file (external links, external or virtual data) is
 * refused: HDF5 would open what is named there, whatever it is. */
hid_t dea_h5_file_open(struct h5 *h, bool written);

/* Handles are negative after a failure; dea_h5_close takes any. group_get: opened, or made when it
 * is not there. */
hid_t dea_h5_group_get(struct h5 *h, hid_t parent, const char *name);
hid_t dea_h5_group_create(struct h5 *h, hid_t parent, const char *name);
hid_t dea_h5_group_open(struct h5 *h, hid_t parent, const char *name);
void dea_h5_close(hid_t object);

void dea_h5_write_text(struct h5 *h, hid_t object, const char *name, const char *text);
void dea_h5_write_int(struct h5 *h, hid_t object, const char *name, long long value);
void dea_h5_write_real(struct h5 *h, hid_t object, const char *name, double value);
/* One-dimensional dataset with its unit and meaning. memory_type, file_type: HDF5 types. */
void dea_h5_write_array(struct h5 *h, hid_t group, const char *name, hid_t memory_type,
                        hid_t file_type, size_t count, const void *values, const char *unit,
                        const char *meaning);
/* Bytes of the file that an object is in; 0 when they cannot be found out. */
hsize_t dea_h5_file_size(const struct h5 *h, hid_t object);
/* A dataset by name, for its attributes. */
hid_t dea_h5_array_open(struct h5 *h, hid_t group, const char *name);
/* Gives an object of `from` the same name in `to` as well. */
void dea_h5_link(struct h5 *h, hid_t from, const char *name, hid_t to);
/* UTF-8 text of any length as a scalar dataset. */
void dea_h5_write_long_text(struct h5 *h, hid_t group, const char *name, const char *text);

/* Readers of attributes fail when the attribute is missing. Text longer than size is cut. */
void dea_h5_get_text(struct h5 *h, hid_t object, const char *name, char *out, size_t size);
long long dea_h5_get_int(struct h5 *h, hid_t object, const char *name);
double dea_h5_get_real(struct h5 *h, hid_t object, const char *name);
bool dea_h5_has_attribute(const struct h5 *h, hid_t object, const char *name);
/* True when a link of that name exists. */
bool dea_h5_has(const struct h5 *h, hid_t group, const char *name);
/* A one-dimensional dataset of exactly `count` values. */
void dea_h5_get_array(struct h5 *h, hid_t group, const char *name, hid_t memory_type, size_t count,
                      void *out);
/* Text of a scalar dataset, or else of an attribute of that name; NULL when there is neither. Owned
 * by the caller. A failure when the file is shorter than the text. */
char *dea_h5_get_long_text(struct h5 *h, hid_t group, const char *name);
/* Number of links of a group, and the name of one of them in alphabetical order. */
size_t dea_h5_link_count(struct h5 *h, hid_t group);
void dea_h5_link_name(struct h5 *h, hid_t group, size_t index, char *out, size_t size);

/* The same calls read and write: they return what is in a file that was opened, and write the value
 * that is given into one that was made. int: a value read is within low and high, or a failure.
 * text, values, texts: filled or written; long_text: what is read is owned by the caller. texts:
 * [count][size], each with its end. */
hid_t dea_h5_group(struct h5 *h, hid_t parent, const char *name);
long long dea_h5_int(struct h5 *h, hid_t object, const char *name, long long value, long long low,
                     long long high);
double dea_h5_real(struct h5 *h, hid_t object, const char *name, double value);
void dea_h5_text(struct h5 *h, hid_t object, const char *name, char *text, size_t size);
char *dea_h5_long_text(struct h5 *h, hid_t group, const char *name, char *text);
void dea_h5_array(struct h5 *h, hid_t group, const char *name, hid_t memory_type, hid_t file_type,
                  size_t count, void *values, const char *unit, const char *meaning);
void dea_h5_texts(struct h5 *h, hid_t group, const char *name, size_t count, size_t size,
                  char *texts, const char *meaning);
