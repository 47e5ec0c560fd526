#include "model/solid/assembly/solver_settings.h"

#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

static const struct member {
  struct dea_solid_setting about;
  const char *former;
  size_t offset;
  bool whole; // an int, otherwise a double
} members[] = {
#define MEMBER(type, member, former, value, unit, meaning)                                         \
  {{#member, unit, meaning}, former, offsetof(struct dea_solid_settings, member), (type)0.5 == 0},
    DEA_SOLID_SETTINGS(MEMBER)
#undef MEMBER
};

enum { MEMBERS = sizeof members / sizeof members[0] };

struct dea_solid_settings dea_solid_settings_default(void)
{
#define DEFAULT(type, member, former, value, unit, meaning) .member = (value),
  return (struct dea_solid_settings){DEA_SOLID_SETTINGS(DEFAULT).accept_unstable = false};
#undef DEFAULT
}

const struct dea_solid_setting *dea_solid_settings_at(const struct dea_solid_settings *settings,
                                                      size_t number, double *value)
{
  if (number >= MEMBERS) {
    return NULL;
  }
  const struct member *m = &members[number];
  const char *at = (const char *)settings + m->offset;
  int whole;
  if (m->whole) {
    memcpy(&whole, at, sizeof whole);
    *value = whole;
  } else {
    memcpy(value, at, sizeof *value);
  }
  return &m->about;
}

dea_status dea_solid_settings_set(struct dea_context *ctx, struct dea_solid_settings *settings,
                                  const char *name, double value)
{
  struct dea_solid_settings next = *settings;
  size_t i = 0;
  while (i < MEMBERS && strcmp(members[i].about.name, name) != 0 &&
         strcmp(members[i].former, name) != 0) {
    i++;
  }
  if (i == MEMBERS) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a solid has no setting '%s'", name);
  }
  char *at = (char *)&next + members[i].offset;
  if (!members[i].whole) {
    memcpy(at, &value, sizeof value);
  } else if (value >= 1 && value <= INT_MAX && value == floor(value)) {
    int whole = (int)value;
    memcpy(at, &whole, sizeof whole);
  } else {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the setting %s has to be a whole number, not %g", name,
                    value);
  }
  DEA_TRY(ctx, dea_solid_settings_check(ctx, &next));
  *settings = next;
  return DEA_OK;
}

dea_status dea_solid_settings_check(struct dea_context *ctx,
                                    const struct dea_solid_settings *settings)
{
  const struct dea_solid_setting *setting;
  double value;
  for (size_t i = 0; (setting = dea_solid_settings_at(settings, i, &value)) != NULL; i++) {
    if (!(value > 0 && isfinite(value))) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "the setting %s has to be above 0, not %g",
                      setting->name, value);
    }
  }
  int exponent;
  if (frexp(settings->descent_bulk_factor, &exponent) != 0.5) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the setting descent_bulk_factor has to be a power of 2, not %g",
                    settings->descent_bulk_factor);
  }
  return DEA_OK;
}
