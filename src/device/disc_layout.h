/* The layout of a disc in a round frame. */
#ifndef DEA_DEVICE_DISC_LAYOUT_H
#define DEA_DEVICE_DISC_LAYOUT_H

#include "device/device.h"

/* Makes the layout of a device whose other members are filled: regions "film", "electrode",
 * "fibres"; plies of film, electrodes with stiffness, glue, and fibres; the frame as a support. */
dea_status dea_disc_layout_make(struct dea_context *ctx, struct dea_device *device);

#endif
