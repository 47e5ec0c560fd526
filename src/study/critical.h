/* Voltages at which a film comes to an end, found to solver accuracy, and their slopes by numbers
 * of the device (docs/theory/critical.md). */
#pragma once

#include "model/model.h"

enum { DEA_CRITICAL_WHY_SIZE = 200 };

/* What there is of them. */
struct dea_critical_kind {
  enum dea_event_kind kind;
  const char *key; // "slack_voltage_V"
  const char *title, *meaning;
};
enum { DEA_CRITICAL_KINDS = 4 };
extern const struct dea_critical_kind dea_critical_kinds[DEA_CRITICAL_KINDS];

/* Of which device, how it is computed, and what is looked for. All lent. */
struct dea_critical_request {
  const struct dea_model_type *type;
  const struct dea_device *device;
  const struct dea_model_settings *settings;
  enum dea_event_kind kind; // DEA_EVENT_SLACK, _BREAKDOWN, _PULL_IN or _BUCKLING
  double first_V;           // of the search, above 0
  double highest_V;         // it ends there; INFINITY: where the film does
};

struct dea_critical {
  struct dea_critical_request ask;
  double voltage_V;            // NAN: there is none; `why` says why
  struct dea_load_point point; // there; without one, the last that was found
  char why[DEA_CRITICAL_WHY_SIZE];
  struct dea_model *model; // owned: stands there; of pull-in has just failed beyond it
};

/* Looks for the lowest such voltage on the branch that begins at rest. A device without one is no
 * failure. out: ended by dea_critical_end, also on failure; what `ask` lends has to stay until
 * then. */
dea_status dea_critical_find(struct dea_context *ctx, const struct dea_critical_request *ask,
                             struct dea_critical *out);
void dea_critical_end(struct dea_context *ctx, struct dea_critical *critical);

/* Slopes [change_count] of a voltage that was found, by changes; voltages of the changes are not
 * looked at. NAN where there is none. */
dea_status dea_critical_slopes(struct dea_context *ctx, const struct dea_critical *critical,
                               const struct dea_design_change *changes, size_t change_count,
                               double *slopes);
