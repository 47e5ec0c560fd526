#include "base/h5.h"

#include "base/file.h"
#include "base/write_file.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { OUTER_SIZE = 200 };

void dea_h5_begin(struct h5 *h, struct dea_context *ctx, const char *path)
{
  *h = (struct h5){.ctx = ctx, .path = path, .not_it = "not a complete results file:"};
  H5open();
  H5Eget_auto2(H5E_DEFAULT, &h->print, &h->print_data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

void dea_h5_end(struct h5 *h)
{
  H5Eclear2(H5E_DEFAULT);
  H5Eset_auto2(H5E_DEFAULT, h->print, h->print_data);
}

/* Takes the first (innermost) description of an error stack. */
static herr_t read_description(unsigned n, const H5E_error2_t *error, void *user)
{
  (void)n;
  const char **text = user;
  if (*text == NULL && error->desc != NULL) {
    *text = error->desc;
  }
  return 0;
}

void dea_h5_fail(struct h5 *h, const char *what)
{
  if (h->status != DEA_OK) {
    return;
  }
  const char *text = NULL;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, read_description, (void *)&text);
  h->status = dea_fail(h->ctx, DEA_E_IO, "%s %s%s%s", what, h->path, text != NULL ? ": " : "",
                       text != NULL ? text : "");
}

static const char cannot_write[] = "cannot write";

static hid_t checked(struct h5 *h, hid_t id, const char *what)
{
  if (id < 0) {
    dea_h5_fail(h, what);
  }
  return id;
}

hid_t dea_h5_file_create(struct h5 *h)
{
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 18, false);
  hid_t file = H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  dea_h5_close(access);
  return checked(h, file, cannot_write);
}

/* The whole file as bytes; owned by the caller. */
static char *file_image(struct h5 *h, hid_t file, size_t *length)
{
  *length = 0;
  ssize_t size = -1;
  if (h->status == DEA_OK && H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0) {
    size = H5Fget_file_image(file, NULL, 0);
  }
  if (size < 0) {
    dea_h5_fail(h, cannot_write);
    return NULL;
  }
  char *bytes = dea_alloc(h->ctx, (size_t)size, 1);
  if (bytes == NULL) {
    h->status = DEA_E_MEMORY;
  } else if (H5Fget_file_image(file, bytes, (size_t)size) != size) {
    dea_h5_fail(h, cannot_write);
  }
  *length = (size_t)size;
  return bytes;
}

void dea_h5_file_write(struct h5 *h, hid_t file)
{
  size_t length;
  char *bytes = file_image(h, file, &length);
  dea_h5_close(file);
  if (h->status == DEA_OK) {
    h->status = dea_file_write(h->ctx, h->path, bytes, length);
  }
  dea_free(h->ctx, bytes);
}

/* What lies in another file. The visit ends at the first with 1. */
static herr_t find_outer_link(hid_t group, const char *name, const H5L_info_t *info, void *user)
{
  (void)group;
  snprintf(user, OUTER_SIZE, "%s", name);
  return info->type != H5L_TYPE_HARD && info->type != H5L_TYPE_SOFT;
}

static herr_t find_outer_data(hid_t object, const char *name, const H5O_info_t *info, void *user)
{
  if (info->type != H5O_TYPE_DATASET) {
    return 0;
  }
  hid_t set = H5Dopen2(object, name, H5P_DEFAULT);
  hid_t properties = set >= 0 ? H5Dget_create_plist(set) : H5I_INVALID_HID;
  int files = properties >= 0 ? H5Pget_external_count(properties) : -1;
  bool outer = files > 0 || H5Pget_layout(properties) == H5D_VIRTUAL;
  snprintf(user, OUTER_SIZE, "%s", name);
  dea_h5_close(properties);
  dea_h5_close(set);
  return files < 0 ? -1 : outer;
}

static void refuse_outer(struct h5 *h, hid_t file)
{
  char name[OUTER_SIZE];
  herr_t found = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, find_outer_link, name);
  if (found == 0) {
    found = H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, find_outer_data, name, H5O_INFO_BASIC);
  }
  if (found > 0) {
    h->status = dea_fail(h->ctx, DEA_E_IO,
                         "%s refers to another file in '%s', which is not followed: write one file "
                         "with all in it (h5repack)",
                         h->path, name);
  } else if (found < 0) {
    dea_h5_fail(h, h->not_it);
  }
}

