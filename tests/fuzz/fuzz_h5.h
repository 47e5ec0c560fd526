/* Targets that read a file from a folder of their own, and HDF5 files that are well formed and say
 * something else than they should: a good file in which
 * objects and attributes are edited as the input says, three bytes an edit: of what, how, with
 * what. (Files with flipped bytes are HDF5's to refuse; what they then say is ours.) */
#pragma once

#include "fuzz.h"

#include "base/context.h"

#include <hdf5.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char fuzz_folder[] = "/tmp/dea-fuzz-XXXXXX", fuzz_path[64];

static inline void fuzz_folder_remove(void)
{
  remove(fuzz_path);
  rmdir(fuzz_folder);
}

/* One context for all inputs, as reading the unit table takes longer than reading a file, and
 * fuzz_path, that file. begin: called once with it, false on failure; NULL: nothing. _GNU_SOURCE
 * before all headers. */
static inline struct dea_context *fuzz_context(const char *name,
                                               bool (*begin)(struct dea_context *ctx))
{
  static struct dea_context *ctx;
  if (ctx == NULL) {
    if (mkdtemp(fuzz_folder) == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
      abort();
    }
    snprintf(fuzz_path, sizeof fuzz_path, "%s/%s", fuzz_folder, name);
    atexit(fuzz_folder_remove);
    if (begin != NULL && !begin(ctx)) {
      abort();
    }
  }
  return ctx;
}

enum { FUZZ_H5_OBJECTS = 256, FUZZ_H5_VALUES = 40, FUZZ_H5_EDITS = 8 };

struct fuzz_h5_objects {
  char path[FUZZ_H5_OBJECTS][96];
  size_t count;
};

static inline herr_t fuzz_h5_note(hid_t group, const char *name, const H5L_info_t *info, void *user)
{
  struct fuzz_h5_objects *all = user;
  (void)group;
  (void)info;
  if (all->count < FUZZ_H5_OBJECTS) {
    snprintf(all->path[all->count++], sizeof all->path[0], "%s", name);
  }
  return 0;
}

/* What stands in the place of a value. */
static inline double fuzz_h5_number(uint8_t with)
{
  static const double odd[] = {0, -1, 1e300, 9e18, 0.5, 4294967297.0, -1e-300, 3, NAN};
  return odd[with % 9];
}

/* A dataset or an attribute of some type, shape and values in the place of `name`. */
static inline void fuzz_h5_put(hid_t at, const char *name, bool attribute, uint8_t with)
{
  static const hsize_t counts[] = {0, 1, 2, 3, 7, FUZZ_H5_VALUES};
  const hsize_t dims[2] = {counts[with % 6], with % 5};
  double numbers[4 * FUZZ_H5_VALUES];
  static const char text[320] = "\377 not a text of ours, and longer than any of them should be";
  hid_t type = with % 4 == 0 ? H5Tcopy(H5T_C_S1) : H5Tcopy(H5T_NATIVE_DOUBLE);
  if (with % 4 == 0) {
    H5Tset_size(type, with % 8 == 0 ? 300 : 1);
  }
  hid_t space = with % 3 == 0   ? H5Screate(H5S_SCALAR)
                : with % 3 == 1 ? H5Screate_simple(1, dims, NULL)
                                : H5Screate_simple(2, dims, NULL);
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
    numbers[i] = fuzz_h5_number((uint8_t)(with / 3 + i));
  }
  bool fits = H5Sget_simple_extent_npoints(space) * (hssize_t)H5Tget_size(type) <=
              (hssize_t)(with % 4 == 0 ? sizeof text : sizeof numbers);
  const void *values = with % 4 == 0 ? (const void *)text : numbers;
  hid_t made = attribute ? H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT)
                         : H5Dcreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (made >= 0 && fits && attribute) {
    H5Awrite(made, type, values);
  } else if (made >= 0 && fits) {
    H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  }
  if (made >= 0) {
    attribute ? H5Aclose(made) : H5Dclose(made);
  }
  H5Sclose(space);
  H5Tclose(type);
}

/* An attribute of the object: gone, or another one of its name. */
static inline void fuzz_h5_edit_attribute(hid_t object, uint8_t how, uint8_t with)
{
  H5O_info_t info;
  char name[96];
  if (H5Oget_info(object, &info) < 0 || info.num_attrs == 0) {
    return;
  }
  hsize_t n = how / 8 % info.num_attrs;
  if (H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, n, name, sizeof name,
                         H5P_DEFAULT) < 0 ||
      H5Adelete(object, name) < 0) {
    return;
  }
  if (how % 8 < 6) {
    fuzz_h5_put(object, name, true, with);
  }
}

static inline void fuzz_h5_edit(hid_t file, const char *path, uint8_t how, uint8_t with)
{
  if (how % 8 >= 3) {
    hid_t object = H5Oopen(file, path, H5P_DEFAULT);
    if (object >= 0) {
      fuzz_h5_edit_attribute(object, how, with);
      H5Oclose(object);
    }
  } else if (H5Ldelete(file, path, H5P_DEFAULT) >= 0 && how % 8 > 0) {
    if (how % 8 == 1) {
      fuzz_h5_put(file, path, false, with);
    } else {
      H5Gclose(H5Gcreate2(file, path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
  }
}

/* Edits the file at that path as the input says. */
static inline void fuzz_h5_edit_file(const char *path, const uint8_t *data, size_t size)
{
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  for (size_t i = 0; file >= 0 && i + 3 <= size && i < 3 * FUZZ_H5_EDITS; i += 3) {
    static struct fuzz_h5_objects all;
    all.count = 0;
    snprintf(all.path[all.count++], sizeof all.path[0], ".");
    H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, fuzz_h5_note, &all);
    fuzz_h5_edit(file, all.path[data[i] % all.count], data[i + 1], data[i + 2]);
  }
  if (file >= 0) {
    H5Fclose(file);
  }
}
