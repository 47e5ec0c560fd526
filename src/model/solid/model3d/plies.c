#include "model/solid/model3d/plies.h"

#include "model/solid/point/membrane_point.h"
#include "model/solid_check.h"

#include <math.h>
#include <string.h>

// Materials --------------------------------------------------------------------------------------

static const double kappa_share = 100; // kappa over the shear modulus
static const double same_angle = 1e-9; // of a quarter turn: along an axis

/* Poisson's ratios from there on are those of an incompressible solid: kappa is large enough. */
static const double incompressible = 0.49;

/* Of the material's law, stretched before it came to the flat state, along two axes of which the
 * first is turned by an angle from x. */
static struct dea_part_material stretched(enum dea_part part, const struct dea_material *material,
                                          const double pre_stretch[2], double angle_rad)
{
  const double quarter = 0.5 * DEA_PI, turns = angle_rad / quarter, whole = round(turns);
  bool along = pre_stretch[0] == pre_stretch[1] || fabs(turns - whole) < same_angle;
  bool across = along && fmod(whole, 2) != 0;
  double l1 = pre_stretch[across ? 1 : 0], l2 = pre_stretch[across ? 0 : 1];
  double middle = 0.5 * (l1 + l2), half = 0.5 * (l1 - l2);
  const double direction_rad = angle_rad + material->fibre_angle_rad; // G leaves its own axes
  struct dea_part_material out = {
      .part = part,
      .pre_stretch = {l1, l2, 1 / (l1 * l2)},
      .direction = {cos(direction_rad), sin(direction_rad)},
      .kappa_Pa = kappa_share * material->law->shear_modulus(material->param),
  };
  if (!along) { // G = R diag(l1, l2) R^T by the double angle
    out.pre_stretch[0] = middle + half * cos(2 * angle_rad);
    out.pre_stretch[1] = middle - half * cos(2 * angle_rad);
    out.pre_shear = half * sin(2 * angle_rad);
  }
  dea_part_material_set_law(&out, material->law, material->param);
  return out;
}

/* Bonded free of stress; a Poisson's ratio of 0.49 and more is taken as incompressible. */
static struct dea_part_material unstretched(enum dea_part part, double young_modulus_Pa,
                                            double poisson_ratio)
{
  const double param[] = {young_modulus_Pa, poisson_ratio}, shear_modulus = young_modulus_Pa / 3;
  struct dea_part_material out = dea_part_material_bonded(param);
  out.part = part;
  if (poisson_ratio >= incompressible) {
    dea_part_material_set_law(&out, dea_law_find("neo-hookean"), &shear_modulus);
    out.kappa_Pa = kappa_share * shear_modulus;
  }
  return out;
}

/* Permittivity of a film between electrodes h apart, as it depends on its area: eps_r = at_rest +
 * slope (s - 1), s = sqrt(l1 l2) sqrt(area stretch). */
static void set_permittivity(struct dea_part_material *part_material,
                             const struct dea_permittivity *permittivity, double thickness_m)
{
  double l = sqrt(1 / part_material->pre_stretch[2]), slope = permittivity->slope;
  part_material->permittivity_F_per_m = DEA_EPSILON_0 * (permittivity->at_rest + slope * (l - 1));
  part_material->permittivity_slope_F_per_m = DEA_EPSILON_0 * slope * l;
  part_material->thickness_m = thickness_m;
}

static enum dea_part part_of(const struct dea_layout_mesh *mesh, size_t i)
{
  static const enum dea_part parts[] = {[DEA_PLY_SHEET] = DEA_PART_FIBRE,
                                        [DEA_PLY_ELECTRODE] = DEA_PART_ELECTRODE,
                                        [DEA_PLY_GLUE] = DEA_PART_GLUE};
  return mesh->dielectric[i] ? DEA_PART_FILM : parts[mesh->layout->plies[i].kind];
}

/* Between a surface and what lies on it. The load of an electrode comes in below it, and not over
 * its depth as a film's own does. */
static dea_status fill_bond(struct dea_context *ctx, const struct dea_layout_mesh *mesh, size_t i,
                            struct dea_part_material *part_materials)
{
  const size_t joins = mesh->layout->plies[i].joins;
  dea_status status = dea_membrane_bond(&part_materials[joins], &part_materials[i]);
  if (!mesh->dielectric[joins]) {
    part_materials[i].param[0] /= 1.5;
  }
  return status == DEA_OK ? DEA_OK
                          : dea_fail(ctx, status,
                                     "compute.solid.film: membrane takes isotropic laws of film "
                                     "and electrodes only; take compute.solid.film: solid");
}

static dea_status fill_part_material(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                     size_t i, bool alone, struct dea_part_material *out)
{
  const struct dea_layout_ply *ply = &mesh->layout->plies[i];
  const struct dea_material *material = &ply->material;
  const double *l = ply->pre_stretch;
  DEA_TRY(ctx, dea_solid_check_ply(ctx, mesh->layout, i));
  *out = material->law != NULL
             ? stretched(part_of(mesh, i), material, l, ply->angle_rad)
             : unstretched(part_of(mesh, i), material->young_modulus_Pa, material->poisson_ratio);
  if (mesh->dielectric[i]) {
    set_permittivity(out, &material->permittivity, ply->thickness_m);
    out->relaxed = mesh->membrane && alone;
    out->layers = (double)dea_ply_layers(ply);
  }
  out->thickness_m = ply->thickness_m;
  out->density_kg_per_m3 = material->density_kg_per_m3;
  if (dea_part_material_relax(out) != DEA_OK) {
    return dea_fail(ctx, DEA_E_DOMAIN, "ply '%s': the law '%s' ends before the pre-stretch %.4g",
                    ply->name, out->law->name, fmax(l[0], l[1]));
  }
  return DEA_OK;
}

