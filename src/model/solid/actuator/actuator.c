#include "model/solid/actuator/actuator.h"

#include "model/film.h"
#include "model/solid/actuator/constituent_of_material.h"
#include "model/solid/point/membrane_point.h"

#include <math.h>

static bool known(double density)
{
  return density > 0;
}

/* Densities; an electrode or a glue of which none is known is as heavy as the film. The
 * constituents that join a membrane to fibres have no mass: all of the film's is in its surface. */
static void set_densities(const struct dea_device *d, struct dea_constituent *constituents)
{
  double film = d->film.density_kg_per_m3, electrode = d->electrode.density_kg_per_m3;
  constituents[DEA_CONSTITUENT_FILM].density_kg_per_m3 = film;
  constituents[DEA_CONSTITUENT_ELECTRODE].density_kg_per_m3 = known(electrode) ? electrode : film;
  constituents[DEA_CONSTITUENT_GLUE].density_kg_per_m3 = film;
  constituents[DEA_CONSTITUENT_FIBRE].density_kg_per_m3 = d->fibre.density_kg_per_m3;
}

dea_status dea_actuator_check_mass(struct dea_context *ctx, const struct dea_actuator *a)
{
  const struct dea_device *d = a->device;
  bool fibres = d->fibre_count > 0;
  DEA_TRY(ctx, dea_device_check_densities(ctx, d));
  if (a->plate.electrode_thickness > 0 && !known(d->electrode.density_kg_per_m3)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: the density of the electrodes is unknown; that of the "
                                 "film, %.4g kg/m^3, is taken",
                                 d->film.density_kg_per_m3));
  }
  if (fibres && a->plate.glue_thickness > 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: the density of the glue is unknown; that of the film, "
                                 "%.4g kg/m^3, is taken",
                                 d->film.density_kg_per_m3));
  }
  return DEA_OK;
}

/* Film and electrodes as surfaces, and what joins them to fibres (docs/theory/membrane.md). */
static dea_status make_membrane(struct dea_context *ctx, bool stiff_electrodes,
                                struct dea_actuator *out)
{
  struct dea_constituent *constituents = out->constituents;
  struct dea_constituent *film = &constituents[DEA_CONSTITUENT_FILM],
                         *electrode = &constituents[DEA_CONSTITUENT_ELECTRODE];
  struct dea_constituent *under = &constituents[DEA_CONSTITUENT_BOND_ELECTRODE];
  dea_status status = dea_membrane_bond(film, &constituents[DEA_CONSTITUENT_BOND]);
  film->relaxed = !stiff_electrodes; // bonded plies wrinkle together, not each by itself
  if (status == DEA_OK && stiff_electrodes) {
    status = dea_membrane_bond(electrode, under);
    // the load comes in below it, and not over its depth as a film's own does
    under->param[0] /= 1.5;
    electrode->thickness_m *= 2; // both
  }
  return status == DEA_OK ? DEA_OK
                          : dea_fail(ctx, status,
                                     "compute.solid.film: membrane takes isotropic laws of film "
                                     "and electrodes only; take compute.solid.film: solid");
}

