/* The factor by fronts: solutions of systems of many patterns put back into them, and matrices that
 * have none. */
// ctest: solid
#include "model/solid/assembly/fronts.h"
#include "testing.h"

#include "solid_fixture.h"

#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

/* Nodes of a box, neighbours where they are one step apart along any axes; and some far links. */
struct net {
  int size[3], links;
  double shift; // what is added to the diagonal
};

static int node_count(const struct net *net)
{
  return net->size[0] * net->size[1] * net->size[2];
}

static double random_number(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (double)(*seed >> 8) / (double)(1 << 24) - 0.5;
}

/* Adds B^T B between two nodes, B random [3][6] with rows whose sum is 0: no eigenvalue below 0,
 * and no stiffness against a shift of all components alike. */
static void add_link(Mat K, int i, int j, unsigned *seed)
{
  const PetscInt at[2] = {i < j ? i : j, i < j ? j : i};
  double B[3][6], block[36] = {0};
  for (int k = 0; k < 3; k++) {
    double sum = 0;
    for (int a = 0; a < 5; a++) {
      sum += B[k][a] = random_number(seed);
    }
    B[k][5] = -sum; // nothing of a shift of all six by as much
  }
  for (int k = 0; k < 3 * 36; k++) {
    block[k % 36] += B[k / 36][k % 36 / 6] * B[k / 36][k % 6];
  }
  assert_int_equal(MatSetValuesBlocked(K, 2, at, 2, at, block, ADD_VALUES), 0);
}

static bool are_near(const struct net *net, int i, int j)
{
  const int *n = net->size;
  return abs(i % n[0] - j % n[0]) < 2 && abs(i / n[0] % n[1] - j / n[0] % n[1]) < 2 &&
         abs(i / n[0] / n[1] - j / n[0] / n[1]) < 2;
}

static Mat make(const struct net *net, unsigned seed)
{
  Mat K;
  int nodes = node_count(net);
  assert_int_equal(MatCreateSeqSBAIJ(PETSC_COMM_SELF, 3, 3 * nodes, 3 * nodes, nodes, NULL, &K), 0);
  MatSetOption(K, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE);
  for (int i = 0; i < nodes; i++) {
    for (int j = i + 1; j < nodes; j++) {
      if (are_near(net, i, j)) {
        add_link(K, i, j, &seed);
      }
    }
    const double own[9] = {net->shift, 0, 0, 0, net->shift, 0, 0, 0, net->shift};
    assert_int_equal(MatSetValuesBlocked(K, 1, &i, 1, &i, own, ADD_VALUES), 0);
  }
  for (int k = 0; k < net->links; k++) {
    int i = (int)((0.5 + random_number(&seed)) * nodes);
    int j = (int)((0.5 + random_number(&seed)) * nodes);
    if (i != j) {
      add_link(K, i, j, &seed);
    }
  }
  assert_int_equal(MatAssemblyBegin(K, MAT_FINAL_ASSEMBLY), 0);
  assert_int_equal(MatAssemblyEnd(K, MAT_FINAL_ASSEMBLY), 0);
  return K;
}

/* Largest entry of K x - b, which is of the size of 1, with b random and x the solution. */
static double residual(struct dea_fronts *fronts, Mat K)
{
  Vec b, x, r;
  PetscReal size;
  PetscScalar *values;
  PetscInt count;
  unsigned seed = 5;
  assert_int_equal(MatCreateVecs(K, &x, &b), 0);
  assert_int_equal(VecDuplicate(b, &r), 0);
  VecGetSize(b, &count);
  VecGetArray(b, &values);
  for (PetscInt i = 0; i < count; i++) {
    values[i] = random_number(&seed);
  }
  VecRestoreArray(b, &values);
  assert_int_equal(dea_fronts_solve(ctx, fronts, b, x), DEA_OK);
  MatMult(K, x, r);
  VecAXPY(r, -1, b);
  VecNorm(r, NORM_INFINITY, &size);
  VecDestroy(&b);
  VecDestroy(&x);
  VecDestroy(&r);
  return size;
}

