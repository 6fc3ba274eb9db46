/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/shared.h"

#include <pthread.h>

struct TcShared {
  TetcastContext *context;
  pthread_mutex_t mutex;
  TcSharedEntry *first;
};

TetcastStatus tc_shared_create(TetcastContext *context, TcShared **out) {
  TcShared *shared;
  if (!tc_allocate_array(context, (void **)&shared, 1, sizeof *shared, "volume"))
    return TETCAST_ERROR_MEMORY;
  *shared = (TcShared){.context = context};
  pthread_mutex_init(&shared->mutex, NULL); /* with default attributes this can't fail */
  *out = shared;
  return TETCAST_OK;
}

void tc_shared_destroy(TcShared *shared) {
  if (!shared)
    return;
  pthread_mutex_destroy(&shared->mutex);
  tc_release(shared->context, shared);
}

size_t tc_shared_bytes(TcShared *shared) {
  size_t bytes = sizeof *shared;
  pthread_mutex_lock(&shared->mutex);
  for (const TcSharedEntry *entry = shared->first; entry; entry = entry->next)
    bytes += entry->bytes;
  pthread_mutex_unlock(&shared->mutex);
  return bytes;
}

void tc_shared_add(TcShared *shared, TcSharedEntry *entry, void *thing, int64_t serial, size_t bytes) {
  pthread_mutex_lock(&shared->mutex);
  *entry = (TcSharedEntry){.thing = thing, .serial = serial, .users = 1, .bytes = bytes, .next = shared->first};
  shared->first = entry;
  pthread_mutex_unlock(&shared->mutex);
}

void *tc_shared_find(TcShared *shared, int64_t serial) {
  pthread_mutex_lock(&shared->mutex);
  TcSharedEntry *entry = shared->first;
  while (entry && entry->serial != serial)
    entry = entry->next;
  if (entry)
    ++entry->users;
  pthread_mutex_unlock(&shared->mutex);
  return entry ? entry->thing : NULL;
}

void tc_shared_retain(TcShared *shared, TcSharedEntry *entry) {
  pthread_mutex_lock(&shared->mutex);
  ++entry->users;
  pthread_mutex_unlock(&shared->mutex);
}

bool tc_shared_release(TcShared *shared, TcSharedEntry *entry) {
  pthread_mutex_lock(&shared->mutex);
  const bool unused = --entry->users == 0;
  TcSharedEntry **at = &shared->first;
  while (unused && *at != entry)
    at = &(*at)->next;
  if (unused)
    *at = entry->next;
  pthread_mutex_unlock(&shared->mutex);
  return unused;
}
