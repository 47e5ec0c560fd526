/* How long the command takes to answer: median wall time of 20 runs, process start included. */
#include "bench_command.h"

enum { RUNS = 20 };

int main(void)
{
  static char command[] = DEA_COMMAND, version[] = "--version", check[] = "check",
              quiet[] = "--quiet", design[] = DEA_SOURCE_DIR "/examples/frdea-4.yaml";
  bench_command("startup.version", (char *[]){command, version, NULL}, RUNS);
  bench_command("startup.check", (char *[]){command, check, quiet, design, NULL}, RUNS);
  return 0;
}
