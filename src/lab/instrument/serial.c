#define _DEFAULT_SOURCE // cfmakeraw, the faster of the speeds
#include "lab/instrument/serial.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

const char *const dea_serial_parities[] = {"none", "even", "odd", NULL};

static const struct {
  int baud;
  speed_t speed;
} speeds[] = {{1200, B1200},     {2400, B2400},     {4800, B4800},    {9600, B9600},
              {19200, B19200},   {38400, B38400},   {57600, B57600},  {115200, B115200},
              {230400, B230400}, {460800, B460800}, {921600, B921600}};

static int set_up(int descriptor, speed_t speed, int parity)
{
  struct termios line;
  if (tcgetattr(descriptor, &line) != 0) {
    return errno;
  }
  cfmakeraw(&line);
  line.c_cflag &= ~(tcflag_t)(CSTOPB | PARENB | PARODD);
  line.c_cflag |= (tcflag_t)(CLOCAL | CREAD) | (tcflag_t)(parity > 0 ? PARENB : 0) |
                  (tcflag_t)(parity == 2 ? PARODD : 0);
  line.c_cc[VMIN] = 1; // nothing to read is an error, not an end
  line.c_cc[VTIME] = 0;
  if (cfsetispeed(&line, speed) != 0 || cfsetospeed(&line, speed) != 0 ||
      tcsetattr(descriptor, TCSANOW, &line) != 0 || tcflush(descriptor, TCIOFLUSH) != 0) {
    return errno;
  }
  return 0;
}

dea_status dea_serial_open(struct dea_context *ctx, const char *what, const char *device, int baud,
                           int parity, struct dea_socket *out)
{
  size_t i = 0;
  out->descriptor = -1;
  snprintf(out->name, sizeof out->name, "%.40s at %.250s", what, device);
  while (i < sizeof speeds / sizeof speeds[0] && speeds[i].baud != baud) {
    i++;
  }
  if (i == sizeof speeds / sizeof speeds[0]) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "a serial line has no speed of %d baud; usual are 9600, 19200, 38400, 115200",
                    baud);
  }
  int descriptor = open(device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  int error = descriptor < 0 ? errno : set_up(descriptor, speeds[i].speed, parity);
  if (error == 0) {
    out->descriptor = descriptor;
    return DEA_OK;
  }
  if (descriptor >= 0) {
    close(descriptor);
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT, "there is no connection to %s: %s; %s", out->name,
                  error == ENOTTY ? "it is no serial line" : strerror(error),
                  error == EACCES ? "be a member of the group that owns it (dialout)"
                                  : "look at its cable and at the device's name in /dev");
}

void dea_serial_mark(const struct dea_socket *line, char *out, size_t size)
{
  struct stat s;
  out[0] = '\0';
  if (line->descriptor >= 0 && fstat(line->descriptor, &s) == 0) {
    snprintf(out, size, "line %ju %ju %ju %jd.%09ld", (uintmax_t)s.st_dev, (uintmax_t)s.st_ino,
             (uintmax_t)s.st_rdev, (intmax_t)s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
  }
}
