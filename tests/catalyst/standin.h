/* SPDX-License-Identifier: Apache-2.0 */
/* What is used here of the C interfaces of Conduit and Catalyst 2, under Conduit's own names or, with STANDIN_MANGLED,
 * under those of Catalyst's copy of it. Written for these tests after the interfaces' documentation. It is stricter
 * than the real one: what would throw there ends the process here. */
#ifndef STANDIN_H
#define STANDIN_H

#include <stdint.h>

#ifdef STANDIN_MANGLED
#define conduit_node_create                         catalyst_conduit_node_create
#define conduit_node_destroy                        catalyst_conduit_node_destroy
#define conduit_node_fetch                          catalyst_conduit_node_fetch
#define conduit_node_append                         catalyst_conduit_node_append
#define conduit_node_has_path                       catalyst_conduit_node_has_path
#define conduit_node_number_of_children             catalyst_conduit_node_number_of_children
#define conduit_node_child                          catalyst_conduit_node_child
#define conduit_node_name                           catalyst_conduit_node_name
#define conduit_node_as_char8_str                   catalyst_conduit_node_as_char8_str
#define conduit_node_element_ptr                    catalyst_conduit_node_element_ptr
#define conduit_node_dtype                          catalyst_conduit_node_dtype
#define conduit_node_set_path_char8_str             catalyst_conduit_node_set_path_char8_str
#define conduit_node_set_path_int64                 catalyst_conduit_node_set_path_int64
#define conduit_node_set_path_float64               catalyst_conduit_node_set_path_float64
#define conduit_node_set_path_external_float64_ptr  catalyst_conduit_node_set_path_external_float64_ptr
#define conduit_node_set_path_external_int32_ptr    catalyst_conduit_node_set_path_external_int32_ptr
#define conduit_datatype_number_of_elements         catalyst_conduit_datatype_number_of_elements
#define conduit_datatype_stride                     catalyst_conduit_datatype_stride
#define conduit_datatype_endianness_matches_machine catalyst_conduit_datatype_endianness_matches_machine
#define conduit_datatype_is_list                    catalyst_conduit_datatype_is_list
#define conduit_datatype_is_char8_str               catalyst_conduit_datatype_is_char8_str
#define conduit_datatype_is_int8                    catalyst_conduit_datatype_is_int8
#define conduit_datatype_is_int16                   catalyst_conduit_datatype_is_int16
#define conduit_datatype_is_int32                   catalyst_conduit_datatype_is_int32
#define conduit_datatype_is_int64                   catalyst_conduit_datatype_is_int64
#define conduit_datatype_is_uint8                   catalyst_conduit_datatype_is_uint8
#define conduit_datatype_is_uint16                  catalyst_conduit_datatype_is_uint16
#define conduit_datatype_is_uint32                  catalyst_conduit_datatype_is_uint32
#define conduit_datatype_is_uint64                  catalyst_conduit_datatype_is_uint64
#define conduit_datatype_is_float32                 catalyst_conduit_datatype_is_float32
#define conduit_datatype_is_float64                 catalyst_conduit_datatype_is_float64
#endif

typedef void conduit_node;
typedef void conduit_datatype;
typedef int64_t conduit_index_t;

conduit_node *conduit_node_create(void);
void conduit_node_destroy(conduit_node *node);
conduit_node *conduit_node_fetch(conduit_node *node, const char *path);
conduit_node *conduit_node_append(conduit_node *node);
int conduit_node_has_path(const conduit_node *node, const char *path);
conduit_index_t conduit_node_number_of_children(conduit_node *node);
conduit_node *conduit_node_child(conduit_node *node, conduit_index_t i);
char *conduit_node_name(const conduit_node *node);
char *conduit_node_as_char8_str(conduit_node *node);
void *conduit_node_element_ptr(conduit_node *node, conduit_index_t i);
const conduit_datatype *conduit_node_dtype(const conduit_node *node);
void conduit_node_set_path_char8_str(conduit_node *node, const char *path, const char *text);
void conduit_node_set_path_int64(conduit_node *node, const char *path, int64_t value);
void conduit_node_set_path_float64(conduit_node *node, const char *path, double value);
void conduit_node_set_path_external_float64_ptr(conduit_node *node, const char *path, double *data,
                                                conduit_index_t count);
void conduit_node_set_path_external_int32_ptr(conduit_node *node, const char *path, int32_t *data,
                                              conduit_index_t count);
conduit_index_t conduit_datatype_number_of_elements(const conduit_datatype *type);
conduit_index_t conduit_datatype_stride(const conduit_datatype *type);
int conduit_datatype_endianness_matches_machine(const conduit_datatype *type);
int conduit_datatype_is_list(const conduit_datatype *type);
int conduit_datatype_is_char8_str(const conduit_datatype *type);
int conduit_datatype_is_int8(const conduit_datatype *type);
int conduit_datatype_is_int16(const conduit_datatype *type);
int conduit_datatype_is_int32(const conduit_datatype *type);
int conduit_datatype_is_int64(const conduit_datatype *type);
int conduit_datatype_is_uint8(const conduit_datatype *type);
int conduit_datatype_is_uint16(const conduit_datatype *type);
int conduit_datatype_is_uint32(const conduit_datatype *type);
int conduit_datatype_is_uint64(const conduit_datatype *type);
int conduit_datatype_is_float32(const conduit_datatype *type);
int conduit_datatype_is_float64(const conduit_datatype *type);

/* The types of leaves, and one function for what Conduit has one of each for: data of the caller's, whose numbers lie
 * so many bytes apart. `swapped`: they are in the other order of bytes, or so it is said. */
typedef enum StandinType {
  STANDIN_EMPTY,
  STANDIN_INT8,
  STANDIN_INT16,
  STANDIN_INT32,
  STANDIN_INT64,
  STANDIN_UINT8,
  STANDIN_UINT16,
  STANDIN_UINT32,
  STANDIN_UINT64,
  STANDIN_FLOAT32,
  STANDIN_FLOAT64,
  STANDIN_TEXT
} StandinType;
void standin_set(conduit_node *node, const char *path, StandinType type, void *data, int64_t count, int64_t stride);
void standin_swap(conduit_node *node, const char *path);
int standin_size(StandinType type);
/* One number less; and a leaf like another one, of the same data if they are external. */
void standin_shorten(conduit_node *node);
void standin_copy(conduit_node *to, const conduit_node *from);

#ifndef STANDIN_WITHOUT_MPI
/* What a program that is linked with MPI has of it: the number of processes of any communicator, and of the number 9 in
 * Fortran's way. */
extern int standin_processes;
void *MPI_Comm_f2c(int communicator);
int MPI_Comm_size(void *communicator, int *size);
#endif

/* Catalyst 2. */
int catalyst_initialize(const conduit_node *params);
int catalyst_execute(const conduit_node *params);
int catalyst_finalize(const conduit_node *params);
int catalyst_about(conduit_node *params);
int catalyst_results(conduit_node *params);

#endif
