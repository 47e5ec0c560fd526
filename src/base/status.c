#include "base/status.h"

#include <stddef.h>

struct status_row {
  const char *name;
  int exit_code;
  const char *message;
};

static const struct status_row status_table[] = {
#define STATUS_ROW(code, exit_code, message) {#code, exit_code, message},
    DEA_STATUS_LIST(STATUS_ROW)
#undef STATUS_ROW
};

static const struct status_row *status_row_get(dea_status status)
{
  static const struct status_row unknown = {"?", 5, "unknown status"};
  size_t i = (size_t)status;
  return i < sizeof status_table / sizeof status_table[0] ? &status_table[i] : &unknown;
}

const char *dea_status_message(dea_status status)
{
  return status_row_get(status)->message;
}

const char *dea_status_name(dea_status status)
{
  return status_row_get(status)->name;
}

int dea_status_exit_code(dea_status status)
{
  return status_row_get(status)->exit_code;
}
