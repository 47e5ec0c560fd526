#define _GNU_SOURCE // sockets, poll, MSG_NOSIGNAL, NI_MAXHOST
#include "instrument/socket.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static const char *const advice =
    "look at its power, its cable, its address, and whether another program holds it";

/* 1: ready, 0: not within the time, -1: a signal came. */
static int wait_for(int descriptor, short events, double timeout_s)
{
  struct pollfd entry = {.fd = descriptor, .events = events};
  double limited = timeout_s > 0 ? timeout_s < 3600 ? timeout_s : 3600 : 0;
  int ready = poll(&entry, 1, (int)(1000 * limited + 0.999));
  return ready > 0 ? 1 : ready;
}

/* Connects to one address; 0 or the error. */
static int connect_to(const struct addrinfo *address, double until_s, int *out)
{
  int descriptor = socket(address->ai_family, address->ai_socktype, address->ai_protocol);
  if (descriptor < 0) {
    return errno;
  }
  int error = 0, on = 1;
  int flags = fcntl(descriptor, F_GETFL);
  if (flags < 0 || fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) < 0 ||
      fcntl(descriptor, F_SETFD, FD_CLOEXEC) < 0) {
    error = errno;
  } else if (connect(descriptor, address->ai_addr, address->ai_addrlen) != 0) {
    error = errno;
    if (error == EINPROGRESS) {
      socklen_t size = sizeof error;
      int ready = wait_for(descriptor, POLLOUT, until_s - dea_clock_s());
      if (ready != 1) {
        error = ready == 0 ? ETIMEDOUT : EINTR;
      } else if (getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size) != 0) {
        error = errno;
      }
    }
  }
  if (error != 0) {
    close(descriptor);
    return error;
  }
  // Commands are small and wait for their answer; a failure only makes them slower.
  (void)setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  *out = descriptor;
  return 0;
}

dea_status dea_socket_connect(struct dea_context *ctx, const char *what, const char *host, int port,
                              double timeout_s, struct dea_socket *out)
{
  const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
  struct addrinfo *found = NULL;
  char service[16];
  out->descriptor = -1;
  out->host[0] = '\0';
  snprintf(service, sizeof service, "%d", port);
  snprintf(out->name, sizeof out->name, "%.40s at %.250s, port %d", what, host, port);
  int unknown = getaddrinfo(host, service, &hints, &found);
  if (unknown != 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "the address of %s is not known (%s); look at its name",
                    out->name, gai_strerror(unknown));
  }
  double until_s = dea_clock_s() + timeout_s;
  int error = ETIMEDOUT;
  for (const struct addrinfo *a = found; a != NULL && out->descriptor < 0; a = a->ai_next) {
    error = connect_to(a, until_s, &out->descriptor);
    if (out->descriptor >= 0 && getnameinfo(a->ai_addr, a->ai_addrlen, out->host, sizeof out->host,
                                            NULL, 0, NI_NUMERICHOST) != 0) {
      out->host[0] = '\0';
    }
  }
  freeaddrinfo(found);
  if (out->descriptor < 0) {
    return dea_fail(ctx, error == EINTR ? DEA_E_INTERRUPTED : DEA_E_INSTRUMENT,
                    "there is no connection to %s: %s; %s", out->name, strerror(error), advice);
  }
  return DEA_OK;
}

dea_status dea_socket_read(struct dea_context *ctx, const struct dea_socket *connection,
                           double timeout_s, void *bytes, size_t capacity, size_t *length)
{
  *length = 0;
  if (capacity == 0 || wait_for(connection->descriptor, POLLIN, timeout_s) != 1) {
    return DEA_OK;
  }
  ssize_t got = read(connection->descriptor, bytes, capacity);
  if (got > 0) {
    *length = (size_t)got;
    return DEA_OK;
  }
  if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
    return DEA_OK;
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT, "the connection to %s was lost: %s; %s", connection->name,
                  got == 0 ? "it closed it" : strerror(errno), advice);
}

/* Of a socket without SIGPIPE; a serial line (serial.h) knows none. */
static ssize_t send_some(int descriptor, const void *bytes, size_t length)
{
  ssize_t sent = send(descriptor, bytes, length, MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent < 0 && errno == ENOTSOCK ? write(descriptor, bytes, length) : sent;
}

dea_status dea_socket_write(struct dea_context *ctx, const struct dea_socket *connection,
                            double timeout_s, const void *bytes, size_t length)
{
  const char *at = bytes;
  double until_s = dea_clock_s() + timeout_s;
  while (length > 0) {
    ssize_t sent = send_some(connection->descriptor, at, length);
    if (sent >= 0) {
      at += sent;
      length -= (size_t)sent;
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      double left_s = until_s - dea_clock_s();
      if (left_s <= 0) {
        return dea_fail(ctx, DEA_E_INSTRUMENT, "%s takes no more commands; %s", connection->name,
                        advice);
      }
      (void)wait_for(connection->descriptor, POLLOUT, left_s);
    } else if (errno != EINTR) {
      return dea_fail(ctx, DEA_E_INSTRUMENT, "the connection to %s was lost: %s; %s",
                      connection->name, strerror(errno), advice);
    }
  }
  return DEA_OK;
}

void dea_socket_write_if_possible(const struct dea_socket *connection, const void *bytes,
                                  size_t length)
{
  if (connection->descriptor >= 0) {
    (void)!send_some(connection->descriptor, bytes, length);
  }
}

bool dea_socket_is_lost(const struct dea_socket *connection)
{
  struct pollfd entry = {.fd = connection->descriptor};
  return connection->descriptor < 0 ||
         (poll(&entry, 1, 0) > 0 && (entry.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0);
}

bool dea_socket_claim(const struct dea_socket *connection, int *claim)
{
  struct sockaddr_storage peer;
  socklen_t size = sizeof peer;
  struct sockaddr_un name = {.sun_family = AF_UNIX}; // without a file: its name begins with NUL
  char host[NI_MAXHOST], port[NI_MAXSERV];
  *claim = -1;
  if (getpeername(connection->descriptor, (struct sockaddr *)&peer, &size) != 0 ||
      getnameinfo((struct sockaddr *)&peer, size, host, sizeof host, port, sizeof port,
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return false;
  }
  int length =
      snprintf(name.sun_path + 1, sizeof name.sun_path - 1, "dea supply %.60s %.8s", host, port);
  socklen_t used = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length);
  int made = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (made < 0 || bind(made, (struct sockaddr *)&name, used) != 0) {
    if (made >= 0) {
      close(made);
    }
    return false;
  }
  *claim = made;
  return true;
}

void dea_socket_close(struct dea_socket *connection)
{
  if (connection->descriptor >= 0) {
    close(connection->descriptor);
    connection->descriptor = -1;
  }
}
