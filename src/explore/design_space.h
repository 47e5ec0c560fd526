/* What a file of dea sweep or dea optimise asks, resolved: the device as an evaluator, its
 * variables and what is kept of each design. */
#pragma once

#include "base/arena.h"
#include "explore/evaluator.h"
#include "explore/explore_file.h"
#include "job/device_evaluation.h"
#include "study/critical.h"

/* What is kept of a design. */
struct dea_explored {
  struct dea_column shown; // its key is the text below
  char key[80];            // as the file has it: "centre_z_m", "plate_turn_y_rad"
  int column;              // of the context; -1: a voltage of an event
  enum dea_explored_source {
    DEA_EXPLORED_POINT,     // a column of load points
    DEA_EXPLORED_MONITOR,   // what a monitor or channel of a device made of plies shows: `of`
    DEA_EXPLORED_FREQUENCY, // of the lowest mode, which solving leaves out
    DEA_EXPLORED_CRITICAL,  // the voltage of `event`, at which the film comes to an end
  } source;
  enum dea_event_kind event;
  struct dea_monitor_column of;
};

/* A variable: values, or a range, or a distribution. */
struct dea_variable {
  const struct dea_explore_variable *text; // lent
  struct dea_device_param param;           // SI; low and high are those of the file and of the key
  double values[DEA_EXPLORE_VALUES_MAX];   // SI
  size_t value_count;
  double low, high;                                  // of the file; NAN: not given
  struct dea_device_param ties[DEA_DEVICE_TIES_MAX]; // that take the same value, of param
  double scatter; // SI; half a width or a standard deviation; 0: none
};

struct dea_limit {
  int column;          // of the quantity, 0 to quantity_count - 1
  double above, below; // SI; NAN: none
};

struct dea_design_space {
  struct dea_context *ctx;
  struct dea_explore_file *file;
  struct dea_design *design;
  struct dea_device *device;
  char *path, *bytes; // of the design file
  size_t length;
  struct dea_variable variables[DEA_CASE_PARAMS_MAX];
  size_t variable_count;
  double voltages_V[DEA_EXPLORE_VOLTAGES_MAX];
  size_t voltage_count;
  struct dea_explored quantities[DEA_EXPLORE_QUANTITIES_MAX];
  size_t quantity_count;
  struct dea_limit limits[DEA_EXPLORE_LIMITS_MAX];
  size_t limit_count;
  int objectives[DEA_EXPLORE_OBJECTIVES_MAX]; // columns, as of a limit
  /* Value of quantity i at voltage k: k * quantity_count + i; mark k: flags of that voltage, of the
   * free film and where one is held down of that too. */
  struct dea_evaluator evaluator;
  char hash[65];        // of all that a case's numbers mean
  char hash_slopes[65]; // the same with gradients
  /* of the evaluator */
  struct dea_device_param params[DEA_CASE_PARAMS_MAX];
  struct dea_device_model model;
  struct dea_load_point *points;
  double seen[DEA_EXPLORE_VOLTAGES_MAX][DEA_EXPLORE_QUANTITIES_MAX]; // of monitors
  /* Critical voltages of the device that stands at the last voltage, each by its quantity. */
  struct dea_critical critical[DEA_EXPLORE_QUANTITIES_MAX];
  char why[DEA_CRITICAL_WHY_SIZE]; // of the last one that there is not
  struct dea_arena memory;
  char id[DEA_CASE_ID_SIZE];
  struct dea_case *now; // that is evaluated; set only with add_slopes
  /* Adds slopes to it at each stop (`stood` of struct dea_device_model); NULL: none are wanted. */
  dea_status (*add_slopes)(const struct dea_design_space *space, struct dea_model *model,
                           const struct dea_device *device, size_t stop);
};

/* Reads a file and resolves it. All that is wrong becomes findings, at its place, before anything
 * is computed; DEA_E_DESIGN then. out: owned by the caller, NULL on failure. */
dea_status dea_design_space_read(struct dea_context *ctx, const char *file,
                                 struct dea_design_space **out);
void dea_design_space_destroy(struct dea_design_space *space);
/* Number of a quantity of the space by its key, or -1. */
int dea_design_space_quantity(const struct dea_design_space *space, const char *key);
/* Whether a quantity is taken with the tip of compute.force held at its first depth. */
bool dea_design_space_is_held(const struct dea_design_space *space, size_t quantity);
/* A limit's margin at a case's last voltage, over its scale: below 0 it is crossed; NAN: no value.
 */
double dea_limit_margin(const struct dea_design_space *space, const struct dea_limit *limit,
                        const double *q);
/* Says that a name of the file is none of `what` [count], with the nearest of them. */
dea_status dea_explore_unknown(struct dea_context *ctx, const struct dea_label *label,
                               const char *what, const char *const names[], size_t count);
/* Adds the parameters of the fit that the file names, if any (key `from_fit`), to its variables,
 * with the fit's values, standard uncertainties and correlations. What is wrong becomes findings at
 * from_fit. */
dea_status dea_from_fit_read(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct dea_explore_file *io);
/* The evaluator of a space with gradients: at the last voltage, of quantities that an objective or
 * a limit is of, by variables that are searched; NAN for all others, and where the model has none
 * at a design. The evaluator without gradients where the model has none of its own, or the file's
 * method wants none. user: lent by the space. */
struct dea_evaluator dea_design_space_with_slopes(const struct dea_design_space *space);
