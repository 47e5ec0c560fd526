/* The context: allocator, messages, progress and interruption of one caller.
 *
 * Nothing in the library prints, exits or keeps global state. A function that can fail takes the
 * context first and returns a status; the context then holds the message, the chain of calls that
 * led to it, and for errors in an input file every finding with its file, line and column.
 * A context belongs to one thread at a time. Contexts of several threads may read designs and solve
 * at the same time; results (dea_results_h5_write, dea_run_read, run folders) go through HDF5,
 * which keeps state of its own, and are for one thread at a time unless that HDF5 was built
 * thread-safe.
 */
#pragma once

#include "base/status.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define DEA_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define DEA_PRINTF(fmt, args)
#endif

/* Place of a value in an input. file: lent, lives as long as the context; "" when there is none.
 * line and column count from 1; 0 when unknown. */
struct dea_location {
  const char *file;
  size_t line, column;
};

enum dea_severity { DEA_NOTE, DEA_WARNING, DEA_ERROR };

/* One thing found in an input or during a run. text: one sentence without the place. */
struct dea_finding {
  enum dea_severity severity;
  struct dea_location location;
  char *text;
};

/* Memory functions; resize follows realloc (pointer may be NULL, size is never 0). */
struct dea_allocator {
  void *(*resize)(void *user, void *pointer, size_t size);
  void (*release)(void *user, void *pointer);
  void *user;
};

/* done and total count the same thing; total is 0 when unknown. what: for example "lumped sweep".
 */
typedef void (*dea_progress_fn)(void *user, const char *what, size_t done, size_t total);
/* Asked between steps of long work; true: stop. */
typedef bool (*dea_interrupt_fn)(void *user);
/* Told of each finding as it is added; lent. */
typedef void (*dea_finding_fn)(void *user, const struct dea_finding *finding);

/* What the solver of model 3d has done; X(member, label). A cut step is one that the line search
 * has shortened. */
#define DEA_SOLVER_COUNTERS(X)                                                                     \
  X(load_steps, "load steps")                                                                      \
  X(rejected_steps, "rejected")                                                                    \
  X(newton_iterations, "Newton iterations")                                                        \
  X(line_searches, "steps cut by the line search")                                                 \
  X(factorisations, "factorisations")
struct dea_solver_counters {
#define DEA_SOLVER_COUNTER(member, label) unsigned long member;
  DEA_SOLVER_COUNTERS(DEA_SOLVER_COUNTER)
#undef DEA_SOLVER_COUNTER
};

struct dea_context;

/* allocator: NULL for malloc/free; copied. out: owned by the caller, NULL on failure. */
dea_status dea_context_create(const struct dea_allocator *allocator, struct dea_context **out);
void dea_context_destroy(struct dea_context *ctx);

/* Those of all solves with this context, at first 0; lent. */
struct dea_solver_counters *dea_context_counters(struct dea_context *ctx);

/* Memory from the context's allocator, zeroed. count * size is checked for overflow; both may be 0
 * (then a valid pointer comes back). NULL on failure, after dea_fail(DEA_E_MEMORY). */
void *dea_alloc(struct dea_context *ctx, size_t count, size_t size);
/* Grows or shrinks memory of dea_alloc; new bytes are not zeroed. NULL on failure: old one stays.
 */
void *dea_resize(struct dea_context *ctx, void *pointer, size_t count, size_t size);
/* Makes room for one more item of `size` in an array, the pointer to which is at *array (NULL at
 * first). DEA_E_MEMORY: the old one stays. */
dea_status dea_array_grow(struct dea_context *ctx, void *array, size_t count, size_t *capacity,
                          size_t size);
/* Copies text (at most `length` bytes of it); NULL on failure. */
char *dea_copy_text(struct dea_context *ctx, const char *text, size_t length);
/* NULL is fine. */
void dea_free(struct dea_context *ctx, void *pointer);

/* Records a failure: message (printf style, one sentence, no final full stop) and the code, which
 * is returned. Replaces what was recorded before. */
dea_status dea_fail(struct dea_context *ctx, dea_status status, const char *format, ...)
    DEA_PRINTF(3, 4);
/* Adds "function (file:line)" to the chain of calls of the recorded failure; returns status. */
dea_status dea_fail_chain(struct dea_context *ctx, dea_status status, const char *function,
                          const char *file, int line);
/* Last recorded message ("" if none) and chain of calls, innermost first; lent until the next call.
 */
const char *dea_context_message(const struct dea_context *ctx);
const char *dea_context_chain(const struct dea_context *ctx);
dea_status dea_context_status(const struct dea_context *ctx);
/* Forgets the recorded failure (not the findings). */
void dea_context_clear(struct dea_context *ctx);
/* Whether nothing further can be tried after a failure: memory is short, or the run was
 * interrupted. */
bool dea_status_ends(dea_status status);
/* Forgets a failure after which something else is tried, and those before it: DEA_OK, or a status
 * that ends. */
dea_status dea_forgive(struct dea_context *ctx, dea_status status);

#define DEA_PI 3.14159265358979323846
/* Items of an array. */
#define DEA_COUNT(array) (sizeof(array) / sizeof(array)[0])

