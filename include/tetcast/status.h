/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_STATUS_H
#define TETCAST_STATUS_H

#include <tetcast/export.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a function succeeded, or why not. Functions that can fail return a status and hand out their result through a
 * pointer. The sentence that says what is wrong, and where, goes to the message callback of the context (context.h).
 * With any status but TETCAST_OK, an object that was to be created is not, and its out pointer is set to NULL. */
typedef enum TetcastStatus {
  TETCAST_OK = 0,
  TETCAST_ERROR_ARGUMENT,    /* an argument is outside its documented range */
  TETCAST_ERROR_MEMORY,      /* an allocation failed */
  TETCAST_ERROR_DATA,        /* data are unusable: index out of range, non-finite coordinate, truncated file … */
  TETCAST_ERROR_LIMIT,       /* more vertices or cells than can be addressed (mesh.h) */
  TETCAST_ERROR_IO,          /* a file can't be opened, read or written, or a message between processes is lost */
  TETCAST_ERROR_UNSUPPORTED, /* a known thing that this build or version can't do */
  TETCAST_ERROR_CANCELLED,   /* the progress callback asked to stop */
  TETCAST_ERROR_EMBREE,      /* Embree reported an error other than lack of memory */
  TETCAST_STATUS_COUNT       /* not a status: how many there are */
} TetcastStatus;

/* A short English phrase for a status, "unknown status" for anything else; static storage. Any thread. */
TETCAST_API const char *tetcast_status_string(TetcastStatus status);

#ifdef __cplusplus
}
#endif

#endif
