/* The studio on the network, which is this computer: what is let in, and how it is answered. */
#define _GNU_SOURCE // getrandom, mkdtemp, realpath
#include "base/clock.h"
#include "base/write_file.h"
#include "studio/studio_routes.h"

#include <civetweb.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

enum { THREADS = 40 };

static const double body_patience_s = 3; // for all of a request's body

// What is let in ----------------------------------------------------------------------------------

/* Whether both are the same, in a time that does not tell where they differ. */
static bool is_secret(const struct dea_studio *studio, const char *text)
{
  unsigned char differs = 0;
  if (strlen(text) < DEA_STUDIO_SECRET_SIZE - 1) {
    return false;
  }
  for (size_t i = 0; i < DEA_STUDIO_SECRET_SIZE - 1; i++) {
    differs |= (unsigned char)(text[i] ^ studio->secret[i]);
  }
  return differs == 0 && text[DEA_STUDIO_SECRET_SIZE - 1] == '/';
}

static bool is_one_of(const char *text, const char *first, const char *second)
{
  return strcmp(text, first) == 0 || strcmp(text, second) == 0;
}

/* Status of HTTP for a request that is not let in, 0 for others. */
static int refuse(const struct dea_studio *studio, const struct mg_connection *connection,
                  const struct mg_request_info *info)
{
  const char *host = mg_get_header(connection, "Host"),
             *origin = mg_get_header(connection, "Origin");
  const bool reads = strcmp(info->request_method, "GET") == 0,
             writes = is_one_of(info->request_method, "PUT", "POST");
  if (host == NULL || !is_one_of(host, studio->hosts[0], studio->hosts[1])) {
    return 421; // a name of another site that leads here
  }
  if (origin != NULL && !is_one_of(origin, studio->origins[0], studio->origins[1])) {
    return 403;
  }
  if (info->local_uri == NULL || info->local_uri[0] != '/' ||
      !is_secret(studio, info->local_uri + 1)) {
    return 403;
  }
  if (!reads && !writes) {
    return 405;
  }
  if (writes && info->content_length < 0) {
    return 411;
  }
  return info->content_length > DEA_STUDIO_BODY_MAX ? 413 : 0;
}

// Answers -----------------------------------------------------------------------------------------

/* The page brings all that it uses; a file of the folder may be a page of another program, so it
 * has an origin of its own and cannot speak for the user. */
static const char own_policy[] = "default-src 'none'; script-src 'self'; style-src 'self' "
                                 "'unsafe-inline'; img-src 'self' data:; connect-src 'self'; "
                                 "frame-src 'self'; base-uri 'none'; form-action 'none'; "
                                 "frame-ancestors 'none'",
                  foreign_policy[] = "sandbox allow-scripts; default-src 'none'; script-src "
                                     "'unsafe-inline'; style-src "
                                     "'unsafe-inline'; img-src data:; base-uri 'none'; form-action "
                                     "'none'; frame-ancestors 'self'";

static void send_head(struct mg_connection *connection, int status, const char *type, size_t length,
                      const char *policy)
{
  mg_disable_connection_keep_alive(connection); // nor is a body that was refused waited for
  mg_printf(connection,
            "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Security-Policy: %s\r\n"
            "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
            "Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n"
            "Cross-Origin-Opener-Policy: same-origin\r\n"
            "Connection: close\r\nContent-Length: %zu\r\n\r\n",
            status, mg_get_response_code_text(connection, status), type, policy, length);
}

static int send_refusal(struct mg_connection *connection, int status)
{
  static const char text[] = "refused\n";
  send_head(connection, status, "text/plain", sizeof text - 1, own_policy);
  mg_write(connection, text, sizeof text - 1);
  return status;
}

/* Arguments of an address: {name: [text]}. */
static json_t *read_arguments(const struct mg_request_info *info)
{
  enum { FIELDS_MAX = 24 };
  json_t *arguments = json_object();
  struct mg_header fields[FIELDS_MAX];
  char *query = strdup(info->query_string != NULL ? info->query_string : "");
  const int count =
      query != NULL && query[0] != '\0' ? mg_split_form_urlencoded(query, fields, FIELDS_MAX) : 0;
  for (int i = 0; i < count; i++) {
    json_t *list = json_object_get(arguments, fields[i].name);
    if (list == NULL) {
      list = json_array();
      json_object_set_new(arguments, fields[i].name, list);
    }
    json_array_append_new(list, json_string(fields[i].value != NULL ? fields[i].value : ""));
  }
  free(query);
  return arguments;
}