hid_t dea_h5_file_open(struct h5 *h, bool written)
{
  char head[1];
  size_t length;
  h->reading = true;
  if (h->status != DEA_OK) {
    return H5I_INVALID_HID;
  }
  if (!dea_file_head(h->path, head, sizeof head, &length)) {
    h->status = dea_fail(h->ctx, DEA_E_IO,
                         "cannot read %s: it does not exist, or is no file that "
                         "may be read",
                         h->path);
    return H5I_INVALID_HID;
  }
  hid_t file = H5Fopen(h->path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0 && written) {
    H5Eclear2(H5E_DEFAULT);
    // what a program is just writing is read again, each time after twice the wait, from 1 ns on:
    // with HDF5's default of 100 times a damaged file would take longer than anybody lives
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_metadata_read_attempts(access, 22);
    file = H5Fopen(h->path, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access);
    dea_h5_close(access);
  }
  if (checked(h, file, "cannot read") >= 0) {
    refuse_outer(h, file);
  }
  if (h->status != DEA_OK) {
    dea_h5_close(file);
    file = H5I_INVALID_HID;
  }
  return file;
}

hid_t dea_h5_group_get(struct h5 *h, hid_t parent, const char *name)
{
  return dea_h5_has(h, parent, name) ? dea_h5_group_open(h, parent, name)
                                     : dea_h5_group_create(h, parent, name);
}

hid_t dea_h5_group_create(struct h5 *h, hid_t parent, const char *name)
{
  if (h->status != DEA_OK) {
    return H5I_INVALID_HID;
  }
  return checked(h, H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), cannot_write);
}

/* Opens what is in a group; what is missing is said. */
static hid_t open_member(struct h5 *h, hid_t group, const char *name,
                         hid_t (*open)(hid_t, const char *, hid_t))
{
  if (h->status == DEA_OK && H5Lexists(group, name, H5P_DEFAULT) == 0) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s %s: '%s' is missing", h->not_it, h->path, name);
  }
  return h->status == DEA_OK ? checked(h, open(group, name, H5P_DEFAULT), h->not_it)
                             : H5I_INVALID_HID;
}

hid_t dea_h5_group_open(struct h5 *h, hid_t parent, const char *name)
{
  return open_member(h, parent, name, H5Gopen2);
}

hid_t dea_h5_array_open(struct h5 *h, hid_t group, const char *name)
{
  return open_member(h, group, name, H5Dopen2);
}

void dea_h5_close(hid_t object)
{
  if (object >= 0) {
    H5Idec_ref(object);
  }
}

static hid_t text_type(size_t size, H5T_cset_t characters)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, size);
  H5Tset_cset(type, characters);
  return type;
}

static void write_scalar(struct h5 *h, hid_t object, const char *name, hid_t memory_type,
                         hid_t file_type, const void *value)
{
  if (h->status != DEA_OK) {
    return;
  }
  hid_t space = H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0 || H5Awrite(attribute, memory_type, value) < 0) {
    dea_h5_fail(h, cannot_write);
  }
  dea_h5_close(attribute);
  dea_h5_close(space);
}

void dea_h5_write_text(struct h5 *h, hid_t object, const char *name, const char *text)
{
  const char *value = text != NULL ? text : "";
  hid_t type = text_type(strlen(value) + 1, H5T_CSET_UTF8);
  write_scalar(h, object, name, type, type, value);
  dea_h5_close(type);
}

void dea_h5_write_int(struct h5 *h, hid_t object, const char *name, long long value)
{
  write_scalar(h, object, name, H5T_NATIVE_LLONG, H5T_STD_I64LE, &value);
}

void dea_h5_write_real(struct h5 *h, hid_t object, const char *name, double value)
{
  write_scalar(h, object, name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, &value);
}

