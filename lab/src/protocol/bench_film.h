/* The film on the bench as its design and a model tell of it: what the checks of a protocol and the
 * simulated bench ask. Who has designs and models fills in the functions (film/film_of_design.h);
 * the bench knows neither. */
#pragma once

#include "base/context.h"
#include "result/load_point.h"
#include "result/profile.h"

/* The film of a design; who reads it has a struct of its own that begins with this. */
struct dea_bench_film {
  const struct dea_bench_film_type *type;
};

/* A model of the film, which begins with this too. Texts are lent. */
struct dea_bench_model {
  const struct dea_bench_film_type *type;
  const char *name;          // "lumped"
  const char *material;      // of the film
  double frame_radius_m;     // inner radius of the frame; radii are in the stretched flat film
  double fibre_tip_radius_m; // of the fibre tips; of the electrode where there are no fibres
};

/* The film at one voltage. */
struct dea_bench_point {
  struct dea_load_point point;
  // true field that the material stands as it is stretched, by the smallest value of its sources;
  // NAN: unknown
  double breakdown_V_per_m;
  // breakdown probability by the largest and by the smallest value of its sources; NAN: unknown
  double breakdown_probability_band[2];
  double leakage_s; // resistivity times permittivity; INFINITY: nothing leaks
};

/* How the simulated amplifier drives the film. */
struct dea_bench_circuit {
  double series_resistance_ohm;
  double current_limit_A; // INFINITY: none
};

/* Models fail with DEA_E_NO_EQUILIBRIUM where the film has none, and DEA_E_NOT_CONVERGED. */
struct dea_bench_film_type {
  /* Reads a design from its text; file: its name, for messages. What is wrong is a finding, and
   * DEA_E_DESIGN. out: owned by the caller, NULL on failure. */
  dea_status (*read)(struct dea_context *ctx, const char *file, const char *text, size_t length,
                     struct dea_bench_film **out);
  void (*destroy)(struct dea_context *ctx, struct dea_bench_film *film);
  /* Name of model number `index`, static storage; NULL after the last. *moves: it knows time. */
  const char *(*model)(size_t index, bool *moves);

  /* A model of the film. name: NULL for the one of the checks, which is quick and knows neither
   * fibres nor weight; else one that moves, or DEA_E_UNSUPPORTED. A film that is no disc, or whose
   * `monitor` is asked for (NULL: the first one's z), moves by that, by model reduced alone. film:
   * lent, outlives the model. out: owned by the caller, NULL on failure. */
  dea_status (*open)(struct dea_context *ctx, const struct dea_bench_film *film, const char *name,
                     const char *monitor, struct dea_bench_model **out);
  void (*close)(struct dea_context *ctx, struct dea_bench_model *model);
  /* For checks. Lowest voltage [V] at which the film pulls in; NAN: at none. */
  dea_status (*pull_in)(struct dea_context *ctx, struct dea_bench_model *model, double *voltage_V);
  /* For checks. The film at rest at a voltage, brought there from 0 V. */
  dea_status (*solve)(struct dea_context *ctx, struct dea_bench_model *model, double voltage_V,
                      struct dea_bench_point *out);

  /* Time 0, at rest at 0 V. */
  dea_status (*begin)(struct dea_context *ctx, struct dea_bench_model *model,
                      const struct dea_bench_circuit *circuit, struct dea_bench_point *out);
  /* A trial step from the last accepted state, in which the amplifier goes straight to source_V; of
   * length 0: it jumps. *error: of the step, over the largest motion so far. */
  dea_status (*advance)(struct dea_context *ctx, struct dea_bench_model *model, double length_s,
                        double source_V, struct dea_bench_point *out, double *error);
  /* The last trial, which succeeded, becomes the state. */
  void (*accept)(struct dea_bench_model *model);
  /* Heights along a radius in that state, lent until the next call; count 0: it knows none. */
  dea_status (*profile)(struct dea_context *ctx, struct dea_bench_model *model,
                        struct dea_profile *out);
};
