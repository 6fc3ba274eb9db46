/* SPDX-License-Identifier: Apache-2.0 */
/* tetcast completion: the scripts by which bash, zsh and fish complete a command line, made from the tables of options.
 */
#include "completion.h"

#include <stdio.h>
#include <string.h>

#include "cli.h"

static const struct {
  const char *name;
  int (*options)(CompletionOption list[COMPLETION_OPTIONS]);
} commands[] = {{"render", completion_of_render},     {"converge", completion_of_converge},
                {"transfer", completion_of_transfer}, {"cast", completion_of_cast},
                {"info", completion_of_info},         {"mesh", completion_of_mesh}};
enum { COMMANDS = sizeof commands / sizeof *commands };

/* The first words of a command line, and what two of them go on with. */
static const char first[] = "render converge transfer cast info mesh completion help",
                  helped[] = "render converge transfer cast info mesh completion", shells[] = "bash zsh fish";

/* "a b c"; `colon` stands for one. */
static void put_words(const char *const *words, const char *colon) {
  const char *separator = "";
  for (; *words; words++) {
    if (!**words) /* of a choice the one that stands for none */
      continue;
    fputs(separator, stdout);
    separator = " ";
    for (const char *c = *words; *c; c++)
      if (*c == ':')
        fputs(colon, stdout);
      else
        putchar(*c);
  }
}

/* ── bash ── */

static void put_bash_command(int number) {
  CompletionOption list[COMPLETION_OPTIONS];
  const int count = commands[number].options(list);
  const char *name = commands[number].name;
  for (int i = 0; i < count; i++) {
    if (list[i].kind == COMPLETION_FLAG)
      continue;
    printf("    '%s --%s'", name, list[i].name);
    if (list[i].letter)
      printf(" | '%s -%c'", name, list[i].letter);
    fputs(") words='", stdout);
    if (list[i].words)
      put_words(list[i].words, ":");
    fputs("' ;;\n", stdout);
  }
  printf("    '%s '*) [[ $current != -* ]] || words='", name);
  for (int i = 0; i < count; i++)
    printf("%s--%s", i > 0 ? " " : "", list[i].name);
  fputs("' ;;\n", stdout);
}

static void put_bash(void) {
  printf(
      "# tetcast: completion for bash, made by \"tetcast completion bash\"\n"
      "_tetcast() {\n"
      "  local command=${COMP_WORDS[1]} current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words=\n"
      "  COMPREPLY=()\n"
      "  [[ $current != '=' ]] || current=\n"
      "  [[ $before != '=' ]] || before=${COMP_WORDS[COMP_CWORD-2]}\n"
      "  if [[ $COMP_CWORD == 1 ]]; then command= before=tetcast; fi\n"
      "  case \"$command $before\" in\n"
      "    ' tetcast') words='%s --help --version' ;;\n"
      "    'help '*) words='%s' ;;\n"
      "    'completion '*) words='%s' ;;\n",
      first, helped, shells);
  for (int i = 0; i < COMMANDS; i++)
    put_bash_command(i);
  fputs("  esac\n"
        "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
        "}\n"
        "complete -o default -F _tetcast tetcast # by default: files\n",
        stdout);
}

/* ── zsh ── */

static void put_zsh_option(const CompletionOption *option, const char *dashes, const char *name, const char *sign) {
  printf(" \\\n        '%s%s", dashes, name);
  if (option->kind != COMPLETION_FLAG)
    printf("%s:%s:", sign, option->name);
  if (option->kind == COMPLETION_PATH && option->words) {
    fputs("{compadd -- ", stdout);
    put_words(option->words, "\\:");
    fputs("; _files}", stdout);
  } else if (option->kind == COMPLETION_PATH) {
    fputs("_files", stdout);
  } else if (option->words) {
    putchar('(');
    put_words(option->words, "\\:");
    putchar(')');
  }
  putchar('\'');
}

static void put_zsh(void) {
  printf("#compdef tetcast\n"
         "# tetcast: completion for zsh, made by \"tetcast completion zsh\"\n"
         "_tetcast() {\n"
         "  if (( CURRENT == 2 )); then\n"
         "    compadd -- %s --help --version\n"
         "    return\n"
         "  fi\n"
         "  local command=$words[2]\n"
         "  shift words\n"
         "  (( CURRENT-- ))\n"
         "  case $command in\n"
         "    help) compadd -- %s ;;\n"
         "    completion) compadd -- %s ;;\n",
         first, helped, shells);
  for (int c = 0; c < COMMANDS; c++) {
    CompletionOption list[COMPLETION_OPTIONS];
    const int count = commands[c].options(list);
    printf("    %s)\n      _arguments", commands[c].name);
    for (int i = 0; i < count; i++) {
      const char letter[] = {list[i].letter, '\0'};
      put_zsh_option(&list[i], "--", list[i].name, "=");
      if (*letter)
        put_zsh_option(&list[i], "-", letter, "");
    }
    fputs(" \\\n        '*:input:_files' ;;\n", stdout);
  }
  fputs("  esac\n}\n_tetcast \"$@\"\n", stdout);
}

/* ── fish ── */

static void put_fish(void) {
  printf("# tetcast: completion for fish, made by \"tetcast completion fish\"\n"
         "complete -c tetcast -n __fish_use_subcommand -x -a '%s'\n"
         "complete -c tetcast -n __fish_use_subcommand -l help -s h\n"
         "complete -c tetcast -n __fish_use_subcommand -l version -s V\n"
         "complete -c tetcast -n '__fish_seen_subcommand_from help' -x -a '%s'\n"
         "complete -c tetcast -n '__fish_seen_subcommand_from completion' -x -a '%s'\n",
         first, helped, shells);
  for (int c = 0; c < COMMANDS; c++) {
    CompletionOption list[COMPLETION_OPTIONS];
    const int count = commands[c].options(list);
    for (int i = 0; i < count; i++) {
      printf("complete -c tetcast -n '__fish_seen_subcommand_from %s' -l %s", commands[c].name, list[i].name);
      if (list[i].letter)
        printf(" -s %c", list[i].letter);
      if (list[i].kind != COMPLETION_FLAG)
        fputs(list[i].kind == COMPLETION_PATH ? " -r -F" : " -x", stdout);
      if (list[i].words) {
        fputs(" -a '", stdout);
        put_words(list[i].words, ":");
        putchar('\'');
      }
      putchar('\n');
    }
  }
}

int tetcast_cli_completion(int argc, char **argv) {
  static const struct {
    const char *name;
    void (*put)(void);
  } known[] = {{"bash", put_bash}, {"zsh", put_zsh}, {"fish", put_fish}};
  if (argc == 2 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) {
    fputs("Usage: tetcast completion bash|zsh|fish\n"
          "\n"
          "Prints the script by which the shell completes commands, options and their values. An\n"
          "installed tetcast has it where the shell looks for it; elsewhere it is read at the start.\n"
          "\n"
          "Example:\n"
          "  source <(tetcast completion bash)\n",
          stdout);
    return cli_finish_output();
  }
  for (int i = 0; argc == 2 && i < 3; i++)
    if (!strcmp(argv[1], known[i].name)) {
      known[i].put();
      return cli_finish_output();
    }
  return cli_usage_error("completion", "expected bash, zsh or fish");
}
