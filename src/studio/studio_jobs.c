#define _GNU_SOURCE // memfd_create, ptsname_r, environ
#include "studio/studio_jobs.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

// Command lines -----------------------------------------------------------------------------------

void dea_studio_line_add(struct dea_studio_line *line, const char *argument)
{
  const size_t size = strlen(argument) + 1;
  if (line->count + 3 > DEA_STUDIO_ARGUMENTS || size > sizeof line->text - line->length) {
    line->full = true;
    return;
  }
  memcpy(line->text + line->length, argument, size);
  line->length += size;
  line->count++;
}

void dea_studio_line_show(const struct dea_studio_line *line, struct dea_text *out)
{
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
                              "_-./=,:+@%";
  dea_text_add(out, "dea");
  for (size_t at = 0; at < line->length; at += strlen(line->text + at) + 1) {
    const char *word = line->text + at;
    if (word[0] != '\0' && word[strspn(word, plain)] == '\0') {
      dea_text_add(out, " %s", word);
      continue;
    }
    dea_text_add(out, " '");
    for (const char *c = word; *c != '\0'; c++) {
      dea_text_add(out, "%s%c", *c == '\'' ? "'\\'" : "", *c);
    }
    dea_text_add(out, "'");
  }
}

// Processes ---------------------------------------------------------------------------------------

/* Starts the command, in a group of its own; out, err: what it writes to. It dies with the thread
 * that calls this. */
static pid_t start(const char *program, const struct dea_studio_line *line, int out, int err)
{
  const char *argv[DEA_STUDIO_ARGUMENTS] = {program};
  size_t count = 1;
  for (size_t at = 0; at < line->length; at += strlen(line->text + at) + 1) {
    argv[count++] = line->text + at;
  }
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const pid_t parent = getpid(), pid = nothing >= 0 ? fork() : -1;
  if (pid == 0) {                     // only what a process of several threads may call here
    prctl(PR_SET_PDEATHSIG, SIGKILL); // what a run has kept is whole at any time
    signal(SIGINT, SIG_DFL);
    if (getppid() != parent || setpgid(0, 0) != 0 || dup2(nothing, STDIN_FILENO) < 0 ||
        dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) {
      _exit(127);
    }
    execv(program, (char *const *)argv);
    _exit(127);
  }
  if (nothing >= 0) {
    close(nothing);
  }
  return pid;
}

static void read_all(int file, struct dea_text *out)
{
  char chunk[16384];
  ssize_t got;
  lseek(file, 0, SEEK_SET);
  while ((got = read(file, chunk, sizeof chunk)) > 0) {
    dea_text_add_bytes(out, chunk, (size_t)got);
  }
  dea_text_add_bytes(out, "", 0); // a text also without any
}

dea_status dea_studio_run_command(struct dea_context *ctx, const char *program,
                                  const struct dea_studio_line *line, double limit_s,
                                  struct dea_text *out, struct dea_text *err, int *code)
{
  const int files[2] = {memfd_create("out", MFD_CLOEXEC), memfd_create("err", MFD_CLOEXEC)};
  const pid_t pid = files[0] >= 0 && files[1] >= 0 ? start(program, line, files[0], files[1]) : -1;
  const double began_s = dea_clock_s();
  int state = 0;
  pid_t ended = 0;
  while (pid > 0 && ended == 0) {
    ended = waitpid(pid, &state, WNOHANG);
    if (ended == 0 && dea_clock_s() - began_s > limit_s) {
      kill(-pid, SIGKILL);
    }
    if (ended == 0) {
      dea_clock_wait(0.001);
    }
  }
  for (size_t i = 0; i < 2; i++) {
    if (files[i] >= 0) {
      read_all(files[i], i == 0 ? out : err);
      close(files[i]);
    }
  }
  *code = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  if (pid < 0 || !WIFEXITED(state)) {
    return dea_fail(ctx, DEA_E_TOOL, "%s could not be run to its end", program);
  }
  return out->failed || err->failed ? DEA_E_MEMORY : DEA_OK;
}

// The queue ---------------------------------------------------------------------------------------

enum { JOBS_MAX = 48, SAID_MAX = 6000, LAST_LINE = 160, PATIENCE_S = 10 };

enum state { WAITING, RUNNING, DONE, FAILED, STOPPED };
static const char *const states[] = {"waiting", "running", "done", "failed", "stopped"};

struct job {
  int id;
  enum state state;
  json_t *facts;
  struct dea_studio_line line;
  pid_t process;
  int terminal; // that it writes to
  int code;
  int stops_asked; // how often it was told to end
  char said[SAID_MAX];
  char last[LAST_LINE]; // what it says of its progress
  char half[512];       // a line that has not ended
  size_t half_length;
};

