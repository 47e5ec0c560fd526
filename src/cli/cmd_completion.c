/* Completion for bash, out of the table of commands and their options. */
#include "cli/cli.h"

#include <string.h>

struct request {
  struct cli_words words;
};

static void print_bash_candidates(const struct cli_kind_info *kind)
{
  if (kind->name != NULL) {
    printf("_dea_take -W \"$(dea completion names %s 2>/dev/null)\"", kind->name);
  } else {
    printf("compopt -o filenames; _dea_take %s", kind->folder ? "-d" : "-f");
  }
}

static void print_bash_command(const struct dea_command *command)
{
  const struct cli_option *argument = cli_argument_of(command);
  const struct cli_option *const tables[] = {command->options, cli_common_options};
  printf("    %s)\n      options='", command->name);
  for (size_t k = 0; k < 2; k++) {
    for (const struct cli_option *o = tables[k]; o->help != NULL; o++) {
      if (o->letter != 0 && k == 0) {
        printf("-%c ", o->letter);
      }
      if (o->name != NULL) {
        printf("--%s ", o->name);
      }
    }
  }
  puts("'\n      case $before in");
  for (const struct cli_option *o = command->options; o->help != NULL; o++) {
    if (o->name != NULL && o->kind != CLI_FLAG) {
      const char letter[] = {'-', o->letter, '\0'};
      printf("        %s%s--%s) ", o->letter != 0 ? letter : "", o->letter != 0 ? " | " : "",
             o->name);
      print_bash_candidates(&cli_kinds[o->kind]);
      puts("; return ;;");
    }
  }
  fputs("      esac\n      [[ $word == -* ]] || { ", stdout);
  if (argument->help != NULL) {
    print_bash_candidates(&cli_kinds[argument->kind]);
  } else {
    fputs("COMPREPLY=()", stdout);
  }
  puts("; return; } ;;");
}

static void print_bash(const struct dea_cli *cli)
{
  puts("# bash completion for dea; to use it now: source <(dea completion bash)\n"
       "_dea_take()\n{\n  mapfile -t COMPREPLY < <(compgen \"$@\" -- "
       "\"${COMP_WORDS[COMP_CWORD]}\")\n}\n"
       "_dea()\n{\n"
       "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options=''\n"
       "  if ((COMP_CWORD == 1)); then\n"
       "    _dea_take -W \"$(dea completion names commands 2>/dev/null) --help --version\"\n"
       "    return\n  fi\n"
       "  case ${COMP_WORDS[1]} in");
  for (size_t i = 0; cli->commands[i] != NULL; i++) {
    print_bash_command(cli->commands[i]);
  }
  puts("  esac\n  _dea_take -W \"$options\"\n}\ncomplete -F _dea dea");
}

static dea_status print_names(struct dea_cli *cli, const char *what)
{
  struct dea_text out = {.ctx = cli->ctx};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < CLI_KINDS; i++) {
    if (cli_kinds[i].name != NULL && strcmp(cli_kinds[i].name, what) == 0) {
      status = cli_kind_list(cli, &cli_kinds[i], &out);
    }
  }
  return cli_print_text(status, &out);
}

static dea_status run(struct dea_cli *cli, void *request)
{
  const struct cli_words *words = &((const struct request *)request)->words;
  const char *what = words->at[0];
  if (words->count == 2 && strcmp(what, "names") == 0) { // for the completion itself
    return print_names(cli, words->at[1]);
  }
  if (words->count == 1 && strcmp(what, "man") == 0) {
    return cli_print_manual(cli);
  }
  if (words->count == 1 && strcmp(what, "bash") == 0) {
    print_bash(cli);
    return DEA_OK;
  }
  return cli_usage_error(cli, "'%s' is not a shell that is known here (bash)", what);
}

static const struct cli_option options[] = {
    CLI_MANY(CLI_SHELL, "bash|man", "the shell, or 'man' for the manual page", words, 2,
             "name the shell: bash", "name the shell: bash"),
    {0}};

const struct dea_command cmd_completion = {.name = "completion",
                                           .summary = "Print the completion for bash",
                                           .about = "source <(dea completion bash)",
                                           CLI_RUN};
