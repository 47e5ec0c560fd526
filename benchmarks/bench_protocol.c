/* The paper's whole measurement (9 voltages x 15 pulses) by model lumped, as a user runs it: path
 * and sweep too, with results and figures written and without figures. Wall time, process start
 * included. */
#define _XOPEN_SOURCE 700 // mkdtemp
#include "bench_command.h"

enum { RUNS = 7 };

int main(void)
{
  static char folder[] = "/tmp/dea-bench-XXXXXX",
              design[] = DEA_SOURCE_DIR "/examples/protocol.yaml";
  static char command[] = DEA_COMMAND, run[] = "run", quiet[] = "--quiet", force[] = "--force";
  static char output[] = "-o", none[] = "--no-figures", clear[] = "/bin/rm", recursive[] = "-rf";
  if (mkdtemp(folder) == NULL) {
    fprintf(stderr, "no folder for the results\n");
    return EXIT_FAILURE;
  }
  bench_command("protocol.lumped",
                (char *[]){command, run, quiet, design, force, output, folder, NULL}, RUNS);
  bench_command("protocol.lumped.no_figures",
                (char *[]){command, run, quiet, design, force, none, output, folder, NULL}, RUNS);
  bench_run_once((char *[]){clear, recursive, folder, NULL});
  return 0;
}
