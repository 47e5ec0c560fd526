/* What the studio answers, whatever carries question and answer. */
#pragma once

#include "studio/studio.h"
#include "studio/studio_jobs.h"

#include <pthread.h>

/* What all of its threads share. */
struct dea_studio_folder {
  const struct dea_studio_options *options; // lent
  const char *path;                         // of the folder, without links; lent
  const char *scratch;                      // a folder for files on the way; lent
  int folder;                               // open
  struct dea_studio_jobs *jobs;
  pthread_mutex_t write_lock;   // between looking at a file and writing it
  pthread_mutex_t results_lock; // HDF5 takes one thread at a time
  unsigned scratch_count;       // names that were given
};

struct dea_studio_request {
  const char *method; // "GET", "PUT", "POST"
  const char *path;   // behind the secret, "design"
  json_t *arguments;  // {name: [text]} of the address
  const char *body;   // [body_length], and a zero
  size_t body_length;
};

struct dea_studio_reply {
  int status; // of HTTP
  const char *type;
  struct dea_text body;
  bool foreign; // a file of the folder: what it brings must not speak for the user
};

/* Longest body that is taken. */
enum { DEA_STUDIO_BODY_MAX = 8 << 20 };

/* Fills a reply, whose body has its context set; an error too is one. */
void dea_studio_answer(struct dea_context *ctx, struct dea_studio_folder *workspace,
                       const struct dea_studio_request *request, struct dea_studio_reply *reply);