/* All of a body, in time. */
static bool read_body(struct dea_context *ctx, struct mg_connection *connection, size_t length,
                      char **out)
{
  const double began_s = dea_clock_s();
  char *body = dea_alloc(ctx, length + 1, 1);
  size_t used = 0;
  while (body != NULL && used < length && dea_clock_s() - began_s < body_patience_s) {
    const int got = mg_read(connection, body + used, length - used);
    if (got <= 0) {
      break;
    }
    used += (size_t)got;
  }
  *out = body;
  return body != NULL && used == length;
}

static void *work(void *user)
{
  dea_studio_answer(user);
  return NULL;
}

/* Answers on a thread of its own: those of civetweb have stacks of 100 kB, which is not enough to
 * read results. */
static void answer_in_worker(struct dea_studio_exchange *exchange)
{
  enum { STACK = 8 << 20 };
  pthread_t thread;
  pthread_attr_t how;
  if (pthread_attr_init(&how) != 0) {
    return;
  }
  if (pthread_attr_setstacksize(&how, STACK) == 0 &&
      pthread_create(&thread, &how, work, exchange) == 0) {
    pthread_join(thread, NULL);
  }
  pthread_attr_destroy(&how);
}

static int answer(struct dea_studio *studio, struct mg_connection *connection,
                  const struct mg_request_info *info)
{
  struct dea_context *ctx;
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return send_refusal(connection, 503);
  }
  char *body = NULL;
  const size_t length = info->content_length > 0 ? (size_t)info->content_length : 0;
  struct dea_studio_exchange e = {.ctx = ctx,
                                  .studio = studio,
                                  .method = info->request_method,
                                  .path = info->local_uri + 1 + DEA_STUDIO_SECRET_SIZE,
                                  .body_length = length,
                                  .status = 500,
                                  .type = "text/plain",
                                  .reply = {.ctx = ctx}};
  if (read_body(ctx, connection, length, &body)) {
    e.body = body;
    e.arguments = read_arguments(info);
    answer_in_worker(&e);
    json_decref(e.arguments);
    send_head(connection, e.status, e.type, e.reply.length,
              e.foreign ? foreign_policy : own_policy);
    mg_write(connection, e.reply.data, e.reply.length);
  } else {
    e.status = send_refusal(connection, 408);
  }
  dea_text_free(&e.reply);
  dea_free(ctx, body);
  dea_context_destroy(ctx);
  return e.status;
}

static int on_request(struct mg_connection *connection)
{
  struct dea_studio *studio = mg_get_user_context_data(connection);
  const struct mg_request_info *info = mg_get_request_info(connection);
  const int refused = refuse(studio, connection, info);
  if (refused != 0) {
    return send_refusal(connection, refused);
  }
  return answer(studio, connection, info);
}

static int on_message(const struct mg_connection *connection, const char *message)
{
  (void)connection;
  (void)message;
  return 1; // the library is quiet
}

// Beginning and end -------------------------------------------------------------------------------

static dea_status create_secret(struct dea_studio *studio)
{
  unsigned char bytes[DEA_STUDIO_SECRET_BYTES];
  if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes) {
    return dea_fail(studio->ctx, DEA_E_IO, "no random numbers: %s", strerror(errno));
  }
  for (size_t i = 0; i < sizeof bytes; i++) {
    snprintf(studio->secret + 2 * i, 3, "%02x", bytes[i]);
  }
  return DEA_OK;
}