dea_status dea_actuator_create(struct dea_context *ctx, const struct dea_device *device,
                               const struct dea_model_settings *settings, struct dea_actuator *out)
{
  const struct dea_device *d = device;
  struct dea_film film;
  *out = (struct dea_actuator){.device = device, .settings = *settings};
  DEA_TRY(ctx, dea_film_create(ctx, d, &film)); // laws and permittivity are there
  DEA_TRY(ctx, dea_fibre_disc_of_device(ctx, d, settings, &out->plate));
  struct dea_constituent *constituents = out->constituents;
  for (int i = 0; i < DEA_CONSTITUENT_COUNT; i++) { // also what this device has not
    constituents[i] = dea_constituent_bonded((const double[]){0, 0});
  }
  const double l[] = {d->pre_stretch, d->pre_stretch};
  constituents[DEA_CONSTITUENT_FILM] = dea_constituent_stretched(DEA_PART_FILM, &d->film, l, 0);
  dea_constituent_set_permittivity(&constituents[DEA_CONSTITUENT_FILM], &d->film.permittivity,
                                   d->film_thickness_m);
  constituents[DEA_CONSTITUENT_ELECTRODE] = dea_constituent_stretched(
      DEA_PART_ELECTRODE, film.electrode != NULL ? film.electrode : &d->film, l, 0);
  constituents[DEA_CONSTITUENT_ELECTRODE].thickness_m = out->plate.electrode_thickness;
  // a glue is taken as incompressible; the design says nothing else of it
  constituents[DEA_CONSTITUENT_GLUE] = dea_constituent_free(DEA_PART_GLUE, d->bond_modulus_Pa, 0.5);
  constituents[DEA_CONSTITUENT_FIBRE] =
      dea_constituent_free(DEA_PART_FIBRE, d->fibre.young_modulus_Pa, d->fibre.poisson_ratio);
  for (int i = 0; i < DEA_CONSTITUENT_BOND; i++) { // bonds come below, free of stress
    bool there = i == DEA_CONSTITUENT_FILM ||
                 (i == DEA_CONSTITUENT_ELECTRODE && film.electrode != NULL) ||
                 (i > DEA_CONSTITUENT_ELECTRODE && d->fibre_count > 0);
    dea_status status = there ? dea_constituent_relax(&constituents[i]) : DEA_OK;
    if (status != DEA_OK) {
      return dea_fail(ctx, status, "the law '%s' ends before the pre-stretch %.4g",
                      constituents[i].law->name, d->pre_stretch);
    }
  }
  if (out->plate.membrane && settings->field == DEA_FIELD_COUPLED) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "compute.solid.field: coupled needs a film with a thickness; take "
                    "compute.solid.film: solid");
  }
  constituents[DEA_CONSTITUENT_GLUE].thickness_m = out->plate.glue_thickness;
  constituents[DEA_CONSTITUENT_FIBRE].thickness_m = out->plate.fibre_thickness;
  set_densities(d, constituents);
  if (out->plate.membrane) {
    DEA_TRY(ctx, make_membrane(ctx, film.electrode != NULL, out));
  }
  return DEA_OK;
}

dea_status dea_actuator_lay_electrodes(struct dea_actuator *actuator, double share)
{
  struct dea_constituent *electrode = &actuator->constituents[DEA_CONSTITUENT_ELECTRODE];
  double stretch = 1 + share * (actuator->device->pre_stretch - 1);
  electrode->pre_stretch[0] = electrode->pre_stretch[1] = stretch;
  electrode->pre_stretch[2] = 1 / (stretch * stretch);
  return dea_constituent_relax(electrode);
}

int dea_actuator_constituent(const void *self, int region, int ply)
{
  const struct dea_actuator *a = self;
  bool electrode = (region & DEA_FIBRE_DISC_ELECTRODE) != 0;
  switch (ply) {
  case DEA_FIBRE_DISC_FILM:
    return DEA_CONSTITUENT_FILM;
  case DEA_FIBRE_DISC_BOND:
    return DEA_CONSTITUENT_BOND;
  case DEA_FIBRE_DISC_TOP: // beside the electrodes it fills what is under the fibre
    return electrode
               ? a->plate.membrane ? DEA_CONSTITUENT_BOND_ELECTRODE : DEA_CONSTITUENT_ELECTRODE
           : a->plate.glue_thickness > 0 ? DEA_CONSTITUENT_GLUE
                                         : DEA_CONSTITUENT_FIBRE;
  case DEA_FIBRE_DISC_BOTTOM:
    return DEA_CONSTITUENT_ELECTRODE;
  default:
    return ply == DEA_FIBRE_DISC_GLUE ? DEA_CONSTITUENT_GLUE : DEA_CONSTITUENT_FIBRE;
  }
}

bool dea_actuator_active(const void *self, int region, int ply)
{
  (void)self;
  return ply == DEA_FIBRE_DISC_FILM && (region & DEA_FIBRE_DISC_ELECTRODE) != 0;
}

int dea_actuator_held(const void *self, const double X[3])
{
  const struct dea_actuator *a = self;
  return dea_fibre_disc_held(&a->plate, X);
}

bool dea_actuator_electrode(const void *self, const double X[3], double *share)
{
  const struct dea_actuator *a = self;
  double face = 0.5 * a->plate.film_thickness;
  *share = X[2] > 0 ? 1 : 0;
  return fabs(fabs(X[2]) - face) < 1e-6 * face &&
         hypot(X[0], X[1]) < a->plate.electrode_radius * (1 + 1e-9);
}

bool dea_actuator_frame(const void *self, const double X[3], double Q[9])
{
  const struct dea_actuator *a = self;
  return dea_fibre_disc_frame(&a->plate, X, Q);
}

double dea_actuator_copies(const struct dea_actuator *a)
{
  return (double)dea_fibre_disc_sectors(&a->plate) / a->plate.sectors;
}