struct dea_studio_jobs {
  const char *program;
  int cores;
  int last_id;
  pthread_mutex_t lock;
  size_t count;
  struct job jobs[JOBS_MAX];
};

struct dea_studio_jobs *dea_studio_jobs_create(struct dea_context *ctx, const char *program)
{
  struct dea_studio_jobs *jobs = dea_alloc(ctx, 1, sizeof *jobs);
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  if (jobs == NULL) {
    return NULL;
  }
  jobs->program = program;
  jobs->cores = cores > 1 ? (int)cores : 1;
  if (pthread_mutex_init(&jobs->lock, NULL) != 0) {
    dea_fail(ctx, DEA_E_IO, "no queue: %s", strerror(errno));
    dea_free(ctx, jobs);
    return NULL;
  }
  return jobs;
}

/* Makes room in the list: the oldest that is over goes. */
static bool reserve(struct dea_studio_jobs *jobs)
{
  for (size_t i = 0; i < jobs->count && jobs->count == JOBS_MAX; i++) {
    if (jobs->jobs[i].state > RUNNING) {
      json_decref(jobs->jobs[i].facts);
      jobs->count--;
      memmove(&jobs->jobs[i], &jobs->jobs[i + 1], (jobs->count - i) * sizeof jobs->jobs[0]);
    }
  }
  return jobs->count < JOBS_MAX;
}

/* The folder or file that a job writes. */
static const char *output_of(const json_t *facts)
{
  return json_string_value(json_object_get(facts, "output"));
}

int dea_studio_jobs_add(struct dea_studio_jobs *jobs, json_t *facts,
                        const struct dea_studio_line *line)
{
  int id = 0;
  bool free_place = facts != NULL;
  pthread_mutex_lock(&jobs->lock);
  for (size_t i = 0; i < jobs->count; i++) {
    const struct job *other = &jobs->jobs[i];
    free_place = free_place && !(other->state <= RUNNING &&
                                 strcmp(output_of(other->facts), output_of(facts)) == 0);
  }
  if (free_place && !line->full && reserve(jobs)) {
    id = ++jobs->last_id;
    json_object_set_new(facts, "id", json_integer(id));
    jobs->jobs[jobs->count++] =
        (struct job){.id = id, .facts = facts, .line = *line, .terminal = -1};
    facts = NULL; // the job has them
  }
  pthread_mutex_unlock(&jobs->lock);
  json_decref(facts);
  return id;
}

/* Tells one that runs to end: its own end first, which keeps what it has, then that of all that it
 * has started. */
static void notify(struct job *job)
{
  job->stops_asked++;
  kill(job->stops_asked > 1 ? -job->process : job->process,
       job->stops_asked > 1 ? SIGKILL : SIGTERM);
}

bool dea_studio_jobs_stop(struct dea_studio_jobs *jobs, int id)
{
  bool found = false;
  pthread_mutex_lock(&jobs->lock);
  for (size_t i = 0; i < jobs->count; i++) {
    struct job *job = &jobs->jobs[i];
    if (job->id == id && job->state == WAITING) {
      job->state = STOPPED;
      found = true;
    } else if (job->id == id && job->state == RUNNING) {
      notify(job);
      found = true;
    }
  }
  pthread_mutex_unlock(&jobs->lock);
  return found;
}

static json_t *job_json(const struct job *job)
{
  json_t *json = json_deep_copy(job->facts);
  json_object_set_new(json, "state", json_string(states[job->state]));
  json_object_set_new(json, "code", json_integer(job->code));
  json_object_set_new(json, "progress", json_string(job->last));
  json_t *said = json_string(job->said); // NULL where its first letter was cut
  for (size_t skip = 1; said == NULL && skip < 4 && job->said[skip] != '\0'; skip++) {
    said = json_string(job->said + skip);
  }
  json_object_set_new(json, "said", said != NULL ? said : json_string(""));
  return json;
}

json_t *dea_studio_jobs_json(struct dea_studio_jobs *jobs)
{
  json_t *list = json_array();
  pthread_mutex_lock(&jobs->lock);
  for (size_t i = 0; i < jobs->count; i++) {
    json_array_append_new(list, job_json(&jobs->jobs[i]));
  }
  pthread_mutex_unlock(&jobs->lock);
  return list;
}

