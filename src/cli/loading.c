/* SPDX-License-Identifier: Apache-2.0 */
#include "loading.h"

#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* OpenImageIO is linked with OpenVDB, and OpenVDB with a logger (log4cplus) that starts threads for later messages when
 * it is loaded. If the system can't start them, the logger ends the process, though nothing of it is ever used. So
 * while a library is loaded, pthread_create() reports success also if it fails; the threads would only wait for work.
 * Such a process ends without running what libraries do at the end, as the logger would wait for its threads. */
static _Thread_local bool loading;
static atomic_bool pretended;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_ITS_OWN
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HAS_ITS_OWN
#endif
#endif

#ifndef HAS_ITS_OWN /* a sanitizer is in this place already */
/* Replaces the system's function for all libraries of this process. */
__attribute__((visibility("default"))) int pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                                                          void *(*function)(void *), void *data) {
  static int (*_Atomic real)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
  int (*create)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *) = real;
  if (!create) {
    void *symbol = dlsym(RTLD_NEXT, "pthread_create");
    memcpy(&create, &symbol, sizeof create);
    real = create;
  }
  const int error = create(thread, attributes, function, data);
  if (error != EAGAIN || !loading)
    return error;
  *thread = pthread_self();
  atomic_store(&pretended, true);
  return 0;
}
#endif

static void leave_at_once(int status, void *data) {
  (void)data;
  fflush(NULL);
  _exit(status);
}

void *cli_load_library(const char *path) {
  const bool before = atomic_load(&pretended);
  loading = true;
  void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  loading = false;
  if (!before && atomic_load(&pretended))
    on_exit(leave_at_once, NULL); /* before what the libraries do at the end */
  return library;
}