static dea_status listen_at(struct dea_studio *studio)
{
  char where[32], threads[8];
  snprintf(where, sizeof where, "127.0.0.1:%d", studio->options.port);
  snprintf(threads, sizeof threads, "%d", THREADS);
  const char *options[] = {"listening_ports",
                           where,
                           "num_threads",
                           threads,
                           "request_timeout_ms",
                           "3000",
                           "enable_keep_alive",
                           "no",
                           "access_control_allow_origin",
                           "",
                           "access_control_allow_methods",
                           "",
                           "tcp_nodelay",
                           "1",
                           NULL};
  const struct mg_callbacks callbacks = {.begin_request = on_request, .log_message = on_message};
  struct mg_server_port port = {.port = 0};
  mg_init_library(0);
  studio->server = mg_start(&callbacks, studio, options);
  if (studio->server == NULL) {
    mg_exit_library();
    return dea_fail(studio->ctx, DEA_E_IO,
                    "cannot listen at %s; is another program there? (--port 0 takes a free one)",
                    where);
  }
  mg_get_server_ports(studio->server, 1, &port);
  snprintf(studio->hosts[0], sizeof studio->hosts[0], "127.0.0.1:%d", port.port);
  snprintf(studio->hosts[1], sizeof studio->hosts[1], "localhost:%d", port.port);
  for (size_t i = 0; i < 2; i++) {
    snprintf(studio->origins[i], sizeof studio->origins[i], "http://%s", studio->hosts[i]);
  }
  snprintf(studio->address, sizeof studio->address, "%s/%s/", studio->origins[0], studio->secret);
  return DEA_OK;
}

static dea_status open_listener(struct dea_studio *studio)
{
  char page[512];
  snprintf(studio->doorway, sizeof studio->doorway, "%s/studio.html", studio->scratch);
  const int length =
      snprintf(page, sizeof page,
               "<!DOCTYPE html><meta charset=\"utf-8\"><title>dea studio</title>"
               "<meta http-equiv=\"refresh\" content=\"0;url=%s\"><a href=\"%s\">dea studio</a>\n",
               studio->address, studio->address);
  return dea_file_write(studio->ctx, studio->doorway, page, (size_t)length);
}

static dea_status begin(struct dea_studio *studio)
{
  struct dea_context *ctx = studio->ctx;
  studio->path = realpath(".", NULL);
  studio->folder = open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (studio->path == NULL || studio->folder < 0) {
    return dea_fail(ctx, DEA_E_IO, "cannot open the folder: %s", strerror(errno));
  }
  DEA_TRY(ctx, create_secret(studio));
  DEA_TRY(ctx, dea_folder_create_temporary(ctx, "studio", studio->scratch));
  studio->jobs = dea_studio_jobs_create(ctx, studio->options.program);
  if (studio->jobs == NULL) {
    return dea_context_status(ctx);
  }
  DEA_TRY(ctx, listen_at(studio));
  return open_listener(studio);
}

dea_status dea_studio_start(struct dea_context *ctx, const struct dea_studio_options *options,
                            struct dea_studio **out)
{
  struct dea_studio *studio = dea_alloc(ctx, 1, sizeof *studio);
  *out = NULL;
  DEA_TRY_MEMORY(studio != NULL);
  *studio = (struct dea_studio){.ctx = ctx, .options = *options, .folder = -1};
  pthread_mutex_init(&studio->write_lock, NULL);
  pthread_mutex_init(&studio->results_lock, NULL);
  DEA_TRY_ELSE(ctx, begin(studio), dea_studio_stop(studio));
  *out = studio;
  return DEA_OK;
}

const char *dea_studio_address(const struct dea_studio *studio)
{
  return studio->address;
}

const char *dea_studio_doorway(const struct dea_studio *studio)
{
  return studio->doorway;
}

void dea_studio_serve(struct dea_studio *studio)
{
  while (!dea_interrupted(studio->ctx)) {
    dea_studio_jobs_turn(studio->jobs);
  }
}

void dea_studio_stop(struct dea_studio *studio)
{
  if (studio == NULL) {
    return;
  }
  struct dea_context *ctx = studio->ctx;
  if (studio->server != NULL) {
    mg_stop(studio->server);
    mg_exit_library();
  }
  dea_studio_jobs_destroy(ctx, studio->jobs);
  dea_folder_remove_temporary(studio->scratch);
  if (studio->folder >= 0) {
    close(studio->folder);
  }
  pthread_mutex_destroy(&studio->write_lock);
  pthread_mutex_destroy(&studio->results_lock);
  free(studio->path);
  dea_free(ctx, studio);
}
