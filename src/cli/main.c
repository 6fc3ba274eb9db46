/* SPDX-License-Identifier: Apache-2.0 */
#include <getopt.h>
#include <stdio.h>
#include <string.h>

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
                                "  info INPUT     show what is in a mesh file\n"
                                "  mesh SURFACE   fill a closed surface with tetrahedra\n"
                                "\n"
                                "  -h, --help     show this text; tetcast COMMAND --help shows a command's options\n"
                                "      --version  show versions and which adapters are in\n"
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

int main(int argc, char **argv) {
  static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
  } commands[] = {{"render", tetcast_cli_render},
                  {"converge", tetcast_cli_converge},
                  {"info", tetcast_cli_info},
                  {"mesh", tetcast_cli_mesh}};

  cli_interrupt_catch();
  opterr = 0;
  if (argc < 2)
    return cli_usage_error("", "no command given: render, converge, info or mesh");
  const char *word = argv[1];
  for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
    if (!strcmp(word, commands[i].name))
      return commands[i].run(argc - 1, argv + 1);
  if (!strcmp(word, "--version"))
    return show_version();
  if (!strcmp(word, "--help") || !strcmp(word, "-h")) {
    fputs(help_text, stdout);
    return cli_finish_output();
  }
  return cli_usage_error("", "unknown %s '%s'", word[0] == '-' ? "option" : "command", word);
}
