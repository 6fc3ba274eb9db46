/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_EXPORT_H
#define TETCAST_EXPORT_H

/* Every function below has C linkage and default visibility; everything else in the shared libraries is hidden. */
#if defined(_WIN32)
#define TETCAST_API
#else
#define TETCAST_API __attribute__((visibility("default")))
#endif

#endif
