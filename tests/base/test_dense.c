/* Small dense systems. */
#include "base/dense.h"
#include "testing.h"

enum { N_MAX = 40 };

/* Numbers in (-1, 1), the same in every run. */
static double next(uint32_t *state)
{
  *state = 1664525u * *state + 1013904223u;
  return (double)(*state >> 8) / (1 << 23) - 1;
}

TEST(test_solve)
{
  uint32_t seed = 7;
  for (size_t n = 1; n <= N_MAX; n += 3) {
    double A[N_MAX * N_MAX], b[N_MAX] = {0}, x[N_MAX];
    for (size_t i = 0; i < n * n; i++) {
      A[i] = next(&seed);
    }
    for (size_t j = 0; j < n; j++) {
      x[j] = next(&seed);
      for (size_t i = 0; i < n; i++) {
        b[i] += A[j * n + i] * x[j];
      }
    }
    assert_int_equal(dea_dense_solve(n, A, b), DEA_OK);
    for (size_t i = 0; i < n; i++) {
      assert_close(b[i], x[i], 0, 1e-10);
    }
  }
}

/* C D C^T with a known D has as many negative eigenvalues as D (Sylvester). zeros: on the diagonal,
 * so that pivots of one row do not do. */
TEST(test_negative)
{
  uint32_t seed = 3;
  for (size_t n = 1; n <= N_MAX; n++) {
    double C[N_MAX][N_MAX], A[N_MAX * N_MAX] = {0};
    int wanted = 0, found;
    for (size_t i = 0; i < n; i++) {
      for (size_t j = 0; j < n; j++) {
        C[i][j] = next(&seed) + (i == j ? 2.0 : 0.0);
      }
    }
    for (size_t k = 0; k < n; k++) {
      double d = next(&seed);
      wanted += d < 0;
      for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
          A[j * n + i] += C[i][k] * d * C[j][k];
        }
      }
    }
    assert_int_equal(dea_dense_negative(n, A, &found), DEA_OK);
    assert_int_equal(found, wanted);
  }
}

TEST(test_pivots_of_two_rows)
{
  double saddle[16] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 3, 0, 0, 3, 0}; // 1, -1, 3, -3
  double lower[4] = {1, 2, 99, 1};                                      // 3, -1: 99 is not read
  double zero[4] = {0};
  int negative = -1;
  assert_int_equal(dea_dense_negative(4, saddle, &negative), DEA_OK);
  assert_int_equal(negative, 2);
  assert_int_equal(dea_dense_negative(2, lower, &negative), DEA_OK);
  assert_int_equal(negative, 1);
  assert_int_equal(dea_dense_negative(2, zero, &negative), DEA_OK);
  assert_int_equal(negative, 0);
}

TESTS(NULL, NULL)
