#include "material/branch.h"

#include <math.h>

struct dea_branch_weights dea_branch_weights(double length_s, double relaxation_time_s)
{
  double x = length_s / relaxation_time_s;
  struct dea_branch_weights w = {.e = exp(-x)};
  if (x < 1e-2) { // the formulas below subtract what is nearly equal
    w.w1 = x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24 - x * (1.0 / 120 - x / 720))));
    w.w0 = -expm1(-x) - w.w1;
  } else {
    double mean = -expm1(-x) / x;
    w.w0 = mean - w.e;
    w.w1 = 1 - mean;
  }
  return w;
}

double dea_branch_shift(double c1, double c2_K, double off_K)
{
  return pow(10, -c1 * off_K / (c2_K + off_K));
}

struct dea_equal_tensor dea_equal_inverse(double stretch)
{
  double square = stretch * stretch;
  return (struct dea_equal_tensor){1 / square, square * square};
}

struct dea_equal_tensor dea_equal_known(const struct dea_material *material,
                                        const struct dea_equal_tensor *A, double length_s,
                                        double stretch)
{
  struct dea_equal_tensor B = {0, 0}, inverse = dea_equal_inverse(stretch);
  for (size_t i = 0; i < material->branch_count; i++) {
    double G = material->branches[i].modulus_Pa;
    struct dea_branch_weights w = dea_branch_weights(length_s, material->branches[i].time_s);
    B.p += G * (w.e * A[i].p + w.w0 * inverse.p);
    B.z += G * (w.e * A[i].z + w.w0 * inverse.z);
  }
  return B;
}

void dea_equal_stress(const struct dea_equal_tensor *B, double stretch, double *W, double *s,
                      double *k)
{
  // W = B_p l^2 + B_z l^-4/2
  double square = stretch * stretch, i2 = 1 / square, i4 = i2 * i2;
  *W = B->p * square + 0.5 * B->z * i4;
  *s = B->p * stretch - B->z * i4 / stretch;
  *k = B->p + 5 * B->z * i4 * i2;
}

/* A after the step, of one branch; C^-1 goes from `from` to `to`. */
static struct dea_equal_tensor update(struct dea_equal_tensor A, double time_s, double length_s,
                                      struct dea_equal_tensor from, struct dea_equal_tensor to)
{
  struct dea_branch_weights w = dea_branch_weights(length_s, time_s);
  return (struct dea_equal_tensor){w.e * A.p + w.w0 * from.p + w.w1 * to.p,
                                   w.e * A.z + w.w0 * from.z + w.w1 * to.z};
}

void dea_equal_update(const struct dea_material *material, const struct dea_equal_tensor *A,
                      double length_s, double stretch, double stretch_new,
                      struct dea_equal_tensor *A_new)
{
  struct dea_equal_tensor from = dea_equal_inverse(stretch), to = dea_equal_inverse(stretch_new);
  for (size_t i = 0; i < material->branch_count; i++) {
    A_new[i] = update(A[i], material->branches[i].time_s, length_s, from, to);
  }
}

double dea_equal_energy(const struct dea_material *material, const struct dea_equal_tensor *A,
                        double stretch)
{
  struct dea_equal_tensor inverse = dea_equal_inverse(stretch);
  double W = 0;
  for (size_t i = 0; i < material->branch_count; i++) {
    double p = A[i].p / inverse.p - 1, z = A[i].z / inverse.z - 1; // X = A C, less 1
    W += 0.5 * material->branches[i].modulus_Pa * (2 * (p - log1p(p)) + z - log1p(z));
  }
  return W;
}

double dea_equal_loss(const struct dea_material *material, const struct dea_equal_tensor *A,
                      double length_s, double stretch, double stretch_new)
{
  static const double at[3] = {0.11270166537925831, 0.5, 0.88729833462074169};
  static const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  struct dea_equal_tensor from = dea_equal_inverse(stretch), to = dea_equal_inverse(stretch_new);
  double loss = 0;
  for (size_t i = 0; i < material->branch_count && length_s > 0; i++) {
    const struct dea_branch *branch = &material->branches[i];
    for (int g = 0; g < 3; g++) {
      struct dea_equal_tensor inverse = {from.p + at[g] * (to.p - from.p),
                                         from.z + at[g] * (to.z - from.z)};
      struct dea_equal_tensor a = update(A[i], branch->time_s, at[g] * length_s, from, inverse);
      double p = a.p / inverse.p - 1, z = a.z / inverse.z - 1;
      // D = G/(2 tau) tr(X + X^-1 - 2): each eigenvalue gives (x - 1)^2/x
      loss += weight[g] * length_s * 0.5 * branch->modulus_Pa / branch->time_s *
              (2 * p * p / (1 + p) + z * z / (1 + z));
    }
  }
  return loss;
}
