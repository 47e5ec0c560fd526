/* What the studio answers, whatever carries question and answer. */
#pragma once

#include "base/write_file.h"
#include "studio/studio.h"
#include "studio/studio_jobs.h"

#include <pthread.h>

enum { DEA_STUDIO_SECRET_BYTES = 18, DEA_STUDIO_SECRET_SIZE = 2 * DEA_STUDIO_SECRET_BYTES + 1 };

/* What all of its threads share. */
struct dea_studio {
  struct dea_context *ctx; // of the thread that serves
  struct dea_studio_options options;
  char *path;                       // of the current folder, without links
  int folder;                       // that, open
  char scratch[DEA_TEMPORARY_SIZE]; // a folder for files on the way
  unsigned scratch_count;           // names that were given there
  struct dea_studio_jobs *jobs;
  pthread_mutex_t write_lock;   // between looking at a file and writing it
  pthread_mutex_t results_lock; // HDF5 takes one thread at a time
  /* Of the server: */
  struct mg_context *server;
  char doorway[DEA_TEMPORARY_SIZE + 16];
  char secret[DEA_STUDIO_SECRET_SIZE]; // first part of all paths
  char address[DEA_STUDIO_SECRET_SIZE + 64];
  char hosts[2][32], origins[2][48]; // what a browser may say that it has come to, and from
};

struct dea_studio_route;

/* A question and its answer. */
struct dea_studio_exchange {
  struct dea_context *ctx;
  struct dea_studio *studio;
  const struct dea_studio_route *route; // that it takes; dea_studio_answer finds it
  const char *method;                   // "GET", "PUT", "POST"
  const char *path;                     // behind the secret, "design"
  json_t *arguments;                    // {name: [text]} of the address
  const char *body;                     // [body_length], and a zero
  size_t body_length;
  /* The answer: */
  int status; // of HTTP
  const char *type;
  struct dea_text reply; // its context is set
  bool foreign;          // a file of the folder: what it brings must not speak for the user
};

/* Longest body that is taken. */
enum { DEA_STUDIO_BODY_MAX = 8 << 20 };

/* Fills the answer; an error too is one. */
void dea_studio_answer(struct dea_studio_exchange *w);
