#include "io/sparse_grid.h"

#include "device/identity.h"
#include "result/provenance.h"

#include <math.h>
#include <string.h>

enum { NODES_MAX = (1 << DEA_EMULATOR_LEVEL_MAX) + 1, DEGREE = 4 };

// Sparse grid -------------------------------------------------------------------------------------

double dea_sparse_grid_share(int level, unsigned char node)
{
  return 0.5 * (1 - cos(DEA_PI * node / (double)(1 << level)));
}

/* The first level with a node: the middle, then the ends, then what halves the steps. */
static int level_of(int level, unsigned node)
{
  int first = level;
  if (2 * node == 1u << level) {
    return 0;
  }
  for (; first > 1 && node % 2 == 0; node /= 2) {
    first--;
  }
  return first;
}

size_t dea_sparse_grid(size_t keys, int level, unsigned char *nodes)
{
  unsigned char at[DEA_EMULATOR_KEYS_MAX] = {0};
  size_t count = 0, j = 0;
  while (j < keys) {
    int sum = 0;
    for (size_t k = 0; k < keys; k++) {
      sum += level_of(level, at[k]);
    }
    if (sum <= level) {
      if (nodes != NULL) {
        memcpy(nodes + count * keys, at, keys);
      }
      count++;
    }
    for (j = 0; j < keys && ++at[j] > 1 << level; j++) { // the next of the full grid
      at[j] = 0;
    }
  }
  return count;
}

/* Floater and Hormann's barycentric basis of n points of degree d; of degree n - 1 Lagrange's. */
static void basis(size_t n, const double *x, size_t d, double at, double *out)
{
  double sum = 0;
  d = d < n - 1 ? d : n - 1;
  for (size_t k = 0; k < n; k++) {
    double weight = 0;
    for (size_t i = k > d ? k - d : 0; i <= k && i + d < n; i++) {
      double product = i % 2 == 0 ? 1 : -1;
      for (size_t j = i; j <= i + d; j++) {
        product /= j == k ? 1 : x[k] - x[j];
      }
      weight += product;
    }
    if (at == x[k]) {
      memset(out, 0, n * sizeof *out);
      out[k] = 1;
      return;
    }
    out[k] = weight / (at - x[k]);
    sum += out[k];
  }
  for (size_t k = 0; k < n; k++) {
    out[k] /= sum;
  }
}

/* Lagrange's bases of all levels of a key, by node of the finest. */
static void bases(int finest, double share, double out[][NODES_MAX])
{
  for (int l = 0; l <= finest; l++) {
    const size_t step = (size_t)1 << (finest - l), n = l == 0 ? 1 : ((size_t)1 << l) + 1;
    double x[NODES_MAX], at[NODES_MAX];
    for (size_t k = 0; k < n; k++) {
      x[k] = l == 0 ? 0.5 : dea_sparse_grid_share(finest, (unsigned char)(k * step));
    }
    basis(n, x, NODES_MAX, share, at);
    for (size_t k = 0; k < n; k++) {
      out[l][l == 0 ? step / 2 : k * step] = at[k];
    }
  }
}

static double binomial(int n, int k)
{
  double product = 1;
  for (int i = 1; i <= k; i++) {
    product = product * (n - k + i) / i;
  }
  return product;
}

/* Smolyak's combination: the weight of a case is the sum of (-1)^(level - |l|) (d - 1 over level -
 * |l|) times its bases over the grids l with level - d < |l| <= level that have it. */
static double weight_of(const struct dea_emulator *e, const unsigned char *node, int level,
                        double by_key[][DEA_EMULATOR_LEVEL_MAX + 1][NODES_MAX])
{
  const int d = (int)e->key_count;
  int least[DEA_EMULATOR_KEYS_MAX], l[DEA_EMULATOR_KEYS_MAX], sum = 0;
  double weight = 0;
  for (int j = 0; j < d; j++) {
    sum += l[j] = least[j] = level_of(e->level, node[j]);
  }
  for (int j = 0; j < d && sum <= level;) {
    if (sum > level - d) {
      double product = ((level - sum) % 2 == 0 ? 1 : -1) * binomial(d - 1, level - sum);
      for (int k = 0; k < d; k++) {
        product *= by_key[k][l[k]][node[k]];
      }
      weight += product;
    }
    for (j = 0; j < d; j++) { // the next grid
      l[j]++;
      if (++sum <= level) {
        break;
      }
      sum -= l[j] - least[j];
      l[j] = least[j];
    }
  }
  return weight;
}

static void case_weights(const struct dea_emulator *e, const double *share, int level, double *out)
{
  double by_key[DEA_EMULATOR_KEYS_MAX][DEA_EMULATOR_LEVEL_MAX + 1][NODES_MAX];
  for (size_t j = 0; j < e->key_count; j++) {
    bases(e->level, share[j], by_key[j]);
  }
  for (size_t c = 0; c < e->case_count; c++) {
    out[c] = e->key_count == 0 ? 1 : weight_of(e, e->nodes + c * e->key_count, level, by_key);
  }
}

