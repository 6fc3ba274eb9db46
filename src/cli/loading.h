/* SPDX-License-Identifier: Apache-2.0 */
/* Loading a library whose own libraries start threads as soon as they are there. */
#ifndef TETCAST_CLI_LOADING_H
#define TETCAST_CLI_LOADING_H

/* dlopen(), with all names resolved, none of them for others. */
void *cli_load_library(const char *path);

#endif
