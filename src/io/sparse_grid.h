/* Quantities of a device between what was computed: over numbers of the design from a sparse grid,
 * and over the voltage, each with an error of its own (docs/theory/reduced-model.md). The page's
 * explorer (web/explorer.js) evaluates the same. */
#pragma once

#include "base/json.h"
#include "device/device.h"
#include "result/columns.h"

enum { DEA_EMULATOR_KEYS_MAX = 4, DEA_EMULATOR_LEVEL_MAX = 4 };

/* Nodes of the sparse grid of a level (1 to DEA_EMULATOR_LEVEL_MAX) for so many keys, at least 1:
 * node k of a key is at the share (1 - cos(pi k / 2^level)) / 2 of its range. nodes: [count][keys],
 * NULL: only counted. */
size_t dea_sparse_grid(size_t keys, int level, unsigned char *nodes);
double dea_sparse_grid_share(int level, unsigned char node);

/* A number of the design with its range and its value in the design, NAN: none [SI]. */
struct dea_emulator_key {
  const char *name, *unit;
  double low, high, value;
};

/* All but the last three is given and lent. Without keys there is one case. */
struct dea_emulator {
  const char *model, *device; // hash of the design; "": not said
  const struct dea_emulator_key *keys;
  size_t key_count, case_count, voltage_count, quantity_count;
  int level;
  const unsigned char *nodes;                 // [cases][keys], in any order
  const double *voltages_V;                   // rising
  const struct dea_column *const *quantities; // [quantities]
  const double *values;                       // [cases][voltages][quantities]; NAN: none
  const unsigned *flags;                      // [cases][voltages]
  size_t *first, *end;                        // [quantities]: voltages at which all cases have it
  double *error;                              // as values
};

/* Finds the last three: the error of a case is its difference to what the grid of the level below
 * and every second voltage say. Of a quantity with fewer than two voltages first = end. */
dea_status dea_emulator_build(struct dea_context *ctx, struct dea_emulator *io);
void dea_emulator_free(struct dea_context *ctx, struct dea_emulator *emulator);
/* At shares of the keys' ranges and voltages [count]: values and errors [count][quantities], sums
 * of those of cases by their weights, at the worse of the voltages beside; NAN where there are
 * none; flags [count]: of the designs no more than twice as far as the nearest, at the voltages
 * beside. */
dea_status dea_emulator_at(struct dea_context *ctx, const struct dea_emulator *emulator,
                           const double *share, const double *voltages_V, size_t count,
                           double *values, double *errors, unsigned *flags);
/* Hash of a design without its computations: which emulator is of which run. */
dea_status dea_emulator_device(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device, char out[65]);
json_t *dea_emulator_json(const struct dea_emulator *emulator);