static hid_t create_dataset(struct h5 *h, hid_t group, const char *name, hid_t memory_type,
                            hid_t file_type, hid_t space, const void *values)
{
  hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(properties, false); // the same result gives the same bytes
  hid_t set = H5Dcreate2(group, name, file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  if (set < 0 || H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
    dea_h5_fail(h, cannot_write);
  }
  dea_h5_close(properties);
  return set;
}

void dea_h5_write_array(struct h5 *h, hid_t group, const char *name, hid_t memory_type,
                        hid_t file_type, size_t count, const void *values, const char *unit,
                        const char *meaning)
{
  if (h->status != DEA_OK) {
    return;
  }
  hsize_t length = count;
  hid_t space = H5Screate_simple(1, &length, NULL);
  hid_t set = create_dataset(h, group, name, memory_type, file_type, space, values);
  dea_h5_write_text(h, set, "unit", unit);
  dea_h5_write_text(h, set, "meaning", meaning);
  dea_h5_close(set);
  dea_h5_close(space);
}

hsize_t dea_h5_file_size(const struct h5 *h, hid_t object)
{
  hsize_t size = 0;
  hid_t file = h->status == DEA_OK ? H5Iget_file_id(object) : H5I_INVALID_HID;
  if (file < 0 || H5Fget_filesize(file, &size) < 0) {
    size = 0;
  }
  dea_h5_close(file);
  return size;
}

void dea_h5_link(struct h5 *h, hid_t from, const char *name, hid_t to)
{
  if (h->status == DEA_OK && H5Lcreate_hard(from, name, to, name, H5P_DEFAULT, H5P_DEFAULT) < 0) {
    dea_h5_fail(h, cannot_write);
  }
}

void dea_h5_write_long_text(struct h5 *h, hid_t group, const char *name, const char *text)
{
  if (h->status != DEA_OK || text == NULL) {
    return;
  }
  hid_t space = H5Screate(H5S_SCALAR);
  hid_t type = text_type(strlen(text) + 1, H5T_CSET_ASCII); // all that Octave's load takes
  hid_t set = create_dataset(h, group, name, type, type, space, text);
  dea_h5_write_text(h, set, "encoding", "UTF-8");
  dea_h5_close(set);
  dea_h5_close(type);
  dea_h5_close(space);
}

/* True when an attribute or dataset of this space holds exactly one value. */
static bool is_single(hid_t space)
{
  return space >= 0 && H5Sget_simple_extent_npoints(space) == 1;
}

/* Text of an attribute or of a scalar dataset, of a fixed length or not; owned by the caller. NULL:
 * it is none, or the file is shorter than it. */
static char *read_text(struct h5 *h, hid_t object, bool attribute)
{
  hid_t type = attribute ? H5Aget_type(object) : H5Dget_type(object);
  hid_t space = attribute ? H5Aget_space(object) : H5Dget_space(object);
  bool good = type >= 0 && is_single(space) && H5Tget_class(type) == H5T_STRING &&
              (attribute || H5Dget_storage_size(object) > 0);
  bool variable = good && H5Tis_variable_str(type) > 0;
  char *text = NULL, *lent = NULL;
  if (good && !variable && H5Tget_size(type) <= dea_h5_file_size(h, object)) {
    text = dea_alloc(h->ctx, H5Tget_size(type) + 1, 1);
    h->status = text != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  void *to = variable ? (void *)&lent : text;
  good = to != NULL && (attribute ? H5Aread(object, type, to)
                                  : H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to)) >= 0;
  if (good && variable) {
    text = dea_copy_text(h->ctx, lent != NULL ? lent : "", SIZE_MAX);
    h->status = text != NULL ? DEA_OK : DEA_E_MEMORY;
    H5free_memory(lent);
  }
  if (!good) {
    dea_h5_fail(h, h->not_it);
    dea_free(h->ctx, text);
    text = NULL;
  }
  dea_h5_close(space);
  dea_h5_close(type);
  return text;
}

/* An attribute; what is missing is said. */
static hid_t open_attribute(struct h5 *h, hid_t object, const char *name)
{
  if (h->status == DEA_OK && H5Aexists(object, name) == 0) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s %s: the attribute '%s' is missing", h->not_it,
                         h->path, name);
  }
  return h->status == DEA_OK ? checked(h, H5Aopen(object, name, H5P_DEFAULT), h->not_it)
                             : H5I_INVALID_HID;
}

void dea_h5_get_text(struct h5 *h, hid_t object, const char *name, char *out, size_t size)
{
  hid_t attribute = open_attribute(h, object, name);
  char *text = h->status == DEA_OK ? read_text(h, attribute, true) : NULL;
  snprintf(out, size, "%s", text != NULL ? text : "");
  dea_free(h->ctx, text);
  dea_h5_close(attribute);
}

static void get_scalar(struct h5 *h, hid_t object, const char *name, hid_t memory_type, void *out)
{
  if (h->status != DEA_OK) {
    return;
  }
  hid_t attribute = open_attribute(h, object, name);
  hid_t space = attribute >= 0 ? H5Aget_space(attribute) : H5I_INVALID_HID;
  if (!is_single(space) || H5Aread(attribute, memory_type, out) < 0) {
    dea_h5_fail(h, h->not_it);
  }
  dea_h5_close(space);
  dea_h5_close(attribute);
}

long long dea_h5_get_int(struct h5 *h, hid_t object, const char *name)
{
  long long value = 0;
  get_scalar(h, object, name, H5T_NATIVE_LLONG, &value);
  return value;
}

double dea_h5_get_real(struct h5 *h, hid_t object, const char *name)
{
  double value = 0.0;
  get_scalar(h, object, name, H5T_NATIVE_DOUBLE, &value);
  return value;
}

