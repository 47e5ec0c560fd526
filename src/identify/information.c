#include "identify/information.h"

#include <math.h>
#include <string.h>

static const double open_share = 1e-9; // added to J'J: what nothing is known of stays finite

void dea_information_add(struct dea_information *to, const double *J, size_t rows, double weight)
{
  const size_t k = to->count;
  for (size_t a = 0; a < k; a++) {
    for (size_t b = 0; b < k; b++) {
      double sum = 0;
      for (size_t i = 0; i < rows; i++) {
        sum += J[to->active[a] * rows + i] * J[to->active[b] * rows + i];
      }
      to->A[a * k + b] += weight * sum / (to->length[a] * to->length[b]);
    }
  }
}

void dea_information_start(const struct dea_lsq_fit *fit, double variance, const double *scale,
                           struct dea_information *out)
{
  *out = (struct dea_information){.count = 0};
  for (size_t j = 0; j < fit->params; j++) {
    if (!fit->held[j] && !fit->at_bound[j]) {
      double sum = 0;
      for (size_t i = 0; i < fit->rows; i++) {
        sum += fit->J[j * fit->rows + i] * fit->J[j * fit->rows + i];
      }
      out->length[out->count] = sum > 0 ? sqrt(sum) : 1 / scale[j];
      out->active[out->count++] = j;
    }
  }
  dea_information_add(out, fit->J, fit->rows, 1 / variance);
  for (size_t a = 0; a < out->count; a++) {
    out->A[a * out->count + a] += open_share / variance;
  }
}

/* By Cholesky. */
double dea_information_factor(const struct dea_information *of, double *variance)
{
  const size_t k = of->count;
  double A[DEA_LSQ_PARAMS_MAX * DEA_LSQ_PARAMS_MAX], sum = 0;
  memcpy(A, of->A, k * k * sizeof *A);
  for (size_t j = 0; j < k; j++) {
    for (size_t i = j; i < k; i++) {
      double s = A[i * k + j];
      for (size_t l = 0; l < j; l++) {
        s -= A[i * k + l] * A[j * k + l];
      }
      A[i * k + j] = i == j ? sqrt(fmax(s, 1e-300)) : s / A[j * k + j];
    }
    sum += 2 * log(A[j * k + j]);
  }
  for (size_t c = 0; c < k; c++) { // column c of the inverse of the factor
    double y[DEA_LSQ_PARAMS_MAX] = {0};
    variance[c] = 0;
    for (size_t i = c; i < k; i++) {
      double s = i == c ? 1 : 0;
      for (size_t l = c; l < i; l++) {
        s -= A[i * k + l] * y[l];
      }
      y[i] = s / A[i * k + i];
    }
    for (size_t i = k; i-- > 0;) { // and of the whole: L' x = y
      double s = y[i];
      for (size_t l = i + 1; l < k; l++) {
        s -= A[l * k + i] * y[l];
      }
      y[i] = s / A[i * k + i];
    }
    variance[c] = y[c];
  }
  return sum;
}
