#include "model/solid/assembly/settings.h"

#include <math.h>

struct dea_solid_settings dea_solid_settings_default(void)
{
#define DEFAULT(type, member, value, unit, meaning) .member = (value),
  return (struct dea_solid_settings){DEA_SOLID_SETTINGS(DEFAULT).accept_unstable = false};
#undef DEFAULT
}

static dea_status check_number(struct dea_context *ctx, const char *name, double value)
{
  return value > 0 && isfinite(value)
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "the setting %s has to be above 0, not %g", name,
                        value);
}

static dea_status check_power(struct dea_context *ctx, const char *name, double value)
{
  int exponent;
  return frexp(value, &exponent) == 0.5
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "the setting %s has to be a power of 2, not %g", name,
                        value);
}

dea_status dea_solid_settings_check(struct dea_context *ctx,
                                    const struct dea_solid_settings *settings)
{
#define CHECK(type, member, value, unit, meaning)                                                  \
  DEA_TRY(ctx, check_number(ctx, #member, (double)settings->member));
  DEA_SOLID_SETTINGS(CHECK)
#undef CHECK
  DEA_TRY(ctx, check_power(ctx, "bulk_stiff", settings->bulk_stiff));
  DEA_TRY(ctx, check_power(ctx, "path_bulk", settings->path_bulk));
  return DEA_OK;
}