/* 1/(resistivity permittivity) of a film of a material; 0: it does not leak. */
static double leakage_per_s(const struct dea_material *material,
                            const struct dea_part_material *part_material)
{
  double rho = material->resistivity_ohm_m;
  return rho > 0 ? 1 / (rho * part_material->permittivity_F_per_m) : 0; // as it is pre-stretched
}

static void find_thinnest(const struct dea_layout_mesh *mesh, struct dea_plies *out)
{
  const struct dea_layout *l = mesh->layout;
  double ratio = 1e-3;
  out->thinnest_m = INFINITY;
  for (size_t i = l->ply_count; i-- > 0;) {
    if (mesh->dielectric[i]) {
      out->film = i;
      out->thinnest_m = fmin(out->thinnest_m, dea_ply_layer_m(&l->plies[i]));
    }
  }
  for (size_t k = 1; k < l->channel_count; k++) {
    ratio = fmax(ratio, fabs(l->channels[k].ratio));
  }
  out->thinnest_m /= ratio;
}

dea_status dea_plies_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                            struct dea_arena *memory, struct dea_plies *out)
{
  const struct dea_layout *l = mesh->layout;
  bool alone = true; // bonded plies wrinkle together, not each by itself
  *out = (struct dea_plies){
      .part_materials = dea_arena_alloc(memory, l->ply_count, sizeof *out->part_materials),
      .films = dea_arena_alloc(memory, l->ply_count, sizeof *out->films),
      .branches = dea_arena_alloc(memory, l->ply_count, sizeof *out->branches),
      .leakage_per_s = dea_arena_alloc(memory, l->ply_count, sizeof *out->leakage_per_s)};
  DEA_TRY(ctx, dea_arena_status(memory));
  for (size_t i = 0; i < l->ply_count; i++) {
    alone = alone && l->plies[i].kind != DEA_PLY_ELECTRODE;
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    const struct dea_material *material = &ply->material;
    const bool film = material->law != NULL && ply->kind == DEA_PLY_SHEET;
    DEA_TRY(ctx, ply->kind == DEA_PLY_JOINT
                     ? fill_bond(ctx, mesh, i, out->part_materials)
                     : fill_part_material(ctx, mesh, i, alone, &out->part_materials[i]));
    out->films[i] = (struct dea_solid_film_data){film ? material : NULL,
                                                 sqrt(ply->pre_stretch[0] * ply->pre_stretch[1])};
    out->leakage_per_s[i] =
        mesh->dielectric[i] ? leakage_per_s(material, &out->part_materials[i]) : 0;
    out->branches[i].count = material->branch_count;
    memcpy(out->branches[i].branch, material->branches,
           material->branch_count * sizeof *material->branches);
  }
  find_thinnest(mesh, out);
  return DEA_OK;
}

// Places -----------------------------------------------------------------------------------------

int dea_plies_part_material(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  return ply;
}

static const struct dea_layout_field *field_of(const void *self, int region, int ply)
{
  const struct dea_layout_mesh *mesh = self;
  return &mesh->field[(size_t)region * mesh->layout->ply_count + (size_t)ply];
}

bool dea_plies_active(const void *self, int region, int ply)
{
  return field_of(self, region, ply)->top >= 0;
}

void dea_plies_channels(const void *self, int region, int ply, int *top, int *bottom)
{
  *top = field_of(self, region, ply)->top;
  *bottom = field_of(self, region, ply)->bottom;
}

int dea_plies_held(const void *self, const double X[3])
{
  const struct dea_layout_mesh *mesh = self;
  double Q[9];
  return dea_layout_sector_holds(&mesh->sector, X, mesh->near_m, Q);
}

bool dea_plies_frame(const void *self, const double X[3], double Q[9])
{
  const struct dea_layout_mesh *mesh = self;
  return dea_layout_sector_holds(&mesh->sector, X, mesh->near_m, Q) != 0 && Q[1] != 0;
}

bool dea_plies_electrode(const void *self, const double X[3], double *share)
{
  const struct dea_layout_mesh *mesh = self;
  const struct dea_layout *l = mesh->layout;
  const double near_m = mesh->near_m;
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct dea_layout_electrode *e = &l->electrodes[i];
    const struct dea_region *region = &l->regions[e->region].region;
    const double away_m = X[2] - mesh->face_m[e->ply][e->top ? 1 : 0];
    if (fabs(away_m) < 1e-6 * l->plies[e->ply].thickness_m &&
        (dea_region_inside(region, X[0], X[1]) || dea_region_distance_m(region, X) <= near_m)) {
      *share = e->channel == 0 ? 0 : l->channels[e->channel].ratio;
      return true;
    }
  }
  return false;
}
