#define _POSIX_C_SOURCE 200809L // getpid
#include "drive/drive.h"

#include "base/file.h"
#include "drive/drive_loop.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Besides slewing and charging: filters of amplifier and inputs. */
static const double settle_s = 0.02, stall_s = 0.5;

struct opened {
  struct dea_instrument *instruments[DEA_PROTOCOL_INSTRUMENTS_MAX];
  size_t count;
};

static dea_status open_all(struct dea_context *ctx, const struct dea_protocol *protocol,
                           bool simulate, struct opened *opened)
{
  const struct dea_protocol_instrument *sections = protocol->instruments;
  size_t count = protocol->instrument_count;
  if (simulate) {
    sections = &protocol->sim;
    count = 1;
  } else if (count == 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s names no instruments: add a section 'instruments', or play on the "
                    "simulated bench",
                    protocol->file);
  }
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, dea_instrument_open(ctx, &sections[i], protocol, &opened->instruments[i]));
    opened->count++;
  }
  return DEA_OK;
}

/* The supply of a protocol while it is armed. */
struct armed {
  const struct dea_protocol_instrument *section; // that plays; NULL: none
  struct dea_supply supply;
  struct dea_guard *guard;
  char left[DEA_SUPPLY_LEFT_SIZE]; // what it leaves behind should it end now
};

/* Finds and locks the supply; wait_s: for who brings it to 0 V, how long another program that has
 * it is waited for; NAN: for who arms it. */
static dea_status find_supply(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const char *folder, double wait_s, struct armed *armed)
{
  char address[DEA_INSTRUMENT_ADDRESS_SIZE] = "";
  *armed = (struct armed){.supply = {.file = -1, .ask = -1}};
  for (size_t i = 0; i < protocol->instrument_count && address[0] == '\0'; i++) {
    armed->section = &protocol->instruments[i];
    DEA_TRY(ctx, dea_instrument_address(ctx, armed->section, protocol, address));
  }
  if (address[0] == '\0') {
    armed->section = NULL; // which the instruments themselves will say
    return DEA_OK;
  }
  return isnan(wait_s) ? dea_supply_open(ctx, folder, address, &armed->supply)
                       : dea_supply_request(ctx, folder, address, wait_s, &armed->supply);
}

/* How long a program that was asked to end may take, or the guard of one that has died: an attempt
 * of it waits for the line, and reads back. */
static double longest_end_s(const struct dea_protocol *protocol)
{
  double zero_s = protocol->safety.zero_time_s.si;
  return protocol->safety.guard_time_s.si + protocol->safety.longest_ramp_s.si + 3 * zero_s + 1;
}

static dea_status arm(struct dea_context *ctx, const struct dea_protocol *protocol,
                      const struct dea_drive_options *options, struct armed *armed)
{
  dea_status found = find_supply(ctx, protocol, options->state_folder, NAN, armed);
  if (found == DEA_E_INTERLOCK && strstr(armed->supply.left, dea_guard_goes_on) != NULL) {
    dea_context_clear(ctx); // no program plays on it: its guard gives it away
    found = find_supply(ctx, protocol, options->state_folder, longest_end_s(protocol), armed);
  }
  DEA_TRY(ctx, found);
  if (armed->section == NULL) {
    return DEA_OK;
  }
  if (armed->supply.left[0] != '\0' && !options->checked) {
    return dea_fail(ctx, DEA_E_INTERLOCK,
                    "the last measurement with this supply did not end at 0 V as far as is known: "
                    "%s; look at supply and specimen, then 'dea drive --zero %s', or --checked",
                    armed->supply.left, protocol->file);
  }
  armed->supply.mark[0] = armed->supply.host[0] = '\0'; // those of what was left before
  snprintf(armed->left, sizeof armed->left, "armed by process %ld with %.100s, which did not end",
           (long)getpid(), dea_path_name(protocol->file));
  DEA_TRY(ctx, dea_supply_leave(ctx, &armed->supply, armed->left));
  return options->guard ? dea_guard_begin(ctx, protocol, armed->section, &armed->supply,
                                          options->tell, &armed->guard)
                        : DEA_OK;
}

/* Keeps what tells the supply from another one, and where it is, now that it is open. */
static dea_status know(struct dea_context *ctx, const struct opened *opened, struct armed *armed)
{
  for (size_t i = 0; armed->section != NULL && i < opened->count; i++) {
    const struct dea_instrument *instrument = opened->instruments[i];
    if ((instrument->roles & DEA_PLAYS_OUTPUT) != 0 &&
        (instrument->mark[0] != '\0' || instrument->host[0] != '\0')) {
      memcpy(armed->supply.mark, instrument->mark, sizeof armed->supply.mark);
      memcpy(armed->supply.host, instrument->host, sizeof armed->supply.host);
      dea_guard_know(armed->guard, instrument);
      return dea_supply_leave(ctx, &armed->supply, armed->left);
    }
  }
  return DEA_OK;
}

