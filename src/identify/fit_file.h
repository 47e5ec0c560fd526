/* A fit file: which law, which parameters are free, which tests. */
#pragma once

#include "identify/coupon.h"
#include "identify/fit_head.h"

enum {
  DEA_FIT_TESTS_MAX = 32,
  DEA_FIT_LAWS_MAX = 8,
};

enum dea_fit_kind { // the first three: slow, or in time where times or a rate are given
  DEA_FIT_UNIAXIAL,
  DEA_FIT_PLANAR,
  DEA_FIT_EQUIBIAXIAL,
  DEA_FIT_RELAXATION,
  DEA_FIT_CYCLIC,
  DEA_FIT_CREEP, // compared by the stress that its measured stretches take
  DEA_FIT_KINDS
};
extern const char *const dea_fit_kind_names[DEA_FIT_KINDS + 1]; // ended by NULL

enum dea_fit_use { DEA_FIT_USED, DEA_FIT_CHECKED, DEA_FIT_PREDICTED };
extern const char *const dea_fit_use_names[]; // ended by NULL

/* Columns of a test's file. */
enum dea_fit_column {
  DEA_FIT_TIME,
  DEA_FIT_STRETCH,
  DEA_FIT_DISPLACEMENT,
  DEA_FIT_STRESS,
  DEA_FIT_FORCE,
  DEA_FIT_STRESS_STD,
  DEA_FIT_FORCE_STD,
  DEA_FIT_COLUMNS
};
/* A test as written. */
struct dea_fit_test {
  struct dea_label name, file;
  struct dea_choice kind, mode, use; // enum dea_fit_kind, dea_coupon_mode, dea_fit_use
  struct dea_label columns[DEA_FIT_COLUMNS];
  struct dea_quantity length_m, section_m2, relative, absolute_Pa, rate_per_s, ramp_s, stretch;
  struct dea_quantity temperature_K; // absent: the file's
};

struct dea_fit_file {
  struct dea_fit_head head;
  struct dea_label material, branches;
  struct dea_quantity temperature_K; // of the tests; absent: unknown
  struct dea_quantity reference_K; // from which branches shift to each test's; absent: they do not
  struct dea_label laws[DEA_FIT_LAWS_MAX];
  size_t law_count;
  struct dea_quantity branch_s[DEA_BRANCHES_MAX];
  size_t branch_time_count;
  struct dea_fit_parameter_text parameters[DEA_LAW_PARAM_MAX];
  size_t parameter_count;
  struct dea_fit_test tests[DEA_FIT_TESTS_MAX];
  size_t test_count;
};

extern const struct dea_fit_form dea_fit_form;

/* Temperature of a test; NAN: unknown. */
double dea_fit_temperature_K(const struct dea_fit_file *file, const struct dea_fit_test *test);

/* Measurements as a fit takes them: stretch, nominal stress, uncertainty, in time where they are.
 */
struct dea_fit_series {
  const struct dea_fit_test *test; // lent
  const char *file;
  char sha256[65];
  size_t rows;
  size_t *line;             // [rows]
  double *stretch;          // [rows]
  double *time_s;           // [rows], NULL: slow
  double *stress_Pa;        // [rows], NAN of a prediction
  double *std_Pa;           // [rows] standard uncertainty, NAN where none is given
  struct dea_coupon coupon; // the way through the rows
  size_t slack, repeated;   // rows that were left out
};

/* Series of all tests that the file names, [test_count], in CSV files from its folder; memory of
 * the arena. What is wrong becomes a finding with file and line, DEA_E_IO then; what is only odd
 * (slack rows, repeated rows, a stretch that is never reached) a warning. */
dea_status dea_fit_series_read(struct dea_arena *arena, const struct dea_fit_file *file,
                               struct dea_fit_series **out);
