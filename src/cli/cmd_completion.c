/* Completion for shells, out of the table of commands and their usage texts. */
#include "cli/cli.h"
#include "cli/data_files.h"
#include "cli/usage.h"
#include "material/catalogue.h"
#include "model/model.h"

#include <string.h>

/* What may stand where a usage text has a word in capitals. */
struct kind {
  const char *words;  // that mean it, each between spaces
  const char *names;  // argument of "dea completion names" that lists the candidates, or NULL
  const char *ending; // of files, or NULL for any file
  bool folder;
};

static const struct kind kinds[] = {
    {" DESIGN ", NULL, "yaml", false},           {" CSV ", NULL, "csv", false},
    {" DIR RUN FOLDER ", NULL, NULL, true},      {" MATERIAL ", "materials", NULL, false},
    {" EXAMPLE ", "examples", NULL, false},      {" MODEL ", "models", NULL, false},
    {" SHELL ", "shells", NULL, false},          {" COMMAND ", "commands", NULL, false},
    {" KEY VALUE N X ", "nothing", NULL, false},
};
static const struct kind any_file = {"", NULL, NULL, false};

/* Kind that a word in capitals means. For "NAME" the hint says of what: the name of the option that
 * it follows ("model") or of the command ("materials"). */
static const struct kind *kind_of(const char *word, const char *hint)
{
  bool by_hint = strcmp(word, "NAME") == 0 && hint[0] != '\0';
  for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
    const struct kind *kind = &kinds[i];
    const char *at = strstr(kind->words, word);
    if (by_hint ? kind->names != NULL && strncmp(kind->names, hint, strlen(hint)) == 0
                : at != NULL && at > kind->words && at[-1] == ' ' && at[strlen(word)] == ' ') {
      return kind;
    }
  }
  return &any_file;
}