bool dea_h5_has_attribute(const struct h5 *h, hid_t object, const char *name)
{
  return h->status == DEA_OK && H5Aexists(object, name) > 0;
}

bool dea_h5_has(const struct h5 *h, hid_t group, const char *name)
{
  return h->status == DEA_OK && H5Lexists(group, name, H5P_DEFAULT) > 0;
}

void dea_h5_get_array(struct h5 *h, hid_t group, const char *name, hid_t memory_type, size_t count,
                      void *out)
{
  if (h->status != DEA_OK) {
    return;
  }
  hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
  hid_t space = set >= 0 ? H5Dget_space(set) : H5I_INVALID_HID;
  if (space >= 0 && H5Sget_simple_extent_npoints(space) != (hssize_t)count) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: dataset '%s' has not %zu values",
                         h->path, name, count);
  } else if (space < 0 || H5Dread(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0) {
    dea_h5_fail(h, h->not_it);
  }
  dea_h5_close(space);
  dea_h5_close(set);
}

char *dea_h5_get_long_text(struct h5 *h, hid_t group, const char *name)
{
  bool set = dea_h5_has(h, group, name);
  if (!set && !dea_h5_has_attribute(h, group, name)) {
    return NULL;
  }
  hid_t object = set ? H5Dopen2(group, name, H5P_DEFAULT) : H5Aopen(group, name, H5P_DEFAULT);
  char *text = checked(h, object, h->not_it) >= 0 ? read_text(h, object, !set) : NULL;
  dea_h5_close(object);
  return text;
}

size_t dea_h5_link_count(struct h5 *h, hid_t group)
{
  H5G_info_t info;
  if (h->status != DEA_OK) {
    return 0;
  }
  if (H5Gget_info(group, &info) < 0) {
    dea_h5_fail(h, h->not_it);
    return 0;
  }
  return (size_t)info.nlinks;
}

void dea_h5_link_name(struct h5 *h, hid_t group, size_t index, char *out, size_t size)
{
  out[0] = '\0';
  if (h->status == DEA_OK && H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, index, out,
                                                size, H5P_DEFAULT) < 0) {
    dea_h5_fail(h, h->not_it);
  }
}

// Both ways ---------------------------------------------------------------------------------------

hid_t dea_h5_group(struct h5 *h, hid_t parent, const char *name)
{
  return h->reading ? dea_h5_group_open(h, parent, name) : dea_h5_group_get(h, parent, name);
}

long long dea_h5_int(struct h5 *h, hid_t object, const char *name, long long value, long long low,
                     long long high)
{
  if (!h->reading) {
    dea_h5_write_int(h, object, name, value);
    return value;
  }
  value = dea_h5_get_int(h, object, name);
  if (h->status == DEA_OK && (value < low || value > high)) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: '%s' is %lld", h->path, name, value);
  }
  return h->status == DEA_OK ? value : low;
}

double dea_h5_real(struct h5 *h, hid_t object, const char *name, double value)
{
  if (h->reading) {
    return dea_h5_get_real(h, object, name);
  }
  dea_h5_write_real(h, object, name, value);
  return value;
}

void dea_h5_text(struct h5 *h, hid_t object, const char *name, char *text, size_t size)
{
  if (h->reading) {
    dea_h5_get_text(h, object, name, text, size);
  } else {
    dea_h5_write_text(h, object, name, text);
  }
}

char *dea_h5_long_text(struct h5 *h, hid_t group, const char *name, char *text)
{
  if (h->reading) {
    return dea_h5_get_long_text(h, group, name);
  }
  dea_h5_write_long_text(h, group, name, text);
  return text;
}

void dea_h5_array(struct h5 *h, hid_t group, const char *name, hid_t memory_type, hid_t file_type,
                  size_t count, void *values, const char *unit, const char *meaning)
{
  if (h->reading) {
    dea_h5_get_array(h, group, name, memory_type, count, values);
  } else {
    dea_h5_write_array(h, group, name, memory_type, file_type, count, values, unit, meaning);
  }
}

void dea_h5_texts(struct h5 *h, hid_t group, const char *name, size_t count, size_t size,
                  char *texts, const char *meaning)
{
  hid_t type = text_type(size, H5T_CSET_ASCII);
  dea_h5_array(h, group, name, type, type, count, texts, "1", meaning);
  dea_h5_close(type);
  for (size_t i = 0; i < count && h->status == DEA_OK && h->reading; i++) {
    texts[(i + 1) * size - 1] = '\0';
  }
}
