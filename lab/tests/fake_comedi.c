/* A library that looks like comedilib: a board of 16 bits with ranges of 10 and 5 V, whose file is
 * one end of a pair of sockets. What is written is played, and comes back as what is measured,
 * whenever the library is called for the state of its buffers. */
#define _POSIX_C_SOURCE 200809L // sockets
#include "fake_library.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#define API __attribute__((visibility("default")))
enum { AI = 0, AO = 1, FROM_PHYSICAL = 1 };

struct command { // as comedi_cmd
  unsigned subdevice, flags, sources[10], *channels, channel_count;
  short unsigned *data;
  unsigned data_length;
};
struct span {
  double min, max;
  unsigned unit;
};
struct polynomial {
  double coefficients[4], origin;
  unsigned order;
};

static int ends[2], running[2];
static unsigned channels[16];
static size_t channel_count;
static struct span spans[] = {{-10, 10, 0}, {-5, 5, 0}};

/* Logs a call; whether it is to fail. */
static int call(const char *name, const char *format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  bool fails = fake_fails(name, format, arguments);
  va_end(arguments);
  return fails ? -1 : 0;
}

static double volts_of(unsigned number, const struct span *span)
{
  return span->min + (span->max - span->min) * number / 65535;
}

static unsigned number_of(double volts, const struct span *span)
{
  double number = floor((volts - span->min) / (span->max - span->min) * 65535 + 0.5);
  return number < 0 ? 0 : number > 65535 ? 65535 : (unsigned)number;
}

/* Plays what was written, up to 11 samples at a time, and measures it. */
static void pump(void)
{
  uint16_t number;
  for (int i = 0; running[AO] && i < 11; i++) {
    if (recv(ends[1], &number, sizeof number, MSG_DONTWAIT) != sizeof number) {
      return;
    }
    fake.level_V = volts_of(number, &spans[0]);
    if (fake.read < FAKE_DAQ_SAMPLES) {
      fake.played[fake.read++] = fake.level_V;
    }
    for (size_t k = 0; running[AI] && k < channel_count; k++) {
      uint16_t measured =
          (uint16_t)number_of((double)(k + 1) * fake.level_V, &spans[channels[k] >> 16 & 0xff]);
      (void)!send(ends[1], &measured, sizeof measured, MSG_NOSIGNAL);
    }
    if (fake.dry_after > 0 && fake.read >= (size_t)fake.dry_after) {
      running[AO] = 0;
      shutdown(ends[1], SHUT_RD); // from here on writing is EPIPE
    }
  }
}

API void *comedi_open(const char *file);
void *comedi_open(const char *file)
{
  if (call("open", "%s", file) != 0 || socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
    return NULL;
  }
  fake.tasks++;
  running[AI] = running[AO] = 0;
  return &fake;
}

API int comedi_close(void *device);
int comedi_close(void *device)
{
  (void)device;
  fake.tasks--;
  close(ends[0]);
  close(ends[1]);
  return call("close", "%s", "");
}

API int comedi_loglevel(int level);
int comedi_loglevel(int level)
{
  return level;
}

API int comedi_errno(void);
int comedi_errno(void)
{
  return fake.code;
}

API const char *comedi_strerror(int number);
const char *comedi_strerror(int number)
{
  return strerror(number);
}

API int comedi_fileno(void *device);
int comedi_fileno(void *device)
{
  (void)device;
  return ends[0];
}

API int comedi_find_subdevice_by_type(void *device, int type, unsigned first);
int comedi_find_subdevice_by_type(void *device, int type, unsigned first)
{
  (void)device, (void)first;
  return call("find_subdevice", "%d", type) != 0 ? -1 : type == 2 ? AO : AI;
}

API int comedi_get_subdevice_flags(void *device, unsigned subdevice);
int comedi_get_subdevice_flags(void *device, unsigned subdevice)
{
  (void)device, (void)subdevice;
  return fake.queue == 1 ? 0x2000 : 0; // needs a calibration
}

API int comedi_get_n_channels(void *device, unsigned subdevice);
int comedi_get_n_channels(void *device, unsigned subdevice)
{
  (void)device;
  return subdevice == AO ? 2 : 16;
}

API unsigned comedi_get_maxdata(void *device, unsigned subdevice, unsigned channel);
unsigned comedi_get_maxdata(void *device, unsigned subdevice, unsigned channel)
{
  (void)device, (void)subdevice, (void)channel;
  return 65535;
}

API int comedi_find_range(void *device, unsigned subdevice, unsigned channel, unsigned unit,
                          double min, double max);
int comedi_find_range(void *device, unsigned subdevice, unsigned channel, unsigned unit, double min,
                      double max)
{
  (void)device, (void)subdevice, (void)channel, (void)unit, (void)min;
  return max <= 5 ? 1 : max <= 10 ? 0 : -1;
}

API struct span *comedi_get_range(void *device, unsigned subdevice, unsigned channel,
                                  unsigned range);
struct span *comedi_get_range(void *device, unsigned subdevice, unsigned channel, unsigned range)
{
  (void)device, (void)subdevice, (void)channel;
  return &spans[range];
}

