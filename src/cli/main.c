/* SPDX-License-Identifier: Apache-2.0 */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <tetcast/tetcast.h>

#include "cli.h"
#include "progress.h"

static const char help_text[] = "Usage: tetcast COMMAND [options]\n"
                                "\n"
                                "Renders scalar fields on unstructured meshes by casting rays through tetrahedra,\n"
                                "integrating emission and absorption exactly.\n"
                                "\n"
                                "Commands:\n"
                                "  render INPUT   make a picture of a mesh file\n"
                                "  converge INPUT measure error against run time, with plots\n"
                                "  transfer INPUT propose transfer functions, with a sheet of pictures\n"
                                "  cast INPUT     what rays of a list gather and cross, as numbers\n"
                                "  info INPUT     show what is in a mesh file\n"
                                "  mesh SURFACE   fill a closed surface with tetrahedra\n"
                                "  completion SHELL  print what bash, zsh or fish need to complete a command line\n"
                                "\n"
                                "  -h, --help     show this text; tetcast help COMMAND shows a command's options\n"
                                "  -V, --version  show versions and which adapters are in\n"
                                "\n"
                                "Example:\n"
                                "  tetcast render flow.vtu -o flow.png\n";

static int show_version(void) {
  printf("tetcast %s\n", tetcast_version_string());
  printf("Embree %s\n", tetcast_embree_version_string());
  printf("adapters:%s\n", *CLI_ADAPTERS ? " " CLI_ADAPTERS : " none");
  printf("build: %s, %s\n", CLI_BUILD_TYPE, CLI_COMPILER);
  return cli_finish_output();
}

typedef struct Command {
  const char *name;
  int (*run)(int argc, char **argv);
} Command;

static const Command commands[] = {{"render", tetcast_cli_render},
                                   {"converge", tetcast_cli_converge},
                                   {"transfer", tetcast_cli_transfer},
                                   {"cast", tetcast_cli_cast},
                                   {"info", tetcast_cli_info},
                                   {"mesh", tetcast_cli_mesh},
                                   {"completion", tetcast_cli_completion}};
enum { COMMANDS = sizeof commands / sizeof *commands };

static const Command *find_command(const char *name) {
  for (int i = 0; i < COMMANDS; i++)
    if (!strcmp(name, commands[i].name))
      return &commands[i];
  return NULL;
}

static int show_help(void) {
  fputs(help_text, stdout);
  return cli_finish_output();
}

static int refuse(const char *word) {
  CliGuess guess = {.word = word};
  cli_guess(&guess, "help");
  cli_guess(&guess, "--help");
  cli_guess(&guess, "--version");
  for (int i = 0; i < COMMANDS; i++)
    cli_guess(&guess, commands[i].name);
  char *hint = word[0] != '-' && access(word, F_OK) == 0 ? cli_print("; did you mean tetcast render %s?", word)
                                                         : cli_guess_text(&guess);
  const int code = cli_usage_error("", "unknown %s '%s'%s", word[0] == '-' ? "option" : "command", word, hint);
  free(hint);
  return code;
}

/* tetcast help, tetcast help COMMAND. */
static int help(int argc, char **argv) {
  if (argc < 2)
    return show_help();
  const Command *command = find_command(argv[1]);
  char option[] = "--help", *words[] = {argv[1], option, NULL};
  return command ? command->run(2, words) : refuse(argv[1]);
}

int main(int argc, char **argv) {
  cli_interrupt_catch();
  opterr = 0;
  if (argc < 2)
    return cli_usage_error("", "no command given: render, converge, transfer, cast, info or mesh");
  const char *word = argv[1];
  const Command *command = find_command(word);
  if (command)
    return command->run(argc - 1, argv + 1);
  if (!strcmp(word, "--version") || !strcmp(word, "-V"))
    return show_version();
  if (!strcmp(word, "--help") || !strcmp(word, "-h"))
    return show_help();
  return !strcmp(word, "help") ? help(argc - 1, argv + 1) : refuse(word);
}