/* Boxes from one node to a plate, parts that hang together by nothing, and links across. */
TEST(test_solves)
{
  static const struct net nets[] = {
      {{1, 1, 1}, 0, 1},   {{2, 1, 1}, 0, 1},      {{40, 1, 1}, 0, 0.1}, {{9, 8, 1}, 0, 0.1},
      {{7, 6, 3}, 0, 0.1}, {{12, 12, 2}, 60, 0.1}, {{1, 1, 200}, 3, 1}};
  for (size_t n = 0; n < sizeof nets / sizeof nets[0]; n++) {
    int negative;
    struct dea_fronts *fronts;
    Mat K = make(&nets[n], 1);
    assert_int_equal(dea_fronts_create(ctx, K, &fronts), DEA_OK);
    assert_true(dea_fronts_fit(fronts, K));
    for (int k = 0; k < 2; k++) { // a second time with other numbers
      assert_int_equal(dea_fronts_factor(ctx, fronts, K, 0, &negative), DEA_OK);
      assert_int_equal(negative, 0);
      assert_true(residual(fronts, K) < 1e-11);
      MatScale(K, 3);
    }
    dea_fronts_destroy(ctx, fronts);
    MatDestroy(&K);
  }
}

/* A negative eigenvalue, and one of 0 but for rounding, wherever its pivot comes; the next factor
 * knows nothing of it. */
TEST(test_refuses)
{
  static const struct net free_net = {{6, 5, 2}, 0, 0};
  int negative;
  struct dea_fronts *fronts;
  Mat K = make(&free_net, 2);
  assert_int_equal(dea_fronts_create(ctx, K, &fronts), DEA_OK);
  assert_int_equal(dea_fronts_factor(ctx, fronts, K, 0, &negative), DEA_OK);
  assert_true(negative != 0); // shifted all alike it has no stiffness
  for (PetscInt node = 0; node < 60; node += 7) {
    static const double hold[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const double push[9] = {0, 0, 0, 0, -1000, 0, 0, 0, 0};
    static const double end[9] = {-1, 0, 0, 0, 999, 0, 0, 0, -1};
    const double *const steps[] = {hold, push, end};
    for (int k = 0; k < 3; k++) {
      MatSetValuesBlocked(K, 1, &node, 1, &node, steps[k], ADD_VALUES);
      MatAssemblyBegin(K, MAT_FINAL_ASSEMBLY);
      MatAssemblyEnd(K, MAT_FINAL_ASSEMBLY);
      assert_int_equal(dea_fronts_factor(ctx, fronts, K, 0, &negative), DEA_OK);
      assert_true((negative == 0) == (k == 0));
      assert_true(k > 0 || residual(fronts, K) < 1e-9);
    }
  }
  dea_fronts_destroy(ctx, fronts);
  MatDestroy(&K);
}

/* Eigenvalues of K below 0. */
static int count_negative(Mat K)
{
  Vec x, y;
  PetscInt n;
  const PetscScalar *column;
  int count = 0;
  assert_int_equal(MatCreateVecs(K, &x, &y), 0);
  VecGetSize(x, &n);
  double *A = malloc((size_t)(n * n) * sizeof *A), *values = malloc((size_t)n * sizeof *values);
  for (PetscInt i = 0; i < n; i++) {
    VecZeroEntries(x);
    VecSetValue(x, i, 1, INSERT_VALUES);
    MatMult(K, x, y);
    VecGetArrayRead(y, &column);
    memcpy(A + i * n, column, (size_t)n * sizeof *A);
    VecRestoreArrayRead(y, &column);
  }
  assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', n, A, n, values), 0);
  for (PetscInt i = 0; i < n; i++) {
    count += values[i] < 0 ? 1 : 0;
  }
  free(A);
  free(values);
  VecDestroy(&x);
  VecDestroy(&y);
  return count;
}

/* As many pivots below 0 as eigenvalues (Sylvester); no more than are asked for; and nothing of it
 * is left in the next factor. */
TEST(test_counts)
{
  static const struct net box = {{7, 6, 3}, 20, 0.1};
  int negative, count = 0;
  struct dea_fronts *fronts;
  Mat K = make(&box, 4);
  assert_int_equal(dea_fronts_create(ctx, K, &fronts), DEA_OK);
  for (int k = 0; k < 4; k++) {
    assert_int_equal(dea_fronts_factor(ctx, fronts, K, 1000, &negative), DEA_OK);
    count = count_negative(K);
    assert_int_equal(negative, count);
    assert_true(residual(fronts, K) < 1e-8); // of pivots that were not looked for
    MatShift(K, -0.3);
  }
  print_message("%d of 378 below 0\n", count);
  assert_int_equal(dea_fronts_factor(ctx, fronts, K, 4, &negative), DEA_OK);
  assert_true(negative > 4 && negative < count);
  MatShift(K, 4 * 0.3);
  assert_int_equal(dea_fronts_factor(ctx, fronts, K, 4, &negative), DEA_OK);
  assert_int_equal(negative, 0);
  assert_true(residual(fronts, K) < 1e-9);
  dea_fronts_destroy(ctx, fronts);
  MatDestroy(&K);
}

TESTS(solid_set_up, solid_tear_down)