/* A terminal for one: its progress is told there as a user sees it. *writes: its other end. */
static int open_terminal(int *writes)
{
  char name[64];
  const int reads = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  *writes = -1;
  if (reads < 0 || grantpt(reads) != 0 || unlockpt(reads) != 0 ||
      ptsname_r(reads, name, sizeof name) != 0 ||
      (*writes = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC)) < 0) {
    if (reads >= 0) {
      close(reads);
    }
    return -1;
  }
  struct termios how;
  if (tcgetattr(*writes, &how) == 0) {
    how.c_oflag &= ~(tcflag_t)OPOST;
    how.c_lflag &= ~(tcflag_t)ECHO;
    tcsetattr(*writes, TCSANOW, &how);
  }
  fcntl(reads, F_SETFL, O_NONBLOCK);
  return reads;
}

static void begin(struct dea_studio_jobs *jobs, struct job *job)
{
  int writes;
  job->terminal = open_terminal(&writes);
  job->process = job->terminal >= 0 ? start(jobs->program, &job->line, writes, writes) : -1;
  job->state = job->process > 0 ? RUNNING : FAILED;
  if (writes >= 0) {
    close(writes);
  }
  if (job->state == FAILED) {
    snprintf(job->said, sizeof job->said, "cannot be started: %s", strerror(errno));
    if (job->terminal >= 0) {
      close(job->terminal);
    }
  }
}

/* Adds a line to what it has said, of which the first goes where it gets long. */
static void keep_line(struct job *job)
{
  const size_t length = job->half_length, used = strlen(job->said);
  size_t gone = 0;
  if (used + length + 2 > sizeof job->said) {
    gone = used + length + 2 - sizeof job->said;
    gone = gone < used ? gone : used;
    memmove(job->said, job->said + gone, used - gone + 1);
  }
  snprintf(job->said + used - gone, sizeof job->said - (used - gone), "%.*s\n", (int)length,
           job->half);
}

static void receive_byte(struct job *job, char byte)
{
  static const char erase[] = "\033[K";
  if (byte == '\r' || byte == '\n') {
    const bool progress = job->half_length >= 3 && memcmp(job->half, erase, 3) == 0;
    if (progress) {
      snprintf(job->last, sizeof job->last, "%.*s", (int)job->half_length - 3, job->half + 3);
    } else if (byte == '\n') {
      keep_line(job);
    }
    job->half_length = 0;
  } else if (job->half_length < sizeof job->half && (byte == 0x1b || (unsigned char)byte >= 0x20)) {
    job->half[job->half_length++] = byte;
  }
}

/* The line that has not ended yet is progress, too: the next one comes with its own start. */
static void receive(struct job *job)
{
  char chunk[4096];
  ssize_t got;
  while ((got = read(job->terminal, chunk, sizeof chunk)) > 0) {
    for (ssize_t i = 0; i < got; i++) {
      receive_byte(job, chunk[i]);
    }
  }
  if (job->half_length > 3 && memcmp(job->half, "\033[K", 3) == 0) {
    snprintf(job->last, sizeof job->last, "%.*s", (int)job->half_length - 3, job->half + 3);
  }
}

static void inspect(struct job *job)
{
  int state = 0;
  const bool over = waitpid(job->process, &state, WNOHANG) == job->process;
  receive(job);
  if (over) {
    job->code = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
    job->state = job->stops_asked > 0 ? STOPPED : job->code == 0 ? DONE : FAILED;
    close(job->terminal);
    job->terminal = -1;
  }
}

void dea_studio_jobs_turn(struct dea_studio_jobs *jobs)
{
  int running = 0;
  pthread_mutex_lock(&jobs->lock);
  for (size_t i = 0; i < jobs->count; i++) {
    running += jobs->jobs[i].state == RUNNING;
  }
  for (size_t i = 0; i < jobs->count; i++) {
    struct job *job = &jobs->jobs[i];
    if (job->state == WAITING && running < jobs->cores) {
      begin(jobs, job);
      running += job->state == RUNNING;
    } else if (job->state == RUNNING) {
      inspect(job);
    }
  }
  pthread_mutex_unlock(&jobs->lock);
  dea_clock_wait(0.03);
}

void dea_studio_jobs_destroy(struct dea_context *ctx, struct dea_studio_jobs *jobs)
{
  if (jobs == NULL) {
    return;
  }
  for (size_t i = 0; i < jobs->count; i++) {
    if (jobs->jobs[i].state == RUNNING) {
      notify(&jobs->jobs[i]);
    }
  }
  for (size_t i = 0; i < jobs->count; i++) {
    struct job *job = &jobs->jobs[i];
    const double began_s = dea_clock_s();
    while (job->state == RUNNING) {
      inspect(job);
      dea_clock_wait(0.01);
      if (job->stops_asked == 1 && dea_clock_s() - began_s > PATIENCE_S) {
        notify(job);
      }
    }
    json_decref(job->facts);
  }
  pthread_mutex_destroy(&jobs->lock);
  dea_free(ctx, jobs);
}
