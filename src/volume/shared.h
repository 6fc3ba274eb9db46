/* SPDX-License-Identifier: Apache-2.0 */
/* What scenes of a volume have in common and use now: things that were made once, each with the number of its users.
 * All functions may be called from several threads at a time. */
#ifndef TC_VOLUME_SHARED_H
#define TC_VOLUME_SHARED_H

#include "base/base.h"

/* A part of what is shared. */
typedef struct TcSharedEntry {
  void *thing; /* that it is a part of */
  int64_t serial, users;
  size_t bytes;
  struct TcSharedEntry *next;
} TcSharedEntry;

typedef struct TcShared TcShared;

TetcastStatus tc_shared_create(TetcastContext *context, TcShared **shared);
/* Nothing may be in use any more. NULL does nothing. */
void tc_shared_destroy(TcShared *shared);
size_t tc_shared_bytes(TcShared *shared);

/* Adds a thing with one user. By its serial number others find it; 0: by none. */
void tc_shared_add(TcShared *shared, TcSharedEntry *entry, void *thing, int64_t serial, size_t bytes);
/* The thing with this serial number, with one user more; NULL: there is none. */
void *tc_shared_find(TcShared *shared, int64_t serial);
/* One user more. */
void tc_shared_retain(TcShared *shared, TcSharedEntry *entry);
/* One user less. True: it was the last, nobody finds the thing any more, and the caller frees it. */
bool tc_shared_release(TcShared *shared, TcSharedEntry *entry);

#endif
