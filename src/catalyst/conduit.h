/* SPDX-License-Identifier: Apache-2.0 */
/* Nodes of the Conduit that has loaded this library. Neither its headers nor Catalyst's are needed to build: what is
 * used of its C interface is found by name at run time, mangled as Catalyst's own copy is (catalyst_conduit_node_…) or
 * not (conduit_node_…). */
#ifndef TETCAST_CATALYST_CONDUIT_H
#define TETCAST_CATALYST_CONDUIT_H

#include "view.h"

typedef void ConduitNode;

/* Finds the functions in the library that holds this address, in those that it is linked with, or in those that all of
 * the process see. False after a message. */
bool conduit_bind(void *caller);

/* What lies at a path; NULL: nothing, or `node` is NULL. */
ConduitNode *conduit_at(const ConduitNode *node, const char *path);

int64_t conduit_children(const ConduitNode *node);
ConduitNode *conduit_child(const ConduitNode *node, int64_t i);
bool conduit_is_list(const ConduitNode *node);

/* Its own name, for free(): "" for a child of a list. */
char *conduit_name(const ConduitNode *node);

/* The text of a node, which owns it; NULL: it has none. */
const char *conduit_text(const ConduitNode *node);

/* The numbers of a leaf. False: it is none, or NULL. */
bool conduit_view(const ConduitNode *node, View *view);

/* The first number of a leaf. False: it has none. */
bool conduit_number(const ConduitNode *node, double *value);
bool conduit_integer(const ConduitNode *node, int64_t *value);

/* Sets what lies at a path. */
void conduit_set_text(ConduitNode *node, const char *path, const char *text);
void conduit_set_integer(ConduitNode *node, const char *path, int64_t value);
void conduit_set_number(ConduitNode *node, const char *path, double value);

#endif
