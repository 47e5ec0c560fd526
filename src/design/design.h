/* The design: what a user wrote, checked for form, in SI, each value with its place.
 *
 * design file -> struct dea_design -> const struct dea_device. A design is editable; a device is
 * what the models see. The schema (one table, design/design_schema.c) says key, unit, range,
 * default and meaning of every member. */
#pragma once

#include "base/schema.h"
#include "base/value.h"
#include "base/yaml.h"
#include "design/fabrication.h"
#include "design/parts.h"
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
  DEA_DESIGN_SECTIONS_MAX = 16,
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
enum dea_buckling_branch { DEA_BRANCH_ANY, DEA_BRANCH_FIBRES, DEA_BRANCH_BACK };

struct dea_design;
struct dea_device;
struct dea_settings;

/* A design that another one is compared with. */
struct dea_design_variant {
  struct dea_label name;
  struct dea_label file; // absent: the same file
  const struct dea_node
      *set;                  // values in the place of that file's; NULL: none; lent by the document
  struct dea_design *design; // owned; NULL: the design itself, without a file or changes
};

/* A section of `compute` whose keys, and the struct that they fill, belong to who reads it: a
 * study. */
struct dea_design_section {
  struct dea_record record; // its name, "convergence", and keys; offsets count from the settings
  size_t size;              // of the settings
  /* Adds findings where values do not go together; NULL: they always do. */
  dea_status (*check)(struct dea_context *ctx, const struct dea_design *design,
                      const struct dea_settings *settings);
  /* The same where they do not fit the device; NULL. */
  dea_status (*fit)(struct dea_context *ctx, const struct dea_settings *settings,
                    const struct dea_device *device);
};
struct dea_design_sections {
  const struct dea_design_section *const *items; // [count]
  size_t count;
  /* Adds a finding where there is no model of that name; NULL: any name will do. */
  dea_status (*check_model)(struct dea_context *ctx, const struct dea_label *name);
};

struct dea_settings {
  const struct dea_design_section *section;
  void *values; // owned
  bool written; // the section is in the file; its values are there without it too
};

struct dea_design {
  const char *file; // as given by the caller; interned in the context
  struct dea_label title;
  struct dea_parts *parts; // owned, of the general form, which has no film, frame, electrodes, and
                           // fibres of the next members; NULL: the short form

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
    struct dea_quantity sheet_resistance_ohm;
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
    struct dea_quantity angle_rad;        // of the first from the x axis
  } fibres;

  struct dea_choice gravity;          // enum dea_gravity
  struct dea_quantity temperature_K;  // absent: unknown
  struct dea_fabrication fabrication; // what the workshop needs

  struct {                          // drive: what the electrodes are connected to
    const struct dea_node *section; // of the waveform; lent by the document; NULL: none
    struct dea_waveform *waveform;  // owned; NULL: none
    struct dea_quantity series_resistance_ohm;
    struct dea_quantity current_limit_A, slew_limit_V_per_s; // absent: none
    struct dea_quantity disconnect_s;                        // absent: never
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
    struct dea_settings settings[DEA_DESIGN_SECTIONS_MAX]; // of sections that studies own
    size_t settings_count;
    struct dea_design_variant compare[DEA_DESIGN_VARIANTS_MAX]; // study compare-design
    size_t compare_count;
    struct dea_choice coverage_by;        // enum dea_coverage_by, paper eq 17
    struct dea_quantity coverage;         // R itself; absent: from coverage_by
    struct {                              // model 3d
      struct dea_choice film, domain;     // enum dea_solid_film, enum dea_solid_domain
      struct dea_choice buckling_branch;  // enum dea_buckling_branch
      struct dea_choice field;            // enum dea_solid_electrostatics
      struct dea_quantity order, order_z; // of the elements, in the plane and through the thickness
      struct dea_quantity elements_z;     // through the film
      struct dea_quantity refinement;     // 1: the coarsest mesh; one more halves all sizes
      struct dea_quantity tip_refinement; // where fibre tips end
      struct {                            // meshes by the estimated error of a monitor
        bool asked;
        struct dea_label monitor; // its name
        struct dea_quantity tolerance, passes;
      } adapt;
      struct dea_choice path; // 1: study path follows it too
    } solid;
    struct { // model reduced
      struct dea_label file, monitor;
      struct dea_choice motion; // 0: the largest displacement, else 1 + enum dea_observed
      struct dea_quantity voltage_V, force, voltages, forces, air_kg_per_m3;
    } reduced;
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

/* Settings of a section, NULL when the design was read without it; lent. */
const struct dea_settings *dea_design_settings(const struct dea_design *design,
                                               const struct dea_design_section *section);
/* The highest of the voltages to be computed; 0 when none is above it. */
double dea_design_highest_V(const struct dea_design *design);
/* NULL is fine. */
void dea_design_destroy(struct dea_context *ctx, struct dea_design *design);