// Values ------------------------------------------------------------------------------------------

static double value_of(const struct dea_emulator *e, size_t c, size_t k, size_t q)
{
  return e->values[(c * e->voltage_count + k) * e->quantity_count + q];
}

/* Of a quantity by weights of cases, at a voltage within its range; stride 2: from every second
 * voltage and the last. x, b: scratch [voltages]. */
static double interpolate(const struct dea_emulator *e, const double *w, size_t q, size_t stride,
                          double voltage_V, double *x, double *b)
{
  const size_t first = e->first[q], last = e->end[q] - 1, n = (last - first + stride - 1) / stride;
  double sum = 0;
  for (size_t i = 0; i <= n; i++) {
    x[i] = e->voltages_V[i < n ? first + i * stride : last];
  }
  basis(n + 1, x, DEGREE, voltage_V, b);
  for (size_t i = 0; i <= n; i++) {
    for (size_t c = 0; b[i] != 0 && c < e->case_count; c++) {
      sum += b[i] * w[c] * value_of(e, c, i < n ? first + i * stride : last, q);
    }
  }
  return sum;
}

static bool all_have(const struct dea_emulator *e, size_t k, size_t q)
{
  for (size_t c = 0; c < e->case_count; c++) {
    if (!isfinite(value_of(e, c, k, q))) {
      return false;
    }
  }
  return true;
}

static void find_range(struct dea_emulator *e, size_t q)
{
  size_t k = 0;
  while (k < e->voltage_count && !all_have(e, k, q)) {
    k++;
  }
  e->first[q] = k;
  while (k < e->voltage_count && all_have(e, k, q)) {
    k++;
  }
  e->end[q] = k < e->first[q] + 2 ? e->first[q] : k;
}

/* scratch: [cases + 2 voltages] */
static void find_errors(struct dea_emulator *e, double *scratch)
{
  double *w = scratch, *x = w + e->case_count, *b = x + e->voltage_count;
  for (size_t c = 0; c < e->case_count; c++) {
    double share[DEA_EMULATOR_KEYS_MAX];
    for (size_t j = 0; j < e->key_count; j++) {
      share[j] = dea_sparse_grid_share(e->level, e->nodes[c * e->key_count + j]);
    }
    case_weights(e, share, e->level - 1, w);
    for (size_t q = 0; q < e->quantity_count; q++) {
      for (size_t k = e->first[q]; k < e->end[q]; k++) {
        const double coarse = interpolate(e, w, q, 2, e->voltages_V[k], x, b);
        e->error[(c * e->voltage_count + k) * e->quantity_count + q] =
            fabs(coarse - value_of(e, c, k, q));
      }
    }
  }
}

dea_status dea_emulator_build(struct dea_context *ctx, struct dea_emulator *io)
{
  const size_t room = io->case_count + 2 * io->voltage_count;
  io->first = dea_alloc(ctx, io->quantity_count + 1, sizeof *io->first);
  io->end = dea_alloc(ctx, io->quantity_count + 1, sizeof *io->end);
  io->error = dea_alloc(ctx, io->case_count * io->voltage_count * io->quantity_count + 1,
                        sizeof *io->error);
  double *scratch = dea_alloc(ctx, room, sizeof *scratch);
  if (io->first == NULL || io->end == NULL || io->error == NULL || scratch == NULL) {
    dea_free(ctx, scratch);
    dea_emulator_free(ctx, io);
    return DEA_E_MEMORY;
  }
  for (size_t q = 0; q < io->quantity_count; q++) {
    find_range(io, q);
  }
  find_errors(io, scratch);
  dea_free(ctx, scratch);
  return DEA_OK;
}

void dea_emulator_free(struct dea_context *ctx, struct dea_emulator *emulator)
{
  dea_free(ctx, emulator->first);
  dea_free(ctx, emulator->end);
  dea_free(ctx, emulator->error);
  emulator->first = emulator->end = NULL;
  emulator->error = NULL;
}

/* Of the designs that are at most twice as far as the nearest. away: [cases] */
static unsigned flags_at(const struct dea_emulator *e, const double *share, size_t low, size_t high,
                         double *away)
{
  double least = INFINITY;
  unsigned flags = 0;
  for (size_t c = 0; c < e->case_count; c++) {
    double sum = 0;
    for (size_t j = 0; j < e->key_count; j++) {
      const double off = share[j] - dea_sparse_grid_share(e->level, e->nodes[c * e->key_count + j]);
      sum += off * off;
    }
    away[c] = sqrt(sum);
    least = fmin(least, away[c]);
  }
  for (size_t c = 0; c < e->case_count; c++) {
    const unsigned *of = e->flags + c * e->voltage_count;
    flags |= away[c] <= 2 * least + 1e-12 ? of[low] | of[high] : 0;
  }
  return flags;
}

