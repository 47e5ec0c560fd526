#define _DEFAULT_SOURCE // cfmakeraw, the faster of the speeds, flock, major
#include "instrument/serial.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

static const double poll_s = 0.02;

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
  // as another program may have left it: a device that gives no CTS would be sent nothing, not even
  // 0 V; XOFF is a number like any other; a line whose parity is not looked at has none
  line.c_cflag &= ~(tcflag_t)(CSTOPB | PARENB | PARODD | CRTSCTS);
  line.c_iflag &= ~(tcflag_t)(IXOFF | IXANY | IGNPAR | INPCK);
  line.c_iflag |= (tcflag_t)(parity > 0 ? INPCK : 0); // a character that is wrong is read as 0
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

/* The process of a line of /proc/locks that is a lock of a file; 0: it is of another, or of a kind
 * that is not used here. "1: FLOCK  ADVISORY  WRITE 4711 00:15:3 0 EOF" */
static long holder_in(const char *text, const struct stat *file)
{
  char wanted[64];
  snprintf(wanted, sizeof wanted, " %02x:%02x:%ju ", major(file->st_dev), minor(file->st_dev),
           (uintmax_t)file->st_ino);
  const char *found = strstr(text, wanted);
  if (found == NULL || strstr(text, ": FLOCK ") == NULL) {
    return 0;
  }
  while (found > text && found[-1] != ' ') {
    found--;
  }
  return strtol(found, NULL, 10);
}

/* The process that has a line locked; 0: none, or the system does not say. */
static long holder_of(int descriptor)
{
  char text[256];
  long found = 0;
  struct stat s;
  FILE *locks = fstat(descriptor, &s) == 0 ? fopen("/proc/locks", "r") : NULL;
  while (locks != NULL && found == 0 && fgets(text, sizeof text, locks) != NULL) {
    found = holder_in(text, &s);
  }
  if (locks != NULL) {
    fclose(locks);
  }
  return found;
}

void dea_serial_holder_text(long holder, char out[DEA_SERIAL_HOLDER_SIZE])
{
  char path[64], name[32] = "";
  snprintf(path, sizeof path, "/proc/%ld/comm", holder);
  FILE *file = holder > 0 ? fopen(path, "r") : NULL;
  if (file != NULL && fgets(name, sizeof name, file) != NULL) {
    name[strcspn(name, "\n")] = '\0';
  }
  if (file != NULL) {
    fclose(file);
  }
  snprintf(out, DEA_SERIAL_HOLDER_SIZE, holder > 0 ? "process %ld%s%s%s" : "another program",
           holder, name[0] != '\0' ? " (" : "", name, name[0] != '\0' ? ")" : "");
}

/* Waits for its turn; 0, or EWOULDBLOCK: somebody else has it, and no turn was asked for. */
static int lock(int descriptor, struct dea_serial_turn *turn)
{
  double until_s = dea_clock_s() + (turn != NULL ? turn->wait_s : 0);
  while (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) {
      return 0; // a system without such locks
    }
    if (turn == NULL) {
      return EWOULDBLOCK;
    }
    turn->holder = holder_of(descriptor);
    // who may go beside one must not be kept out by a system that does not say who has it
    turn->beside = turn->program == 0 || (turn->holder != 0 && turn->holder != turn->program);
    if (!turn->beside || dea_clock_s() >= until_s) {
      return 0;
    }
    dea_clock_wait(poll_s);
  }
  if (turn != NULL) {
    turn->beside = false;
    turn->holder = 0;
  }
  return 0;
}

static dea_status open_line(struct dea_context *ctx, const char *device, int baud, int parity,
                            struct dea_serial_turn *turn, struct dea_socket *out)
{
  size_t i = 0;
  char holder[DEA_SERIAL_HOLDER_SIZE];
  while (i < sizeof speeds / sizeof speeds[0] && speeds[i].baud != baud) {
    i++;
  }
  if (i == sizeof speeds / sizeof speeds[0]) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "a serial line has no speed of %d baud; usual are 9600, 19200, 38400, 115200",
                    baud);
  }
  int descriptor = open(device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  int error = descriptor < 0 ? errno : 0;
  if (error == 0 && lock(descriptor, turn) != 0) {
    dea_serial_holder_text(holder_of(descriptor), holder);
    close(descriptor);
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is in use by %s: end that first", out->name, holder);
  }
  error = error == 0 ? set_up(descriptor, speeds[i].speed, parity) : error;
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

dea_status dea_serial_open_in_turn(struct dea_context *ctx, const char *what, const char *device,
                                   int baud, int parity, struct dea_serial_turn *turn,
                                   struct dea_socket *out)
{
  out->descriptor = -1;
  snprintf(out->name, sizeof out->name, "%.40s at %.250s", what, device);
  return open_line(ctx, device, baud, parity, turn, out);
}

dea_status dea_serial_open(struct dea_context *ctx, const char *what, const char *device, int baud,
                           int parity, struct dea_socket *out)
{
  return dea_serial_open_in_turn(ctx, what, device, baud, parity, NULL, out);
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