static dea_status disarm(struct dea_context *ctx, struct armed *armed, struct dea_zero zero)
{
  char known[DEA_ZERO_TEXT_SIZE], text[DEA_SUPPLY_LEFT_SIZE] = "";
  bool is_known = zero.state != DEA_ZERO_UNKNOWN;
  if (!is_known) {
    dea_zero_text(zero, known);
    snprintf(text, sizeof text, "%s: the output is %s",
             armed->guard != NULL ? dea_guard_goes_on : "at the end", known);
  } else {
    dea_guard_end(ctx, armed->guard, true);
  }
  dea_status status = dea_supply_leave(ctx, &armed->supply, text);
  if (!is_known) { // which writes there from now on
    dea_guard_end(ctx, armed->guard, false);
  }
  dea_supply_close(&armed->supply);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_protocol *protocol,
                      const struct dea_protocol_plan *plan, const struct dea_drive_options *options,
                      struct armed *armed, struct dea_drive_report *out)
{
  struct opened opened = {.count = 0};
  dea_status status = open_all(ctx, protocol, options->simulate, &opened);
  status = status == DEA_OK ? know(ctx, &opened, armed) : status;
  if (status == DEA_OK) {
    struct dea_drive_bench bench = {opened.instruments,
                                    opened.count,
                                    settle_s + (isfinite(plan->rise_s) ? 2 * plan->rise_s : 0),
                                    stall_s,
                                    armed->guard,
                                    &armed->supply,
                                    plan->capacitance_F};
    status = dea_drive_play(ctx, protocol, &bench, options->file, out);
  } else {
    out->zero.state = status == DEA_E_INTERLOCK ? DEA_ZERO_UNKNOWN : DEA_ZERO_NONE;
    // what is set up already must not stay as it is: a supply's output may be on
    status = dea_drive_abort(ctx, protocol, opened.instruments, opened.count, status, out);
  }
  for (size_t i = opened.count; i-- > 0;) {
    opened.instruments[i]->type->close(ctx, opened.instruments[i]);
  }
  return status;
}

dea_status dea_drive_run(struct dea_context *ctx, const struct dea_protocol *protocol,
                         const struct dea_drive_options *options, struct dea_drive_report *out)
{
  struct dea_protocol_plan plan;
  struct armed armed = {.supply = {.file = -1, .ask = -1}};
  *out = (struct dea_drive_report){.largest_current_A = NAN, .zero.volts = NAN};
  DEA_TRY(ctx, dea_protocol_check(ctx, protocol, &plan));
  dea_status status = options->simulate ? DEA_OK : arm(ctx, protocol, options, &armed);
  DEA_TRY_ELSE(ctx, status, dea_supply_close(&armed.supply));
  status = run(ctx, protocol, &plan, options, &armed, out);
  dea_status disarmed = disarm(ctx, &armed, out->zero);
  status = status != DEA_OK ? status : disarmed;
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

dea_status dea_drive_zero(struct dea_context *ctx, const struct dea_protocol *protocol,
                          const char *state_folder, bool checked, struct dea_zero *out)
{
  struct armed armed;
  char known[DEA_ZERO_TEXT_SIZE], doubt[512] = "";
  *out = (struct dea_zero){DEA_ZERO_NONE, NAN, NULL};
  dea_status status = find_supply(ctx, protocol, state_folder, longest_end_s(protocol), &armed);
  bool driven = status == DEA_E_INTERLOCK;
  if (driven || (status == DEA_E_IO && armed.section != NULL)) { // no reason not to command 0 V
    snprintf(doubt, sizeof doubt, "%s%s; ", dea_context_message(ctx),
             driven ? ", and did not end" : "");
    dea_context_clear(ctx);
  } else if (status != DEA_OK) {
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  const struct dea_instrument_past past = {
      checked ? "" : armed.supply.mark, 0, driven ? 0 : protocol->safety.zero_time_s.si,
      armed.supply.host,
      !checked && strstr(armed.supply.left, dea_zero_contradicted) != NULL ? dea_zero_contradicted
                                                                           : NULL};
  status = armed.section != NULL ? dea_instrument_zero(ctx, armed.section, protocol, &past, out)
                                 : dea_fail(ctx, DEA_E_INSTRUMENT,
                                            "%s names no instrument that plays", protocol->file);
  if (doubt[0] != '\0' && out->state != DEA_ZERO_NONE) {
    // what was read back says nothing of what another program will set, or may be another supply's
    dea_zero_doubt(out, NULL);
  }
  out->volts *= protocol->amplifier.gain.si;
  if (fabs(out->volts) > dea_protocol_zero_most_V(protocol)) { // its protocol was not checked
    dea_zero_doubt(out, NULL);
  }
  dea_zero_text(*out, known);
  bool clean = armed.supply.left[0] == '\0';
  if (status == DEA_OK &&
      (out->state == DEA_ZERO_READ_BACK || (checked && out->state == DEA_ZERO_COMMANDED))) {
    status = dea_supply_leave(ctx, &armed.supply, "");
  } else if (status == DEA_OK && (out->state == DEA_ZERO_UNKNOWN || !clean)) {
    status = dea_fail(ctx, DEA_E_INSTRUMENT,
                      "%sthe output is %s: switch the supply off and look at it%s", doubt, known,
                      clean ? "" : "; then --zero --checked says that you have");
  }
  dea_supply_close(&armed.supply);
  return status;
}
