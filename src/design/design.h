/* The design: what a user wrote, checked for form, in SI, each value with its place.
 *
 * design file -> struct dea_design -> const struct dea_device. A design is editable; a device is
 * what the models see. The schema (one table, design/schema.c) says key, unit, range, default and
 * meaning of every member. */
#ifndef DEA_DESIGN_DESIGN_H
#define DEA_DESIGN_DESIGN_H

#include "base/value.h"
#include "design/fabrication.h"
#include "material/catalogue.h"
#include "waveform/waveform.h"

enum {
  DEA_DESIGN_VERSION = 1,
  DEA_DESIGN_MODELS_MAX = 4,
  DEA_DESIGN_MATERIALS_MAX = 16,
  DEA_DESIGN_VOLTAGES_MAX = 10000,
  DEA_DESIGN_STOPS_MAX = 32,
  DEA_DESIGN_MODES_MAX = 10, // their shapes are fields of one mesh
  DEA_DESIGN_FIELDS_MAX = 100,
  DEA_DESIGN_MESHES_MAX = 8,
  DEA_DESIGN_VARIANTS_MAX = 8,
};

enum dea_outer_end { DEA_END_CLAMPED, DEA_END_HINGED, DEA_END_FREE };
enum dea_fields_at { DEA_FIELDS_ALL, DEA_FIELDS_LAST, DEA_FIELDS_NONE };
enum dea_fields_of { DEA_FIELDS_WHOLE, DEA_FIELDS_SECTOR };
enum dea_coverage_by { DEA_COVERAGE_RADIUS, DEA_COVERAGE_AREA };
enum dea_solid_film { DEA_FILM_SOLID, DEA_FILM_MEMBRANE };
enum dea_solid_electrostatics { DEA_FIELD_THIN, DEA_FIELD_COUPLED };
enum dea_solid_domain { DEA_DOMAIN_SECTOR, DEA_DOMAIN_DISC };
enum dea_gravity { DEA_GRAVITY_OFF, DEA_GRAVITY_FIBRES_UP, DEA_GRAVITY_FIBRES_DOWN };
enum dea_buckling_branch { DEA_BRANCH_ANY, DEA_BRANCH_FIBRES, DEA_BRANCH_BACK }; // of the centre

struct dea_design;

/* A design that another one is compared with. */
struct dea_design_variant {
  struct dea_label name;
  struct dea_label file; // absent: the same file
  const struct dea_node
      *set;                  // values in the place of that file's; NULL: none; lent by the document
  struct dea_design *design; // owned; NULL: the design itself, without a file or changes
};

struct dea_design {
  const char *file; // as given by the caller; interned in the context
  struct dea_label title;

  struct {                                         // film
    struct dea_label material;                     // catalogue or inline name
    struct dea_label law, permittivity, breakdown; // ids of sets, "" = the first
    struct dea_label viscosity;                    // the same, "none": without
    struct dea_quantity thickness_m;               // unstretched
  } film;
  struct dea_quantity pre_stretch; // equibiaxial, >= 1

  struct {                        // frame: rigid, so its lengths are lengths of the stretched film
    struct dea_quantity radius_m; // inner radius (given as radius or diameter)
  } frame;

  struct {                            // electrodes: a disc on both faces
    struct dea_inplane_length radius; // given as radius or diameter; length.si is the radius
    struct dea_label material;
    struct dea_quantity thickness_m; // of each; 0 = no stiffness
  } electrodes;

  bool has_fibres;
  struct { // fibres on the +z face, from the frame towards the centre
    struct dea_quantity count;
    struct dea_quantity width_m, thickness_m;
    struct dea_quantity tip_width_m; // absent: width_m
    // Exactly one of the next three says where the tip is; the others are absent.
    struct dea_inplane_length length;     // from the inner edge of the frame to the tip
    struct dea_inplane_length tip_radius; // from the centre to the tip ("reach")
    struct dea_inplane_length overlap;    // with the electrode; negative: a gap
    struct dea_label material;
    struct dea_quantity bond_thickness_m; // glue layer; 0 = none
    struct dea_quantity bond_modulus_Pa;  // Young's modulus of the glue
    struct dea_choice outer_end;          // enum dea_outer_end
    struct dea_inplane_length outer_gap;  // from a free outer end to the frame
  } fibres;

  struct dea_choice gravity;          // enum dea_gravity
  struct dea_fabrication fabrication; // what the workshop needs

  struct {                          // drive: what the electrodes are connected to
    const struct dea_node *section; // of the waveform; lent by the document; NULL: none
    struct dea_waveform *waveform;  // owned; NULL: none
    struct dea_quantity series_resistance_ohm;
    struct dea_quantity current_limit_A, slew_limit_V_per_s; // absent: none
  } drive;

