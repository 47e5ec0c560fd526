/* What every model answers at one load point: one list for C, CSV, JSON, HDF5 and figures.
 *
 * Values are SI. NAN means that the model has no such quantity; writers then leave the key out.
 * The keys are published and stay as they are. z is positive towards the fibre side. */
#pragma once

#include <stdbool.h>

// X(member = JSON key, SI unit, display unit, factor SI -> display, CSV header, meaning)
#define DEA_LOAD_POINT_LIST(X)                                                                     \
  X(voltage_V, "V", "kV", 1e-3, "V", "voltage between the electrodes")                             \
  X(time_s, "s", "s", 1.0, "time", "time since the start of the waveform")                         \
  X(source_voltage_V, "V", "kV", 1e-3, "source V", "voltage asked of the supply")                  \
  X(electrode_stretch, "1", "1", 1.0, "electrode stretch",                                         \
    "electrode edge radius over its pre-stretched value (lambda_a)")                               \
  X(passive_stretch, "1", "1", 1.0, "passive stretch",                                             \
    "stretch of the passive film relative to the pre-stretched state (lambda_p, mean)")            \
  X(centre_z_m, "m", "um", 1e6, "z centre", "displacement of the centre, positive to the fibres")  \
  X(fibre_tip_z_m, "m", "um", 1e6, "z fibre tip", "displacement of the fibre tip")                 \
  X(highest_z_m, "m", "um", 1e6, "highest z", "largest displacement out of the plane of the film") \
  X(lowest_z_m, "m", "um", 1e6, "lowest z", "smallest displacement out of the plane of the film")  \
  X(electrode_edge_u_m, "m", "um", 1e6, "u electrode edge",                                        \
    "radial displacement of the electrode edge between fibres")                                    \
  X(tip_depth_m, "m", "um", 1e6, "tip depth",                                                      \
    "how far a tip is pressed beyond touching the flat film; negative: a gap")                     \
  X(force_N, "N", "mN", 1e3, "force",                                                              \
    "out-of-plane force: on the tip, or the largest along the load line")                          \
  X(nominal_field_V_per_m, "V/m", "V/um", 1e-6, "nominal field",                                   \
    "V over the unstretched thickness")                                                            \
  X(true_field_V_per_m, "V/m", "V/um", 1e-6, "true field", "largest V over the current thickness") \
  X(breakdown_margin, "1", "%", 100.0, "breakdown margin",                                         \
    "1 - true field / breakdown field: 1 without field, 0 at breakdown")                           \
  X(breakdown_probability, "1", "%", 100.0, "breakdown probability",                               \
    "at most; only where the distribution of the breakdown field is known")                        \
  X(min_tension_N_per_m, "N/m", "N/m", 1.0, "smallest tension",                                    \
    "smallest principal tension (true stress x current thickness); below 0 the film is slack")     \
  X(centre_z_error_m, "m", "um", 1e6, "error of z centre",                                         \
    "estimated error of the mesh in the displacement of the centre")                               \
  X(fibre_tip_z_error_m, "m", "um", 1e6, "error of z fibre tip",                                   \
    "estimated error of the mesh in the displacement of the fibre tip")                            \
  X(electrode_edge_u_error_m, "m", "um", 1e6, "error of u electrode edge",                         \
    "estimated error of the mesh in the displacement of the electrode edge")                       \
  X(compression_ratio, "1", "1", 1.0, "compression ratio",                                         \
    "compression in the slack part of the film, with the plies bonded to it, over what a clamped " \
    "plate of its area bears: from 1 on it wrinkles")                                              \
  X(locking_share, "1", "%", 100.0, "share of locking",                                            \
    "stretch measure of the film's law over its value at lock-up, largest of the film")            \
  X(range_share, "1", "%", 100.0, "share of measured range",                                       \
    "largest stretch of the film over the largest that the law was measured at")                   \
  X(pull_in_distance_V, "V", "kV", 1e-3, "distance to pull-in",                                    \
    "voltage of the next limit point of this branch minus voltage")                                \
  X(energy_J, "J", "uJ", 1e6, "energy", "potential energy at this voltage, 0 at rest")             \
  X(capacitance_F, "F", "pF", 1e12, "capacitance", "charge over voltage")                          \
  X(charge_C, "C", "nC", 1e9, "charge", "charge on an electrode")                                  \
  X(current_A, "A", "uA", 1e6, "current", "current of the supply")                                 \
  X(stored_energy_J, "J", "uJ", 1e6, "stored energy",                                              \
    "energy in the film, its field and its viscous branches, 0 at rest")                           \
  X(kinetic_energy_J, "J", "uJ", 1e6, "kinetic energy", "kinetic energy")                          \
  X(dissipated_J, "J", "uJ", 1e6, "dissipated",                                                    \
    "energy lost in viscous branches, resistance and leakage since the start")                     \
  X(damped_J, "J", "uJ", 1e6, "damped by steps",                                                   \
    "energy of motion that was not resolved: damped by the steps with inertia, lost in snaps "     \
    "without")                                                                                     \
  X(supply_work_J, "J", "uJ", 1e6, "supply work", "work of the supply since the start")            \
  X(lowest_voltage_V, "V", "kV", 1e-3, "lowest V",                                                 \
    "voltage between electrodes of a sheet resistance where it is lowest")                         \
  X(mode, "1", "1", 1.0, "mode", "number of the mode, from the lowest on")                         \
  X(frequency_Hz, "Hz", "Hz", 1.0, "frequency",                                                    \
    "of the mode, in vacuo (negative: unstable, growing at this rate over 2 pi), or of the "       \
    "ripple")                                                                                      \
  X(mode_out_of_plane, "1", "%", 100.0, "out of plane",                                            \
    "share of the mode's kinetic energy that is out of the plane")                                 \
  X(mode_centre, "1", "%", 100.0, "centre",                                                        \
    "displacement of the centre out of the plane over the mode's largest one")                     \
  X(ripple_V, "V", "V", 1.0, "ripple", "amplitude of the excitation upon the voltage")             \
  X(centre_amplitude_m, "m", "nm", 1e9, "amplitude centre",                                        \
    "of the centre's z, by the excitation")                                                        \
  X(centre_phase_rad, "rad", "deg", 57.29577951308232, "phase centre",                             \
    "of the centre's z against the excitation")                                                    \
  X(fibre_tip_amplitude_m, "m", "nm", 1e9, "amplitude fibre tip", "of the fibre tip's z")          \
  X(fibre_tip_phase_rad, "rad", "deg", 57.29577951308232, "phase fibre tip",                       \
    "of the fibre tip's z against the excitation")                                                 \
  X(electrode_edge_amplitude_m, "m", "nm", 1e9, "amplitude electrode edge",                        \
    "of the electrode edge's u, by the excitation")                                                \
  X(electrode_edge_phase_rad, "rad", "deg", 57.29577951308232, "phase electrode edge",             \
    "of the electrode edge's u against the excitation")