/* Returns the status of `call` from the enclosing function unless it is DEA_OK. */
#define DEA_TRY(ctx, call)                                                                         \
  do {                                                                                             \
    dea_status dea_try_status_ = (call);                                                           \
    if (dea_try_status_ != DEA_OK) {                                                               \
      return dea_fail_chain((ctx), dea_try_status_, __func__, __FILE__, __LINE__);                 \
    }                                                                                              \
  } while (0)
/* The same, after `otherwise`, an expression that frees what the function has made. */
#define DEA_TRY_ELSE(ctx, call, otherwise)                                                         \
  do {                                                                                             \
    dea_status dea_try_status_ = (call);                                                           \
    if (dea_try_status_ != DEA_OK) {                                                               \
      (otherwise);                                                                                 \
      return dea_fail_chain((ctx), dea_try_status_, __func__, __FILE__, __LINE__);                 \
    }                                                                                              \
  } while (0)
/* What the last call of a function gives, passed on the same way. */
#define DEA_CHAIN(ctx, call) dea_fail_chain((ctx), (call), __func__, __FILE__, __LINE__)
/* Returns the status of `call` from a function that has no context, unless it is DEA_OK. */
#define DEA_TRY_STATUS(call)                                                                       \
  do {                                                                                             \
    dea_status dea_try_status_ = (call);                                                           \
    if (dea_try_status_ != DEA_OK) {                                                               \
      return dea_try_status_;                                                                      \
    }                                                                                              \
  } while (0)
/* Returns DEA_E_MEMORY, which the context knows of, where there is not what was asked for. */
#define DEA_TRY_MEMORY(there)                                                                      \
  do {                                                                                             \
    if (!(there)) {                                                                                \
      return DEA_E_MEMORY;                                                                         \
    }                                                                                              \
  } while (0)

/* Adds a finding (printf style); the same one is kept once, and of errors the first ones. Fails
 * only for want of memory. */
dea_status dea_finding_add(struct dea_context *ctx, enum dea_severity severity,
                           struct dea_location location, const char *format, ...) DEA_PRINTF(4, 5);
/* An error with its place, and DEA_E_DESIGN with the same words. */
dea_status dea_refuse(struct dea_context *ctx, struct dea_location location, const char *text);
/* A failure with DEA_E_ARGUMENT, whose arguments come from a file, becomes that; other statuses
 * stay. */
dea_status dea_refuse_argument(struct dea_context *ctx, struct dea_location location,
                               dea_status status);
enum { DEA_ERRORS_KEPT = 100 };
/* Findings of that severity and above; of errors every one that was added, kept or not, so that a
 * number that has not grown means that there was none. */
size_t dea_finding_count(const struct dea_context *ctx, enum dea_severity at_least);
/* All findings in the order they were added; lent until the next dea_finding_add. */
const struct dea_finding *dea_finding_get(const struct dea_context *ctx, size_t *count);
void dea_finding_clear(struct dea_context *ctx);
/* A trial, of which nobody needs the findings: from begin to end they are counted, but neither kept
 * nor told. begin returns what end takes, the errors before it. Trials nest. */
size_t dea_finding_trial_begin(struct dea_context *ctx);
void dea_finding_trial_end(struct dea_context *ctx, size_t errors);
/* fn: NULL for none. */
void dea_context_set_finding_sink(struct dea_context *ctx, dea_finding_fn fn, void *user);

/* Keeps a copy of a name (file name, ...) until the context dies; the same text gives the same
 * pointer. NULL on failure. */
const char *dea_intern(struct dea_context *ctx, const char *text);

/* Keeps an object of another library (the table of units) until the context dies, when release is
 * called with it. At most four, each with its own release function. On failure it is released. */
dea_status dea_context_keep(struct dea_context *ctx, void *object, void (*release)(void *object));
/* The object kept with that release function, or NULL; lent. */
void *dea_context_kept(const struct dea_context *ctx, void (*release)(void *object));

void dea_context_set_progress(struct dea_context *ctx, dea_progress_fn fn, void *user);
void dea_progress(struct dea_context *ctx, const char *what, size_t done, size_t total);
/* flag: lent; a non-zero value (set by a signal handler) stops long work between points. */
void dea_context_set_interrupt(struct dea_context *ctx, const volatile sig_atomic_t *flag);
/* The flag that is set; NULL: none. */
const volatile sig_atomic_t *dea_context_get_interrupt(const struct dea_context *ctx);
/* The same as a question; both may be set. fn: NULL for none. */
void dea_context_set_interrupt_fn(struct dea_context *ctx, dea_interrupt_fn fn, void *user);
bool dea_interrupted(const struct dea_context *ctx);
/* How processes that compute one model together (mpirun) agree: true on all of them where `here` is
 * true on one. any: NULL, as at the start, for a process that computes alone. */
void dea_context_set_agreement(struct dea_context *ctx, bool (*any)(bool here));
/* Whether any of those processes was interrupted; from then on dea_interrupted says so on all. Each
 * of them has to ask at the same place: else one of them waits for ever. */
bool dea_interrupted_anywhere(struct dea_context *ctx);