static const struct kind *kind_of_option(const struct cli_option *option)
{
  return kind_of(option->value, option->name[0] != '\0' ? option->name + 2 : "");
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

static void print_bash_candidates(const struct kind *kind)
{
  if (kind->names != NULL) {
    printf("_dea_take -W \"$(dea completion names %s 2>/dev/null)\"", kind->names);
  } else {
    printf("compopt -o filenames; _dea_take %s", kind->folder ? "-d" : "-f");
  }
}

static void print_bash_command(const struct dea_command *command)
{
  struct cli_usage usage;
  cli_usage_read(command, &usage);
  printf("    %s)\n      options='", command->name);
  for (size_t i = 0; i < usage.option_count; i++) {
    printf("%s %s ", usage.options[i].letter, usage.options[i].name);
  }
  for (size_t i = 0; i < CLI_COMMON_COUNT; i++) {
    printf("%s%s", i > 0 ? " " : "", cli_common_options[i].name);
  }
  puts("'\n      case $before in");
  for (size_t i = 0; i < usage.option_count; i++) {
    const struct cli_option *option = &usage.options[i];
    if (option->value[0] != '\0') {
      bool both = option->letter[0] != '\0' && option->name[0] != '\0';
      printf("        %s%s%s) ", option->letter, both ? " | " : "", option->name);
      print_bash_candidates(kind_of_option(option));
      puts("; return ;;");
    }
  }
  fputs("      esac\n      [[ $word == -* ]] || { ", stdout);
  if (usage.argument_count > 0) {
    print_bash_candidates(kind_of(usage.arguments[0], command->name));
  } else {
    fputs("COMPREPLY=()", stdout);
  }
  puts("; return; } ;;");
}

static void print_bash(void)
{
  size_t count;
  const struct dea_command *const *commands = cli_commands(&count);
  puts("# bash completion for dea; to use it now: source <(dea completion bash)\n"
       "_dea_take()\n{\n  mapfile -t COMPREPLY < <(compgen \"$@\" -- "
       "\"${COMP_WORDS[COMP_CWORD]}\")\n}\n"
       "_dea()\n{\n"
       "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options=''\n"
       "  if ((COMP_CWORD == 1)); then\n"
       "    _dea_take -W \"$(dea completion names commands 2>/dev/null) --help --version\"\n"
       "    return\n  fi\n"
       "  case ${COMP_WORDS[1]} in");
  for (size_t i = 0; i < count; i++) {
    print_bash_command(commands[i]);
  }
  puts("  esac\n  _dea_take -W \"$options\"\n}\ncomplete -F _dea dea");
}

/* Action of zsh's _arguments for one kind. */
static void print_zsh_action(const char *word, const struct kind *kind)
{
  printf(":%s:", word);
  if (kind->names != NULL) {
    printf("{compadd -- ${(f)\"$(dea completion names %s 2>/dev/null)\"}}", kind->names);
  } else if (kind->folder) {
    fputs("_files -/", stdout);
  } else if (kind->ending != NULL) {
    printf("_files -g \"*.%s\"", kind->ending);
  } else {
    fputs("_files", stdout);
  }
}

static void print_zsh_option(const struct cli_option *option)
{
  const char *const forms[] = {option->letter, option->name};
  for (size_t i = 0; i < 2; i++) {
    if (forms[i][0] != '\0') {
      printf(" \\\n        '*%s[", forms[i]);
      print_quoted(option->explanation, "[]:\\");
      putchar(']');
      if (option->value[0] != '\0') {
        print_zsh_action(option->value, kind_of_option(option));
      }
      putchar('\'');
    }
  }
}

static void print_zsh(void)
{
  size_t count;
  const struct dea_command *const *commands = cli_commands(&count);
  puts("#compdef dea\n# zsh completion for dea; to use it now: source <(dea completion zsh)\n"
       "_dea()\n{\n  local -a commands\n  if ((CURRENT == 2)); then\n    commands=(");
  for (size_t i = 0; i < count; i++) {
    printf("      '%s:", commands[i]->name);
    print_quoted(commands[i]->summary, ":\\");
    puts("'");
  }
  puts("    )\n    _describe command commands\n    return\n  fi\n"
       "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in");
  for (size_t i = 0; i < count; i++) {
    struct cli_usage usage;
    cli_usage_read(commands[i], &usage);
    printf("    %s)\n      _arguments", commands[i]->name);
    for (size_t j = 0; j < usage.option_count; j++) {
      print_zsh_option(&usage.options[j]);
    }
    for (size_t j = 0; j < CLI_COMMON_COUNT; j++) {
      print_zsh_option(&cli_common_options[j]);
    }
    if (usage.argument_count > 0) {
      fputs(" \\\n        '*", stdout);
      print_zsh_action(usage.arguments[0], kind_of(usage.arguments[0], commands[i]->name));
      putchar('\'');
    }
    puts(" ;;");
  }
  puts("  esac\n}\nif [[ $funcstack[1] == _dea ]]; then\n  _dea \"$@\"\nelse\n  compdef _dea "
       "dea\nfi");
}

static void print_fish_kind(const struct kind *kind)
{
  if (kind->names != NULL) {
    printf(" -x -a '(dea completion names %s 2>/dev/null)'", kind->names);
  } else if (kind->folder) {
    fputs(" -x -a '(__fish_complete_directories)'", stdout);
  } else if (kind->ending != NULL) {
    printf(" -k -x -a '(__fish_complete_suffix .%s)'", kind->ending);
  } else {
    fputs(" -r -F", stdout);
  }
}

static void print_fish_option(const char *condition, const struct cli_option *option)
{
  printf("complete -c dea%s", condition);
  if (option->letter[0] != '\0') {
    printf(" -s %s", option->letter + 1);
  }
  if (option->name[0] != '\0') {
    printf(" -l %s", option->name + 2);
  }
  if (option->value[0] != '\0') {
    print_fish_kind(kind_of_option(option));
  }
  fputs(" -d '", stdout);
  print_quoted(option->explanation, "\\");
  puts("'");
}

static void print_fish(void)
{
  size_t count;
  const struct dea_command *const *commands = cli_commands(&count);
  puts("# fish completion for dea; to use it now: dea completion fish | source\n"
       "complete -c dea -f");
  for (size_t i = 0; i < count; i++) {
    struct cli_usage usage;
    char condition[128];
    cli_usage_read(commands[i], &usage);
    snprintf(condition, sizeof condition, " -n '__fish_seen_subcommand_from %s'",
             commands[i]->name);
    printf("complete -c dea -n __fish_use_subcommand -a %s -d '", commands[i]->name);
    print_quoted(commands[i]->summary, "\\");
    puts("'");
    for (size_t j = 0; j < usage.option_count; j++) {
      print_fish_option(condition, &usage.options[j]);
    }
    if (usage.argument_count > 0) {
      printf("complete -c dea%s", condition);
      print_fish_kind(kind_of(usage.arguments[0], commands[i]->name));
      puts("");
    }
  }
  for (size_t j = 0; j < CLI_COMMON_COUNT; j++) {
    print_fish_option("", &cli_common_options[j]);
  }
}

static dea_status print_example_names(struct dea_context *ctx)
{
  struct cli_data_list list;
  dea_status status = cli_examples_find(ctx, ".yaml", &list);
  for (size_t i = 0; i < list.count && status == DEA_OK; i++) {
    printf("%.*s\n", (int)cli_data_stem(list.files[i].name), list.files[i].name);
  }
  cli_data_free(ctx, &list);
  return status;
}

static dea_status print_material_names(struct dea_context *ctx)
{
  const char **names;
  size_t count;
  DEA_TRY(ctx, dea_catalogue_names(ctx, &names, &count));
  for (size_t i = 0; i < count; i++) {
    puts(names[i]);
  }
  dea_free(ctx, names);
  return DEA_OK;
}

static dea_status print_names(struct dea_context *ctx, const char *what)
{
  size_t count;
  if (strcmp(what, "commands") == 0) {
    const struct dea_command *const *commands = cli_commands(&count);
    for (size_t i = 0; i < count; i++) {
      puts(commands[i]->name);
    }
  } else if (strcmp(what, "models") == 0) {
    const struct dea_model_type *const *models = dea_model_all(&count);
    for (size_t i = 0; i < count; i++) {
      puts(models[i]->name);
    }
  } else if (strcmp(what, "shells") == 0) {
    puts("bash\nzsh\nfish");
  } else if (strcmp(what, "examples") == 0) {
    return print_example_names(ctx);
  } else if (strcmp(what, "materials") == 0) {
    return print_material_names(ctx);
  }
  return DEA_OK;
}

static int run(struct dea_cli *cli, int argc, char **argv)
{
  static const struct {
    const char *name;
    void (*print)(void);
  } outputs[] = {
      {"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}, {"man", cli_print_manual}};
  if (argc == 3 && strcmp(argv[1], "names") == 0) { // for the completions themselves
    return cli_report(cli, print_names(cli->ctx, argv[2]));
  }
  if (argc != 2) {
    return cli_usage_error(cli, &cmd_completion, "name one shell: bash, zsh or fish");
  }
  for (size_t i = 0; i < sizeof outputs / sizeof outputs[0]; i++) {
    if (strcmp(argv[1], outputs[i].name) == 0) {
      outputs[i].print();
      return 0;
    }
  }
  return cli_usage_error(cli, &cmd_completion,
                         "'%s' is not a shell that is known here (bash, zsh, fish)", argv[1]);
}

const struct dea_command cmd_completion = {
    .name = "completion",
    .summary = "Print the completion for a shell",
    .usage = "dea completion SHELL\n"
             "\n"
             "  SHELL  bash, zsh or fish; 'man' prints the manual page instead\n"
             "\n"
             "bash:  source <(dea completion bash)\n"
             "zsh:   source <(dea completion zsh)\n"
             "fish:  dea completion fish | source\n",
    .run = run,
};
