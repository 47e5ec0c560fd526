#include "cli/usage.h"

#include <ctype.h>
#include <string.h>

const struct cli_option cli_common_options[CLI_COMMON_COUNT] = {
    {"-q", "--quiet", "", "no progress, no notes"},
    {"-v", "--verbose", "", "say more about an error"},
    {"-h", "--help", "", "say how the command is used"},
};

const struct dea_command *const *cli_commands(size_t *count)
{
  static const struct dea_command *const commands[] = {
#define COMMAND_ROW(name) &name,
      DEA_COMMAND_LIST(COMMAND_ROW)
#undef COMMAND_ROW
  };
  *count = sizeof commands / sizeof commands[0];
  return commands;
}

/* Copies the word at `text` (up to white space or one of "],|=[") into `word`; returns its length.
 */
static size_t take_word(const char *text, char word[CLI_WORD_SIZE])
{
  size_t n = strcspn(text, " \t\n],|=[");
  size_t kept = n < CLI_WORD_SIZE ? n : CLI_WORD_SIZE - 1;
  memcpy(word, text, kept);
  word[kept] = '\0';
  return n;
}

/* True for a word in capitals that stands for a value: "DIR", "KEY". */
static bool is_value(const char *word)
{
  size_t n = strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_");
  return n >= 1 && word[n] == '\0';
}

static bool is_option(const char *text)
{
  return text[0] == '-' &&
         (isalpha((unsigned char)text[1]) || (text[1] == '-' && isalpha((unsigned char)text[2])));
}

/* Option that has one of these two names, or a new one; NULL when there is no more room. */
static struct cli_option *find_option(struct cli_usage *usage, const struct cli_option *like)
{
  for (size_t i = 0; i < usage->option_count; i++) {
    struct cli_option *option = &usage->options[i];
    if ((like->name[0] != '\0' && strcmp(option->name, like->name) == 0) ||
        (like->letter[0] != '\0' && strcmp(option->letter, like->letter) == 0)) {
      return option;
    }
  }
  return usage->option_count < CLI_OPTIONS_MAX ? &usage->options[usage->option_count++] : NULL;
}

static void fill(char *to, const char *from)
{
  if (to[0] == '\0') {
    strcpy(to, from);
  }
}

/* Reads "-o, --output DIR" at `text`; returns what follows. */
static const char *take_option(struct cli_usage *usage, const char *text)
{
  struct cli_option found = {.name = ""};
  while (is_option(text)) {
    char word[CLI_WORD_SIZE];
    text += take_word(text, word);
    strcpy(word[1] == '-' ? found.name : found.letter, word);
    bool more = text[0] == ',' || text[0] == '|';
    const char *next = text + strspn(text, more ? ",| " : "=[ ");
    if (!more || !is_option(next)) {
      // One separator before the value, two spaces or more before an explanation.
      size_t length = next - text == 1 ? take_word(next, word) : 0;
      if (length > 0 && is_value(word)) {
        strcpy(found.value, word);
        text = next + length;
        text += text[0] == '=' ? strcspn(text, " \t\n]") : 0; // KEY=VALUE
      }
      break;
    }
    text = next;
  }
  struct cli_option *option = find_option(usage, &found);
  if (option != NULL) {
    fill(option->letter, found.letter);
    fill(option->name, found.name);
    fill(option->value, found.value);
  }
  return text;
}

static void add_argument(struct cli_usage *usage, const char *word)
{
  for (size_t i = 0; i < usage->argument_count; i++) {
    if (strcmp(usage->arguments[i], word) == 0) {
      return;
    }
  }
  if (usage->argument_count < CLI_OPTIONS_MAX) {
    strcpy(usage->arguments[usage->argument_count++], word);
  }
}

/* One line of the synopsis: options and, in capitals, arguments. */
static void read_synopsis(struct cli_usage *usage, const char *line, const char *end)
{
  while (line < end) {
    char word[CLI_WORD_SIZE];
    if (is_option(line)) {
      line = take_option(usage, line);
      continue;
    }
    size_t n = take_word(line, word);
    if (n > 0 && word[n - 1] == '.') {
      word[strcspn(word, ".")] = '\0'; // "FILE..."
    }
    if (is_value(word)) {
      add_argument(usage, word);
    }
    line += n > 0 ? n : 1;
  }
}

/* One line "  -o, --output DIR  explanation". */
static void read_option_line(struct cli_usage *usage, const char *line, const char *end)
{
  size_t before = usage->option_count;
  const char *rest = take_option(usage, line);
  char word[CLI_WORD_SIZE];
  struct cli_option like = {.name = ""};
  take_word(line, word);
  strcpy(word[1] == '-' ? like.name : like.letter, word);
  struct cli_option *option =
      usage->option_count > before ? &usage->options[before] : find_option(usage, &like);
  rest += strspn(rest, " ");
  if (option != NULL && rest < end) {
    size_t n = (size_t)(end - rest);
    n = n < CLI_EXPLANATION_SIZE ? n : CLI_EXPLANATION_SIZE - 1;
    memcpy(option->explanation, rest, n);
    option->explanation[n] = '\0';
  }
}

void cli_usage_read(const struct dea_command *command, struct cli_usage *usage)
{
  *usage = (struct cli_usage){.option_count = 0};
  bool synopsis = true;
  for (const char *line = command->usage; *line != '\0';) {
    size_t length = strcspn(line, "\n");
    const char *start = line + strspn(line, " "), *end = line + length;
    if (length == 0) {
      synopsis = false;
    } else if (is_option(start) && start > line) {
      read_option_line(usage, start, end); // also right below a synopsis without a blank line
    } else if (synopsis) {
      read_synopsis(usage, start, end);
    }
    line += length + (line[length] == '\n');
  }
}