  struct dea_material_data *materials; // [material_count] inline ones of this file, owned
  size_t material_count;

  struct {                                          // compute
    struct dea_label models[DEA_DESIGN_MODELS_MAX]; // names; which exist the model list knows
    size_t model_count;
    double *voltages_V; // [voltage_count], owned; in the order to be computed
    size_t voltage_count;
    struct dea_location voltages_place;
    struct dea_quantity path_max_stretch; // of the electrode, total; DEA_DEFAULT: or beyond
    struct { // force on a rigid tip; without depths and preloads nothing is computed
      struct dea_choice tip;  // enum dea_indenter_shape
      struct dea_choice side; // 0: it comes from the fibres' side, 1: from the other
      struct dea_quantity radius_m, edge_radius_m;
      struct dea_quantity depths_m[DEA_DESIGN_STOPS_MAX], preloads_N[DEA_DESIGN_STOPS_MAX];
      size_t depth_count, preload_count;
    } force;
    struct {      // study of convergence, of models with a mesh
      bool asked; // the section is there; the values are there without it too
      struct dea_quantity refinements[DEA_DESIGN_MESHES_MAX]; // rising
      struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX];   // none: quarters of the highest
      size_t refinement_count, voltage_count;
      struct dea_quantity tolerance; // relative
    } convergence;
    struct {                              // study transient
      struct dea_quantity until_s;        // absent: the waveform's end
      struct dea_quantity tolerance;      // error of a step over the largest motion so far
      struct dea_quantity longest_step_s; // absent: a twentieth of a cycle
      struct dea_quantity interval_s;     // of points that are kept; absent: every step
      struct dea_choice press;            // 0: no, 1: the tip of `force` first
      struct dea_choice inertia;          // 0: no, 1: yes
      struct dea_quantity rho_inf;        // spectral radius of generalised alpha
    } transient;
    struct {                                                // study of vibrations
      bool asked;                                           // the section is there
      struct dea_quantity count;                            // modes
      struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: 0 and quarters of the highest
      size_t voltage_count;
    } modal;
    struct { // study of the response to an AC excitation; without a bias nothing is computed
      struct dea_quantity biases_V[DEA_DESIGN_STOPS_MAX];
      size_t bias_count;
      struct dea_quantity ripple_V, from_Hz, to_Hz, points;
      struct dea_quantity damping, damping_mass_per_s, damping_stiffness_s;
    } frequency;
    struct dea_design_variant compare[DEA_DESIGN_VARIANTS_MAX]; // study compare-design
    size_t compare_count;
    struct dea_choice coverage_by;        // enum dea_coverage_by, paper eq 17
    struct dea_quantity coverage;         // R itself; absent: from coverage_by
    struct {                              // model 3d
      struct dea_choice film, domain;     // enum dea_solid_film, enum dea_solid_domain
      struct dea_choice side;             // enum dea_buckling_branch
      struct dea_choice field;            // enum dea_solid_electrostatics
      struct dea_quantity order, order_z; // of the elements, in the plane and through the thickness
      struct dea_quantity refinement;     // 1: the coarsest mesh; one more halves all sizes
    } solid;
  } compute;

  struct { // report
    bool svg, pdf, png;
    struct dea_quantity width_m; // of a figure
    struct dea_choice fields;    // enum dea_fields_at; absent: at the voltages that follow
    double fields_at_V[DEA_DESIGN_FIELDS_MAX]; // voltages of the sweep
    size_t fields_at_count;
    struct dea_choice fields_of; // enum dea_fields_of
  } report;

  struct dea_listing values; // every value as written or by default, in the order of the schema
  struct dea_yaml *document; // the file; texts of materials and values live in it
};

/* One override of --set: key is the dotted path in the file ("film.thickness"), value as it would
 * stand in the file ("200 um"). */
struct dea_override {
  const char *key, *value;
};

/* Reads and checks a file. All findings go to the context with file:line:column; any error gives
 * DEA_E_DESIGN (DEA_E_IO when the file cannot be read at all) after the whole file was looked at.
 * out: owned by the caller, NULL on failure. */
dea_status dea_design_read(struct dea_context *ctx, const char *file,
                           const struct dea_override *overrides, size_t override_count,
                           struct dea_design **out);
/* The same from memory; name stands for the file in messages. */
dea_status dea_design_read_memory(struct dea_context *ctx, const char *name, const char *bytes,
                                  size_t length, const struct dea_override *overrides,
                                  size_t override_count, struct dea_design **out);
/* The highest of the voltages to be computed; 0 when none is above it. */
double dea_design_highest_V(const struct dea_design *design);
/* NULL is fine. */
void dea_design_destroy(struct dea_context *ctx, struct dea_design *design);

#endif