static double error_at(const struct dea_emulator *e, const double *w, size_t k, size_t q)
{
  double sum = 0;
  for (size_t c = 0; c < e->case_count; c++) {
    sum += fabs(w[c]) * e->error[(c * e->voltage_count + k) * e->quantity_count + q];
  }
  return sum;
}

static void values_at(const struct dea_emulator *e, const double *w, bool within, double voltage_V,
                      double *scratch, double *values, double *errors, size_t beside[2])
{
  size_t high = 0;
  while (high + 1 < e->voltage_count && e->voltages_V[high] < voltage_V) {
    high++;
  }
  beside[0] = e->voltages_V[high] > voltage_V && high > 0 ? high - 1 : high;
  beside[1] = high;
  for (size_t q = 0; q < e->quantity_count; q++) {
    const bool there = within && e->end[q] > e->first[q] &&
                       voltage_V >= e->voltages_V[e->first[q]] &&
                       voltage_V <= e->voltages_V[e->end[q] - 1];
    values[q] =
        there ? interpolate(e, w, q, 1, voltage_V, scratch, scratch + e->voltage_count) : NAN;
    errors[q] = there ? fmax(error_at(e, w, beside[0], q), error_at(e, w, high, q)) : NAN;
  }
}

dea_status dea_emulator_at(struct dea_context *ctx, const struct dea_emulator *e,
                           const double *share, const double *voltages_V, size_t count,
                           double *values, double *errors, unsigned *flags)
{
  double *w = dea_alloc(ctx, 2 * (e->case_count + e->voltage_count), sizeof *w);
  DEA_TRY_MEMORY(w != NULL);
  double *away = w + e->case_count, *scratch = away + e->case_count;
  bool within = true;
  for (size_t j = 0; j < e->key_count; j++) {
    within = within && share[j] >= 0 && share[j] <= 1;
  }
  case_weights(e, share, e->level, w);
  for (size_t k = 0; k < count; k++) {
    const size_t first = k * e->quantity_count;
    size_t beside[2];
    values_at(e, w, within, voltages_V[k], scratch, values + first, errors + first, beside);
    flags[k] = flags_at(e, share, beside[0], beside[1], away);
  }
  dea_free(ctx, w);
  return DEA_OK;
}

dea_status dea_emulator_device(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device, char out[65])
{
  struct dea_text text = {.ctx = ctx};
  dea_device_identity(design, device, "compute", &text);
  dea_sha256_hex(dea_text_get(&text), text.length, out);
  return dea_text_free(&text);
}

// JSON --------------------------------------------------------------------------------------------

static json_t *numbers(const double *values, size_t count)
{
  json_t *array = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(array, dea_json_number(values[i]));
  }
  return array;
}

json_t *dea_emulator_json(const struct dea_emulator *e)
{
  const size_t points = e->case_count * e->voltage_count;
  json_t *keys = json_array(), *nodes = json_array(), *quantities = json_array(),
         *flags = json_array(), *words = json_array();
  for (size_t j = 0; j < e->key_count; j++) {
    const struct dea_emulator_key *key = &e->keys[j];
    json_array_append_new(keys, json_pack("{s:s, s:s, s:f, s:f, s:o}", "name", key->name, "unit",
                                          key->unit, "low", key->low, "high", key->high, "value",
                                          dea_json_number(key->value)));
  }
  for (size_t i = 0; i < e->case_count * e->key_count; i++) {
    json_array_append_new(nodes, json_integer(e->nodes[i]));
  }
  for (size_t q = 0; q < e->quantity_count; q++) {
    const struct dea_column *of = e->quantities[q];
    json_array_append_new(quantities,
                          json_pack("{s:s, s:s, s:s, s:f, s:i, s:i}", "key", of->key, "title",
                                    of->header, "unit", of->display_unit, "factor", of->factor,
                                    "first", (int)e->first[q], "end", (int)e->end[q]));
  }
  for (size_t i = 0; i < points; i++) {
    json_array_append_new(flags, json_integer(e->flags[i]));
  }
  for (unsigned f = 0; f < DEA_FLAG_COUNT; f++) {
    json_array_append_new(words, json_pack("{s:s, s:b}", "word", dea_flag_words[f].word, "doubt",
                                           dea_flag_words[f].kind == DEA_FLAG_DOUBT));
  }
  return json_pack(
      "{s:i, s:s, s:s, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "dea_emulator", 1, "model",
      e->model, "device", e->device != NULL ? e->device : "", "level", e->level, "keys", keys,
      "nodes", nodes, "voltages_V", numbers(e->voltages_V, e->voltage_count), "quantities",
      quantities, "values", numbers(e->values, points * e->quantity_count), "error",
      numbers(e->error, points * e->quantity_count), "flags", flags, "flag_words", words);
}
