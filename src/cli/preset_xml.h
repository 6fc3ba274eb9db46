/* SPDX-License-Identifier: Apache-2.0 */
/* ParaView's colour maps in XML. */
#ifndef TETCAST_CLI_PRESET_XML_H
#define TETCAST_CLI_PRESET_XML_H

#include <jansson.h>

#include <tetcast/context.h>

/* The maps of a file, one or more, as a list of objects with the keys of ParaView's JSON, for json_decref(); NULL after
 * a message. */
json_t *preset_xml_read(TetcastContext *context, const char *path);

#endif
