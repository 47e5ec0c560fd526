/* What is known of an output that was brought to 0 V. "At 0 V" is what was read back, and nothing
 * else. */
#pragma once

enum dea_zero_state {
  DEA_ZERO_NONE,      // there is no output, or it was never armed
  DEA_ZERO_READ_BACK, // its voltage was measured, and is 0 V
  DEA_ZERO_COMMANDED, // 0 V was commanded and taken; nothing has measured it
  DEA_ZERO_UNKNOWN    // it is not known to be at 0 V
};

struct dea_zero {
  enum dea_zero_state state;
  double volts;    // that was measured last; NAN: none
  const char *why; // it is not known, as the end of a sentence; static. NULL: nothing more is known
};

enum { DEA_ZERO_TEXT_SIZE = 160 };

extern const char dea_zero_no_answer[], dea_zero_not_for_long[], dea_zero_contradicted[],
    dea_zero_other[], dea_zero_unseen[]; // why

/* What was measured is not believed; why: NULL where what is said anyway tells it. */
void dea_zero_doubt(struct dea_zero *zero, const char *why);

/* The same where there is a doubt of what has measured it, NULL: none. What was only commanded is
 * not doubted because nothing has measured it. */
struct dea_zero dea_zero_believe(struct dea_zero zero, const char *doubt);

/* "at 0 V", "commanded to 0 V, not read back", "not known to be at 0 V", "not armed". */
const char *dea_zero_name(enum dea_zero_state state);
/* The same with the voltage, "at 0 V (2.1 V read back)", and with why it is not known: "not known
 * to be at 0 V (2.1 V read back; it had measured another voltage than was set)". volts: at the
 * output. */
void dea_zero_text(struct dea_zero zero, char out[DEA_ZERO_TEXT_SIZE]);
