/* What is used of comedilib, the library of Linux' drivers for DAQs: its functions, structures and
 * numbers as its reference publishes them, so that neither its header nor it are needed to build.
 */
#pragma once

#include "base/context.h"

enum {
  DEA_COMEDI_INPUT = 1, // types of subdevices
  DEA_COMEDI_OUTPUT = 2,
  DEA_COMEDI_SOFT_CALIBRATED = 0x2000, // flags of a subdevice
  DEA_COMEDI_LONG_SAMPLES = 0x10000000,
  DEA_COMEDI_TRIGGER_NONE = 0x01, // sources of triggers
  DEA_COMEDI_TRIGGER_INTERNAL = 0x80,
  DEA_COMEDI_WRITES = 0x40, // flag of a command
  DEA_COMEDI_VOLT = 0,
  DEA_COMEDI_TO_PHYSICAL = 0,
  DEA_COMEDI_FROM_PHYSICAL = 1,
};

/* A command: what is sampled, and what begins its start, its scans and their conversions. */
struct dea_comedi_command {
  unsigned subdevice, flags;
  unsigned start_source, start_argument;
  unsigned scan_source, scan_argument; // period [ns]
  unsigned convert_source, convert_argument;
  unsigned scan_end_source, scan_end_argument;
  unsigned stop_source, stop_argument;
  unsigned *channels, channel_count;
  short unsigned *data;
  unsigned data_length;
};

struct dea_comedi_span {
  double min, max;
  unsigned unit;
};

/* The sum of coefficients[i] (x - origin)^i up to i = order. */
struct dea_comedi_polynomial {
  double coefficients[4], origin;
  unsigned order;
};

// X(member, symbol, type, arguments)
#define DEA_COMEDI_FUNCTIONS(X)                                                                    \
  X(open, "comedi_open", void *, (const char *file))                                               \
  X(close, "comedi_close", int, (void *device))                                                    \
  X(loglevel, "comedi_loglevel", int, (int level))                                                 \
  X(error_number, "comedi_errno", int, (void))                                                     \
  X(strerror, "comedi_strerror", const char *, (int number))                                       \
  X(fileno, "comedi_fileno", int, (void *device))                                                  \
  X(find_subdevice_by_type, "comedi_find_subdevice_by_type", int,                                  \
    (void *device, int type, unsigned first))                                                      \
  X(get_subdevice_flags, "comedi_get_subdevice_flags", int, (void *device, unsigned subdevice))    \
  X(get_n_channels, "comedi_get_n_channels", int, (void *device, unsigned subdevice))              \
  X(get_maxdata, "comedi_get_maxdata", unsigned,                                                   \
    (void *device, unsigned subdevice, unsigned channel))                                          \
  X(find_range, "comedi_find_range", int,                                                          \
    (void *device, unsigned subdevice, unsigned channel, unsigned unit, double min, double max))   \
  X(get_range, "comedi_get_range", struct dea_comedi_span *,                                       \
    (void *device, unsigned subdevice, unsigned channel, unsigned range))                          \
  X(get_default_calibration_path, "comedi_get_default_calibration_path", char *, (void *device))   \
  X(parse_calibration_file, "comedi_parse_calibration_file", void *, (const char *file))           \
  X(cleanup_calibration, "comedi_cleanup_calibration", void, (void *calibration))                  \
  X(get_softcal_converter, "comedi_get_softcal_converter", int,                                    \
    (unsigned subdevice, unsigned channel, unsigned range, int direction, const void *calibration, \
     struct dea_comedi_polynomial *out))                                                           \
  X(get_hardcal_converter, "comedi_get_hardcal_converter", int,                                    \
    (void *device, unsigned subdevice, unsigned channel, unsigned range, int direction,            \
     struct dea_comedi_polynomial *out))                                                           \
  X(to_physical, "comedi_to_physical", double,                                                     \
    (unsigned data, const struct dea_comedi_polynomial *converter))                                \
  X(data_write, "comedi_data_write", int,                                                          \
    (void *device, unsigned subdevice, unsigned channel, unsigned range, unsigned reference,       \
     unsigned data))                                                                               \
  X(get_cmd_generic_timed, "comedi_get_cmd_generic_timed", int,                                    \
    (void *device, unsigned subdevice, struct dea_comedi_command *command, unsigned channels,      \
     unsigned period_ns))                                                                          \
  X(command_test, "comedi_command_test", int, (void *device, struct dea_comedi_command *command))  \
  X(command, "comedi_command", int, (void *device, struct dea_comedi_command *command))            \
  X(internal_trigger, "comedi_internal_trigger", int,                                              \
    (void *device, unsigned subdevice, unsigned number))                                           \
  X(cancel, "comedi_cancel", int, (void *device, unsigned subdevice))                              \
  X(poll, "comedi_poll", int, (void *device, unsigned subdevice))                                  \
  X(get_buffer_contents, "comedi_get_buffer_contents", int, (void *device, unsigned subdevice))

struct dea_comedi_library {
#define DEA_COMEDI_MEMBER(name, symbol, type, arguments) type(*name) arguments;
  DEA_COMEDI_FUNCTIONS(DEA_COMEDI_MEMBER)
#undef DEA_COMEDI_MEMBER
};

/* DEA_E_UNSUPPORTED with advice. */
dea_status dea_comedi_open(struct dea_context *ctx, const char *file,
                           struct dea_comedi_library *out);
