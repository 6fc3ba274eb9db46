/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_EXPORT_H
#define TETCAST_EXPORT_H

/* Marks the functions that the shared libraries export; everything else in them is hidden. */
#if defined(_WIN32)
#define TETCAST_API
#else
#define TETCAST_API __attribute__((visibility("default")))
#endif

#endif
