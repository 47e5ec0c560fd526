/* Completion for shells, out of the table of commands and their options. */
#include "cli/cli.h"

#include <string.h>

struct request {
  struct cli_words words;
};

/* The row of a command's argument, or the last one, without help. */
static const struct cli_option *argument_of(const struct dea_command *command)
{
  const struct cli_option *option = command->options;
  while (option->help != NULL && option->name != NULL) {
    option++;
  }
  return option;
}

/* Text for inside single quotes of a shell: quotes become typographic ones. */
static void print_quoted(const char *text, const char *special)
{
  for (; *text != '\0'; text++) {
    if (*text == '\'') {
      fputs("\u2019", stdout);
    } else {
      printf(strchr(special, *text) != NULL ? "\\%c" : "%c", *text);
    }
  }
}

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
  const struct cli_option *argument = argument_of(command);
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

/* Action of zsh's _arguments. */
static void print_zsh_action(const struct cli_option *option)
{
  const struct cli_kind_info *kind = &cli_kinds[option->kind];
  printf(":%s:", option->value);
  if (kind->name != NULL) {
    printf("{compadd -- ${(f)\"$(dea completion names %s 2>/dev/null)\"}}", kind->name);
  } else if (kind->folder) {
    fputs("_files -/", stdout);
  } else if (kind->outcome != NULL) {
    printf("_files -g \"*.%s\"", kind->outcome);
  } else {
    fputs("_files", stdout);
  }
}

static void print_zsh_option(const struct cli_option *option)
{
  const char letter[] = {option->letter, '\0'}, *const forms[] = {letter, option->name};
  for (size_t i = option->letter != 0 ? 0 : 1; i < 2; i++) {
    printf(" \\\n        '*%s%s[", i == 0 ? "-" : "--", forms[i]);
    print_quoted(option->help, "[]:\\");
    putchar(']');
    if (option->kind != CLI_FLAG) {
      print_zsh_action(option);
    }
    putchar('\'');
  }
}

static void print_zsh(const struct dea_cli *cli)
{
  puts("#compdef dea\n# zsh completion for dea; to use it now: source <(dea completion zsh)\n"
       "_dea()\n{\n  local -a commands\n  if ((CURRENT == 2)); then\n    commands=(");
  for (size_t i = 0; cli->commands[i] != NULL; i++) {
    printf("      '%s:", cli->commands[i]->name);
    print_quoted(cli->commands[i]->summary, ":\\");
    puts("'");
  }
  puts("    )\n    _describe command commands\n    return\n  fi\n"
       "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in");
  for (size_t i = 0; cli->commands[i] != NULL; i++) {
    const struct cli_option *const tables[] = {cli->commands[i]->options, cli_common_options};
    const struct cli_option *argument = argument_of(cli->commands[i]);
    printf("    %s)\n      _arguments", cli->commands[i]->name);
    for (size_t k = 0; k < 2; k++) {
      for (const struct cli_option *o = tables[k]; o->help != NULL; o++) {
        if (o->name != NULL) {
          print_zsh_option(o);
        }
      }
    }
    if (argument->help != NULL) {
      fputs(" \\\n        '*", stdout);
      print_zsh_action(argument);
      putchar('\'');
    }
    puts(" ;;");
  }
  puts("  esac\n}\nif [[ $funcstack[1] == _dea ]]; then\n  _dea \"$@\"\nelse\n  compdef _dea "
       "dea\nfi");
}

static void print_fish_option(const char *condition, const struct cli_option *option)
{
  const struct cli_kind_info *kind = &cli_kinds[option->kind];
  printf("complete -c dea%s", condition);
  if (option->letter != 0) {
    printf(" -s %c", option->letter);
  }
  if (option->name != NULL) {
    printf(" -l %s", option->name);
  }
  if (kind->name != NULL) {
    printf(" -x -a '(dea completion names %s 2>/dev/null)'", kind->name);
  } else if (kind->folder) {
    fputs(" -x -a '(__fish_complete_directories)'", stdout);
  } else if (kind->outcome != NULL) {
    printf(" -k -x -a '(__fish_complete_suffix .%s)'", kind->outcome);
  } else if (option->kind != CLI_FLAG) {
    fputs(" -r -F", stdout);
  }
  if (option->name != NULL) {
    fputs(" -d '", stdout);
    print_quoted(option->help, "\\");
    putchar('\'');
  }
  putchar('\n');
}

static void print_fish(const struct dea_cli *cli)
{
  puts("# fish completion for dea; to use it now: dea completion fish | source\n"
       "complete -c dea -f");
  for (size_t i = 0; cli->commands[i] != NULL; i++) {
    char condition[128];
    snprintf(condition, sizeof condition, " -n '__fish_seen_subcommand_from %s'",
             cli->commands[i]->name);
    printf("complete -c dea -n __fish_use_subcommand -a %s -d '", cli->commands[i]->name);
    print_quoted(cli->commands[i]->summary, "\\");
    puts("'");
    for (const struct cli_option *o = cli->commands[i]->options; o->help != NULL; o++) {
      print_fish_option(condition, o);
    }
  }
  for (const struct cli_option *o = cli_common_options; o->help != NULL; o++) {
    print_fish_option("", o);
  }
}

static dea_status print_names(struct dea_cli *cli, const char *what)
{
  struct dea_text out = {.ctx = cli->ctx};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < CLI_KINDS; i++) {
    if (cli_kinds[i].list != NULL && strcmp(cli_kinds[i].name, what) == 0) {
      status = cli_kinds[i].list(cli, &out);
    }
  }
  return cli_print_text(status, &out);
}

static int run(struct dea_cli *cli, void *request)
{
  static const struct {
    const char *name;
    void (*print)(const struct dea_cli *cli);
  } outputs[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};
  const struct cli_words *words = &((const struct request *)request)->words;
  const char *shell = words->at[0];
  if (words->count == 2 && strcmp(shell, "names") == 0) { // for the completions themselves
    return cli_report(cli, print_names(cli, words->at[1]));
  }
  if (words->count == 1 && strcmp(shell, "man") == 0) {
    return cli_report(cli, cli_print_manual(cli));
  }
  for (size_t i = 0; i < sizeof outputs / sizeof outputs[0] && words->count == 1; i++) {
    if (strcmp(shell, outputs[i].name) == 0) {
      outputs[i].print(cli);
      return 0;
    }
  }
  return words->count > 1
             ? cli_usage_error(cli, &cmd_completion, "name one shell: bash, zsh or fish")
             : cli_usage_error(cli, &cmd_completion,
                               "'%s' is not a shell that is known here (bash, zsh, fish)", shell);
}

static const struct cli_option options[] = {
    CLI_MANY(CLI_SHELL, "SHELL", "the shell, or 'man' for the manual page", words, 2,
             "name one shell: bash, zsh or fish", "name one shell: bash, zsh or fish"),
    {0}};

const struct dea_command cmd_completion = {.name = "completion",
                                           .summary = "Print the completion for a shell",
                                           .about = "bash:  source <(dea completion bash)\n"
                                                    "zsh:   source <(dea completion zsh)\n"
                                                    "fish:  dea completion fish | source",
                                           CLI_RUN};