/* What a reader of a point has to know of its numbers (docs/theory/trust.md). A doubt: they are not
 * to be trusted. A danger: they are, but the device would not live. A limit: of what the model
 * answers; some of its numbers are no prediction for this device.
 * X(NAME, word in files, kind, sentence) */
#define DEA_FLAG_LIST(X)                                                                           \
  X(SLACK, "slack", DOUBT,                                                                         \
    "so much of the film has lost its tension that it wrinkles: its shape depends on the mesh "    \
    "and is one of several")                                                                       \
  X(UNSTABLE, "unstable", DOUBT, "the state is unstable: a device does not stay in it")            \
  X(STATES, "states", DOUBT,                                                                       \
    "one of several stable states: the sweep has gone over from a state that ended or was left")   \
  X(LOCKING, "locking", DOUBT,                                                                     \
    "the film's law is near its locking stretch or beyond it (from 80 % on)")                      \
  X(RANGE, "range", DOUBT, "the film is stretched beyond the measured range of its law")           \
  X(PREVIEW, "preview", DOUBT,                                                                     \
    "the film is a membrane: without bending, and without the shape of its wrinkles")              \
  X(BREAKDOWN, "breakdown", DANGER, "the true field is beyond the film's breakdown field")         \
  X(BOUND, "bound", LIMIT, "z and force are upper bounds of rigid rods, not predictions")          \
  X(PLAIN, "plain", LIMIT,                                                                         \
    "strain, field and tension are those of the film without its fibres, which hold it back")

