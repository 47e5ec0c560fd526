/* FMI 3.0, co-simulation, around the model above. The voltage of the source and the force are held
 * during a communication step. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error };
enum variable {
  TIME,
  VOLTAGE,
  FORCE,
  RESISTANCE,
  LONGEST_STEP,
  DAMPING,
  INERTIA, // in; time apart
  DISPLACEMENT,
  RATE,
  CHARGE,
  FILM_VOLTAGE,
  CURRENT,
  VARIABLES
};

typedef void (*log_message)(void *environment, int status, const char *category,
                            const char *message);

struct instance {
  struct dea_reduced device;
  struct dea_reduced_state state;
  double in[DISPLACEMENT], time, current_A;
  bool runs; // past its initialisation
  void *environment;
  log_message log;
};

const char *fmi3GetVersion(void)
{
  return "3.0";
}
void *fmi3InstantiateModelExchange()
{
  return NULL;
}
void *fmi3InstantiateScheduledExecution()
{
  return NULL;
}

int fmi3SetDebugLogging(void *of, bool on, size_t count, const char *const categories[])
{
  return fmi3OK;
}

int fmi3Reset(void *of)
{
  struct instance *i = of;
  i->device = dea_reduced_device;
  i->runs = false;
  i->time = i->current_A = 0;
  memset(i->in, 0, sizeof i->in);
  i->in[LONGEST_STEP] = fmi3_longest_step;
  i->in[INERTIA] = i->device.mode_count > 0;
  return fmi3OK;
}

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                  bool visible, bool logging, bool events, bool early,
                                  const uint32_t *required, size_t count, void *environment,
                                  log_message log, void (*update)(void))
{
  struct instance *i = strcmp(token, fmi3_token) == 0 ? calloc(1, sizeof *i) : NULL;
  if (i != NULL) {
    i->environment = environment;
    i->log = log;
    fmi3Reset(i);
  }
  return i;
}

void fmi3FreeInstance(void *of)
{
  free(of);
}
int fmi3Terminate(void *of)
{
  return fmi3OK;
}

static int ended(const struct instance *i, int end)
{
  static const char *const why[] = {"", "the force is beyond the model's range",
                                    "the voltage is beyond the model's range", "no convergence"};
  if (end != DEA_REDUCED_OK && i->log != NULL) {
    i->log(i->environment, fmi3Error, "logStatusError", why[end]);
  }
  return end == DEA_REDUCED_OK ? fmi3OK : fmi3Error;
}

int fmi3EnterInitializationMode(void *of, bool has_tolerance, double tolerance, double start,
                                bool has_stop, double stop)
{
  struct instance *i = of;
  i->time = start;
  return fmi3OK;
}

/* At rest for long. */
static int begin(struct instance *i)
{
  i->device.damping = i->in[DAMPING];
  i->device.mode_count = i->in[INERTIA] > 0 ? dea_reduced_device.mode_count : 0;
  return ended(i, dea_reduced_begin(&i->device, i->in[VOLTAGE], i->in[FORCE], &i->state));
}

int fmi3ExitInitializationMode(void *of)
{
  struct instance *i = of;
  const int status = begin(i);
  i->runs = status == fmi3OK;
  return status;
}

int fmi3SetFloat64(void *of, const uint32_t *which, size_t count, const double *values, size_t n)
{
  struct instance *i = of;
  for (size_t k = 0; k < count; k++) {
    const uint32_t v = which[k];
    if (k >= n || v == TIME || v >= DISPLACEMENT || (v > FORCE && i->runs) ||
        !(v <= FORCE || values[k] >= 0) || (v == LONGEST_STEP && !(values[k] > 0))) {
      return fmi3Error;
    }
    i->in[v] = values[k];
  }
  return fmi3OK;
}

int fmi3GetFloat64(void *of, const uint32_t *which, size_t count, double *values, size_t n)
{
  struct instance *i = of;
  if (!i->runs && begin(i) != fmi3OK) {
    return fmi3Error;
  }
  const struct dea_reduced_state *s = &i->state;
  const double out[] = {s->at.q, s->rate, s->at.charge_C, s->at.voltage_V, i->current_A};
  for (size_t k = 0; k < count; k++) {
    if (k >= n || which[k] >= VARIABLES) {
      return fmi3Error;
    }
    values[k] = which[k] == TIME          ? i->time
                : which[k] < DISPLACEMENT ? i->in[which[k]]
                                          : out[which[k] - DISPLACEMENT];
  }
  return fmi3OK;
}

/* A step behind the resistance, weighed as the decay of a charge is: V by the capacitance that the
 * film has at its end, in turns. */
