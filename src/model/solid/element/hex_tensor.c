#include "model/solid/element/hex_tensor.h"

#include <string.h>

/* The code for a processor with wider registers beside the one for all, chosen when it starts. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__)
#define DEA_CLONES __attribute__((target_clones("fma", "default")))
#else
#define DEA_CLONES
#endif

enum {
  LINE = DEA_HEX_LINE_MAX,
  SUMS_MAX = DEA_HEX_GAUSS_MAX * DEA_HEX_COLUMNS_MAX,
};

/* One row of dea_hex_combine: four terms at once; those beyond the last are zero times one. */
static inline void combine_row(size_t terms, const double *table, size_t width,
                               const double *restrict in, double *restrict out)
{
  for (size_t k = 0; k < terms; k += 4) {
    double f[4];
    const double *at[4];
    for (size_t i = 0; i < 4; i++) {
      bool used = k + i < terms;
      f[i] = used ? table[k + i] : 0;
      at[i] = in + (used ? k + i : k) * width;
    }
    if (k == 0) {
      for (size_t x = 0; x < width; x++) {
        out[x] = f[0] * at[0][x] + f[1] * at[1][x] + f[2] * at[2][x] + f[3] * at[3][x];
      }
    } else {
      for (size_t x = 0; x < width; x++) {
        out[x] += f[0] * at[0][x] + f[1] * at[1][x] + f[2] * at[2][x] + f[3] * at[3][x];
      }
    }
  }
}

/* One of three terms, as those of elements of order 2 are. */
static inline void combine_three(const double f[3], size_t width, const double *restrict in,
                                 double *restrict out)
{
  for (size_t x = 0; x < width; x++) {
    // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): three rows are set
    out[x] = f[0] * in[x] + f[1] * in[width + x] + f[2] * in[2 * width + x];
  }
}

/* Where the time goes. (Static: clang 14 gives clones with external linkage a name of its own.) */
DEA_CLONES
static void combine(size_t rows, size_t terms, const double *table, size_t table_width,
                    size_t width, const double *restrict in, double *restrict out)
{
  for (size_t r = 0; r < rows; r++) {
    if (terms == 3) {
      combine_three(table + r * table_width, width, in, out + r * width);
    } else {
      combine_row(terms, table + r * table_width, width, in, out + r * width);
    }
  }
}

void dea_hex_combine(size_t rows, size_t terms, const double *table, size_t table_width,
                     size_t width, const double *restrict in, double *restrict out)
{
  combine(rows, terms, table, table_width, width, in, out);
}

/* The same along a middle axis: out[o][r][x] = sum_k table[r][k] in[o][k][x]. */
static void along(size_t outer, size_t count, const double (*table)[LINE], size_t width,
                  const double *in, double *out)
{
  for (size_t o = 0; o < outer; o++) {
    dea_hex_combine(count, count, table[0], LINE, width, in + o * count * width,
                    out + o * count * width);
  }
}

void dea_hex_slopes(const struct dea_hex_shape *s, int columns, const double *values,
                    double *slopes)
{
  size_t n = (size_t)s->order + 1, nz = (size_t)s->order_z + 1, c = (size_t)columns;
  size_t all = (size_t)s->gauss * c;
  const struct dea_hex_line *line = &s->line[0], *line_z = &s->line[1];
  double z[2][SUMS_MAX], yz[3][SUMS_MAX]; // value, slope by z; value, slope by y, slope by z
  along(1, nz, line_z->at_gauss[0], n * n * c, values, z[0]);
  along(1, nz, line_z->at_gauss[1], n * n * c, values, z[1]);
  along(nz, n, line->at_gauss[0], n * c, z[0], yz[0]);
  along(nz, n, line->at_gauss[1], n * c, z[0], yz[1]);
  along(nz, n, line->at_gauss[0], n * c, z[1], yz[2]);
  for (size_t a = 0; a < 3; a++) {
    along(nz * n, n, line->at_gauss[a == 0], c, yz[a], slopes + a * all);
  }
}

void dea_hex_sum_flux(const struct dea_hex_shape *s, int columns, const double *flux, double *sums)
{
  size_t n = (size_t)s->order + 1, nz = (size_t)s->order_z + 1, c = (size_t)columns;
  size_t all = (size_t)s->gauss * c;
  const struct dea_hex_line *line = &s->line[0], *line_z = &s->line[1];
  double x[SUMS_MAX], xy[3][SUMS_MAX], part[SUMS_MAX];
  for (size_t a = 0; a < 3; a++) {
    along(nz * n, n, line->at_node[a == 0], c, flux + a * all, x);
    along(nz, n, line->at_node[a == 1], n * c, x, xy[a]);
  }
  for (size_t i = 0; i < all; i++) {
    // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): along has set both
    xy[0][i] += xy[1][i];
  }
  along(1, nz, line_z->at_node[0], n * n * c, xy[0], sums);
  along(1, nz, line_z->at_node[1], n * n * c, xy[2], part);
  for (size_t i = 0; i < all; i++) {
    sums[i] += part[i];
  }
}

/* ---- tangent ---- */

enum { LINE_PAIRS = LINE * LINE, AXES_PAIRS = 9 };

/* Sums over the Gauss points for the nodes n and m: by z at one point of x, [pair of
 * axes][q2][n3, m3][pair]; by y and z, [kind of x][q1][n2, m2][n3, m3][pair]; by all axes,
 * [n1, m1][n2, m2][n3, m3][pair]. */
