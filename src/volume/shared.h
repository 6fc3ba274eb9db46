/* SPDX-License-Identifier: Apache-2.0 */
/* The things that scenes of a volume share: each was made once and counts its users. All functions may be called from
 * several threads at a time. */
#ifndef TC_VOLUME_SHARED_H
#define TC_VOLUME_SHARED_H

#include "base/base.h"

/* What every shared thing contains. */
typedef struct TcSharedEntry {
  void *thing; /* the thing that contains it */
  int64_t serial, users;
  size_t bytes;
  struct TcSharedEntry *next;
} TcSharedEntry;

typedef struct TcShared TcShared;

TetcastStatus tc_shared_create(TetcastContext *context, TcShared **shared);
/* Frees the list. No thing may be in use any more. NULL does nothing. */
void tc_shared_destroy(TcShared *shared);
size_t tc_shared_bytes(TcShared *shared);

/* Adds a thing with one user. Others find it by its serial number; with 0 it can't be found. */
void tc_shared_add(TcShared *shared, TcSharedEntry *entry, void *thing, int64_t serial, size_t bytes);
/* Finds the thing with this serial number and counts one user more. NULL if there is none. */
void *tc_shared_find(TcShared *shared, int64_t serial);
/* Counts one user more. */
void tc_shared_retain(TcShared *shared, TcSharedEntry *entry);
/* Counts one user less. True if it was the last: the thing can't be found any more, and the caller frees it. */
bool tc_shared_release(TcShared *shared, TcSharedEntry *entry);

#endif