API char *comedi_get_default_calibration_path(void *device);
char *comedi_get_default_calibration_path(void *device)
{
  (void)device;
  return calloc(1, 8);
}

API void *comedi_parse_calibration_file(const char *file);
void *comedi_parse_calibration_file(const char *file)
{
  (void)file;
  return NULL; // there is none
}

API void comedi_cleanup_calibration(void *calibration);
void comedi_cleanup_calibration(void *calibration)
{
  (void)calibration;
}

API int comedi_get_softcal_converter(unsigned subdevice, unsigned channel, unsigned range,
                                     int direction, const void *calibration,
                                     struct polynomial *out);
int comedi_get_softcal_converter(unsigned subdevice, unsigned channel, unsigned range,
                                 int direction, const void *calibration, struct polynomial *out)
{
  (void)subdevice, (void)channel, (void)range, (void)direction, (void)calibration, (void)out;
  return -1;
}

API int comedi_get_hardcal_converter(void *device, unsigned subdevice, unsigned channel,
                                     unsigned range, int direction, struct polynomial *out);
int comedi_get_hardcal_converter(void *device, unsigned subdevice, unsigned channel, unsigned range,
                                 int direction, struct polynomial *out)
{
  const struct span *span = &spans[range];
  double numbers_of_volt = 65535 / (span->max - span->min);
  (void)device, (void)subdevice, (void)channel;
  *out = direction == FROM_PHYSICAL
             ? (struct polynomial){.coefficients = {fake.offset, numbers_of_volt},
                                   .origin = span->min,
                                   .order = 1}
             : (struct polynomial){.coefficients = {span->min, 1 / numbers_of_volt}, .order = 1};
  return 0;
}

static double apply(const struct polynomial *p, double at)
{
  return p->coefficients[0] + p->coefficients[1] * (at - p->origin);
}

API double comedi_to_physical(unsigned data, const struct polynomial *converter);
double comedi_to_physical(unsigned data, const struct polynomial *converter)
{
  return apply(converter, data);
}

API int comedi_data_write(void *device, unsigned subdevice, unsigned channel, unsigned range,
                          unsigned reference, unsigned data);
int comedi_data_write(void *device, unsigned subdevice, unsigned channel, unsigned range,
                      unsigned reference, unsigned data)
{
  (void)device, (void)reference;
  if (call("data_write", "%u %u %u", subdevice, channel, data) != 0) {
    return -1;
  }
  fake.level_V = volts_of(data, &spans[range]);
  return 1;
}

API int comedi_get_cmd_generic_timed(void *device, unsigned subdevice, struct command *command,
                                     unsigned count, unsigned period_ns);
int comedi_get_cmd_generic_timed(void *device, unsigned subdevice, struct command *command,
                                 unsigned count, unsigned period_ns)
{
  (void)device;
  memset(command, 0, sizeof *command);
  command->subdevice = subdevice;
  command->channel_count = count;
  command->sources[3] = period_ns;
  return call("get_cmd", "%u", subdevice);
}

API int comedi_command_test(void *device, struct command *command);
int comedi_command_test(void *device, struct command *command)
{
  (void)device;
  if (strcmp(fake.fails, "command_test") == 0) {
    return 3;
  }
  unsigned period_ns = fake.rate_factor > 0 ? (unsigned)(1e6 / fake.rate_factor) : 1000000;
  int result = command->sources[3] == period_ns ? 0 : 4;
  command->sources[3] = period_ns;
  return result;
}

API int comedi_command(void *device, struct command *command);
int comedi_command(void *device, struct command *command)
{
  (void)device;
  if (call("command", "%s start %u stop %u period %u ns channels %u: %x", // and the first
           command->subdevice == AO ? "output" : "inputs", command->sources[0], command->sources[8],
           command->sources[3], command->channel_count, command->channels[0]) != 0) {
    return -1;
  }
  if (command->subdevice == AI) {
    channel_count = command->channel_count;
    memcpy(channels, command->channels, channel_count * sizeof *channels);
  }
  return 0;
}

API int comedi_internal_trigger(void *device, unsigned subdevice, unsigned number);
int comedi_internal_trigger(void *device, unsigned subdevice, unsigned number)
{
  (void)device, (void)number;
  if (call("trigger", "%s", subdevice == AO ? "output" : "inputs") != 0) {
    return -1;
  }
  running[subdevice] = 1;
  fake.running = running[AO];
  return 0;
}

API int comedi_cancel(void *device, unsigned subdevice);
int comedi_cancel(void *device, unsigned subdevice)
{
  (void)device;
  running[subdevice] = 0;
  return call("cancel", "%s", subdevice == AO ? "output" : "inputs");
}

API int comedi_poll(void *device, unsigned subdevice);
int comedi_poll(void *device, unsigned subdevice)
{
  (void)device, (void)subdevice;
  if (strcmp(fake.fails, "unplug") == 0) {
    shutdown(ends[1], SHUT_RDWR);
  }
  pump();
  return 0;
}

API int comedi_get_buffer_contents(void *device, unsigned subdevice);
int comedi_get_buffer_contents(void *device, unsigned subdevice)
{
  (void)device, (void)subdevice;
  pump();
  return call("contents", "%s", "");
}