struct tangent_sums {
  double z[AXES_PAIRS * LINE * LINE_PAIRS * DEA_HEX_PAIRS];
  double yz[DEA_HEX_KINDS * LINE * LINE_PAIRS * LINE_PAIRS * DEA_HEX_PAIRS];
  double all[LINE_PAIRS * LINE_PAIRS * LINE_PAIRS * DEA_HEX_PAIRS];
};

/* The pairs of axes (a of node n, b of node m) in the order that makes both sums that follow run
 * through memory: by kind of x (whether a, b are x), then by kind of y. */
static const int axis_n[AXES_PAIRS] = {2, 1, 2, 2, 1, 1, 0, 0, 0};
static const int axis_m[AXES_PAIRS] = {0, 0, 1, 2, 2, 1, 1, 2, 0};
static const struct {
  size_t first, count, kind_y; // of the pairs above; the first of their kinds of y
} group[DEA_HEX_KINDS] = {{0, 2, DEA_HEX_KIND_00},
                          {2, 4, DEA_HEX_KIND_01},
                          {6, 2, DEA_HEX_KIND_01},
                          {8, 1, DEA_HEX_KIND_00}};

static size_t kind_of(bool slope_n, bool slope_m)
{
  return slope_n ? (slope_m ? DEA_HEX_KIND_11 : DEA_HEX_KIND_10)
                 : (slope_m ? DEA_HEX_KIND_01 : DEA_HEX_KIND_00);
}

/* z of the pair of axes p at (q1, q2): [n3, m3][pair]. */
static void sum_z(const struct dea_hex_shape *s, int p, int q, double (*A)[9][DEA_HEX_PAIRS],
                  double *z)
{
  int a = axis_n[p], b = axis_m[p], nz = s->order_z + 1;
  int step = (s->order + 1) * (s->order + 1);
  size_t kind = kind_of(a == 2, b == 2) * (size_t)nz;
  for (int r = 0; r < nz * nz; r++, z += DEA_HEX_PAIRS) {
    double sum[DEA_HEX_PAIRS] = {0};
    for (int q3 = 0; q3 < nz; q3++) {
      double f = s->line[1].pairs[r][kind + (size_t)q3];
      const double *at = A[q + step * q3][3 * a + b];
      for (int i = 0; i < DEA_HEX_PAIRS; i++) {
        sum[i] += f * at[i];
      }
    }
    memcpy(z, sum, sizeof sum);
  }
}

/* From the sums to the blocks (n, m) and (m, n) of K, n >= m. */
static void add_blocks(const struct dea_hex_shape *s, const double *all, int n, double *K)
{
  int line = s->order + 1, line_z = s->order_z + 1, dofs = 3 * s->nodes, m = 0;
  int n1 = n % line, n2 = n / line % line, n3 = n / (line * line);
  int size_z = line_z * line_z * DEA_HEX_PAIRS, size_yz = line * line * size_z;
  for (int m3 = 0; m3 < line_z; m3++) {
    for (int m2 = 0; m2 < line; m2++) {
      const double *nm = all + n1 * line * size_yz + (n2 * line + m2) * size_z +
                         (n3 * line_z + m3) * DEA_HEX_PAIRS;
      const double *mn =
          all + n1 * size_yz + (m2 * line + n2) * size_z + (m3 * line_z + n3) * DEA_HEX_PAIRS;
      for (int m1 = 0; m1 < line && m <= n; m1++, m++, nm += size_yz, mn += line * size_yz) {
        const double block[3][3] = {
            {nm[0], nm[1], nm[2]}, {mn[1], nm[3], nm[4]}, {mn[2], mn[4], nm[5]}};
        double *row = K + 3 * n * dofs + 3 * m, *column = K + 3 * m * dofs + 3 * n;
        for (int i = 0; i < 3; i++) {
          for (int k = 0; k < 3; k++) {
            row[i * dofs + k] += block[i][k];
            column[k * dofs + i] += n != m ? block[i][k] : 0;
          }
        }
      }
    }
  }
}

void dea_hex_add_tangent(const struct dea_hex_shape *s, double (*A)[9][DEA_HEX_PAIRS], double *K)
{
  size_t n = (size_t)s->order + 1, nz = (size_t)s->order_z + 1;
  size_t width_z = nz * nz * DEA_HEX_PAIRS, width = n * n * width_z;
  enum { STRIDE = DEA_HEX_KINDS * LINE };
  struct tangent_sums sums;
  for (size_t q1 = 0; q1 < n; q1++) {
    for (size_t p = 0; p < AXES_PAIRS; p++) {
      for (size_t q2 = 0; q2 < n; q2++) {
        sum_z(s, (int)p, (int)(q1 + n * q2), A, sums.z + (p * n + q2) * width_z);
      }
    }
    for (size_t kind = 0; kind < DEA_HEX_KINDS; kind++) {
      dea_hex_combine(n * n, group[kind].count * n, s->line[0].pairs[0] + group[kind].kind_y * n,
                      STRIDE, width_z, sums.z + group[kind].first * n * width_z,
                      sums.yz + (kind * n + q1) * width);
    }
  }
  dea_hex_combine(n * n, DEA_HEX_KINDS * n, s->line[0].pairs[0], STRIDE, width, sums.yz, sums.all);
  for (int node = 0; node < s->nodes; node++) {
    add_blocks(s, sums.all, node, K);
  }
}