enum dea_flag_kind { DEA_FLAG_DOUBT, DEA_FLAG_DANGER, DEA_FLAG_LIMIT };
#define DEA_FLAG_NUMBER(name, word, kind, sentence) DEA_FLAG_##name,
enum dea_flag { DEA_FLAG_LIST(DEA_FLAG_NUMBER) DEA_FLAG_COUNT };
#undef DEA_FLAG_NUMBER

struct dea_monitor_values; // result/columns.h

struct dea_load_point {
#define DEA_LOAD_POINT_MEMBER(member, si, display, factor, header, meaning) double member;
  DEA_LOAD_POINT_LIST(DEA_LOAD_POINT_MEMBER)
#undef DEA_LOAD_POINT_MEMBER
  bool stable;        // under voltage control, within the motions the model knows
  int unstable_modes; // number of negative modes of the tangent
  unsigned own_flags; // flags that the numbers do not say, 1u << enum dea_flag: STATES, ...
  /* What monitors and channels show (result/columns.h); of a curve's points its own, NULL: none. */
  struct dea_monitor_values *monitors;
};

/* Point with every number NAN, stable, no unstable mode. */
struct dea_load_point dea_load_point_empty(void);

/* All flags of a point, 1u << enum dea_flag: those told and those that its numbers say. This is the
 * one place that decides. */
unsigned dea_load_point_flags(const struct dea_load_point *point);
/* Whether one of some flags is of that kind. */
bool dea_flags_have(unsigned flags, enum dea_flag_kind kind);
/* Without a flag of that kind. */
bool dea_load_point_valid(const struct dea_load_point *point);
bool dea_load_point_safe(const struct dea_load_point *point);
bool dea_load_point_bounds(const struct dea_load_point *point);
/* All its numbers are predictions: valid, and none is a bound. */
bool dea_load_point_trusted(const struct dea_load_point *point);
/* Whether it is one of several states, of which another device may have found another. */
bool dea_load_point_is_one_of_several(const struct dea_load_point *point);

/* "slack unstable ...", each with a blank after it. */
#define DEA_FLAG_WORD(name, word, kind, sentence) word " "
#define DEA_FLAG_WORDS DEA_FLAG_LIST(DEA_FLAG_WORD)

/* A flag as files and people read it; static storage. */
struct dea_flag_words {
  const char *word, *sentence; // "slack", "the film ..."
  enum dea_flag_kind kind;
};
extern const struct dea_flag_words dea_flag_words[DEA_FLAG_COUNT];
/* Words of flags with blanks between them, "" for none; out: DEA_FLAGS_SIZE. Returns out. */
enum { DEA_FLAGS_SIZE = 96 };
const char *dea_flags_text(unsigned flags, char out[DEA_FLAGS_SIZE]);
/* "not trusted, slack: so much of the film ...". Returns out. */
enum { DEA_FLAG_LINE_SIZE = 200 };
const char *dea_flag_line(enum dea_flag flag, char out[DEA_FLAG_LINE_SIZE]);
/* Flags of such words; what is no word is passed over. */
unsigned dea_flags_of_text(const char *text);

/* Where a branch turns (limit point under voltage control), the film goes slack or breaks down, or
 * another branch crosses. */
enum dea_event_kind {
  DEA_EVENT_PULL_IN,
  DEA_EVENT_SNAP_BACK,
  DEA_EVENT_SLACK,
  DEA_EVENT_BREAKDOWN,
  DEA_EVENT_BUCKLING
};

struct dea_event {
  enum dea_event_kind kind;
  struct dea_load_point point;
};