static int step(struct instance *i, double h)
{
  const double R = i->in[RESISTANCE], V_s = i->in[VOLTAGE], Q = i->state.at.charge_C;
  const double V_0 = i->state.at.voltage_V;
  struct dea_reduced_state to = i->state;
  double V = R > 0 ? V_0 : V_s, was;
  int turns = 0, end;
  do {
    was = V;
    if (R > 0) {
      const double C =
          to.at.voltage_V != 0 ? to.at.charge_C / to.at.voltage_V : to.at.charge_by_voltage;
      const double x = h / (R * C), share = x > 1e-5 ? 1 / (1 - exp(-x)) - 1 / x : 0.5 + x / 12;
      V = h > 0 ? (Q + h / R * (V_s - (1 - share) * V_0)) / (C + share * h / R) : V_0;
    }
    end = dea_reduced_step(&i->device, &i->state, h, V, i->in[FORCE], i->device.mode_count > 0, 0.9,
                           &to);
  } while (end == DEA_REDUCED_OK && R > 0 && fabs(V - was) > 1e-12 * fabs(V) && ++turns < 60);
  if (end == DEA_REDUCED_OK) {
    i->state = to;
    i->current_A = R > 0 ? (V_s - V) / R : h > 0 ? (to.at.charge_C - Q) / h : i->current_A;
  }
  return end;
}

int fmi3DoStep(void *of, double from, double length, bool no_return, bool *event, bool *terminate,
               bool *early, double *last)
{
  struct instance *i = of;
  const double count = fmax(1, ceil(length / i->in[LONGEST_STEP] * (1 - 1e-12)));
  *event = *terminate = *early = false;
  int end = step(i, 0); // what jumps
  for (double k = 0; k < count && end == DEA_REDUCED_OK; k++) {
    end = step(i, length / count);
  }
  i->time = end == DEA_REDUCED_OK ? from + length : i->time;
  *last = i->time;
  return ended(i, end);
}

int fmi3GetFMUState(void *of, void **state)
{
  *state = *state != NULL ? *state : malloc(sizeof(struct instance));
  if (*state != NULL) {
    memcpy(*state, of, sizeof(struct instance));
  }
  return *state != NULL ? fmi3OK : fmi3Error;
}

int fmi3SetFMUState(void *of, void *state)
{
  memcpy(of, state, sizeof(struct instance));
  return fmi3OK;
}

int fmi3FreeFMUState(void *of, void **state)
{
  free(*state);
  *state = NULL;
  return fmi3OK;
}

// What it does not do

#define REFUSED(name)                                                                              \
  int fmi3##name()                                                                                 \
  {                                                                                                \
    return fmi3Error;                                                                              \
  }
#define REFUSED_TYPE(name) REFUSED(Get##name) REFUSED(Set##name)
// clang-format off
REFUSED_TYPE(Float32) REFUSED_TYPE(Int8) REFUSED_TYPE(UInt8) REFUSED_TYPE(Int16)
REFUSED_TYPE(UInt16) REFUSED_TYPE(Int32) REFUSED_TYPE(UInt32) REFUSED_TYPE(Int64)
REFUSED_TYPE(UInt64) REFUSED_TYPE(Boolean) REFUSED_TYPE(String) REFUSED_TYPE(Binary)
REFUSED_TYPE(Clock) REFUSED_TYPE(IntervalDecimal) REFUSED_TYPE(IntervalFraction)
REFUSED_TYPE(ShiftDecimal) REFUSED_TYPE(ShiftFraction) REFUSED_TYPE(ContinuousStates)
REFUSED(EnterEventMode) REFUSED(EnterStepMode) REFUSED(EnterConfigurationMode)
REFUSED(ExitConfigurationMode) REFUSED(EnterContinuousTimeMode) REFUSED(CompletedIntegratorStep)
REFUSED(SetTime) REFUSED(GetNominalsOfContinuousStates)
REFUSED(GetContinuousStateDerivatives) REFUSED(GetEventIndicators)
REFUSED(GetNumberOfEventIndicators) REFUSED(GetNumberOfContinuousStates)
REFUSED(GetOutputDerivatives) REFUSED(ActivateModelPartition) REFUSED(EvaluateDiscreteStates)
REFUSED(UpdateDiscreteStates) REFUSED(GetDirectionalDerivative) REFUSED(GetAdjointDerivative)
REFUSED(GetNumberOfVariableDependencies) REFUSED(GetVariableDependencies)
REFUSED(SerializedFMUStateSize) REFUSED(SerializeFMUState) REFUSED(DeserializeFMUState)
