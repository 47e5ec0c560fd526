#include "lab/instrument/drive.h"

#include "lab/protocol/protocol.h"

dea_status dea_drive_run(struct dea_context *ctx, const struct dea_protocol *protocol,
                         const struct dea_drive_options *options, struct dea_drive_report *out)
{
  (void)options;
  *out = (struct dea_drive_report){.largest_current_A = NAN};
  return dea_fail(ctx, DEA_E_UNSUPPORTED, "%s cannot be played: this version has no loop yet",
                  protocol->file);
}
