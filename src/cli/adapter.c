/* SPDX-License-Identifier: Apache-2.0 */
#include "adapter.h"

#include <dlfcn.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <tetcast/version.h>

#include "cli.h"
#include "file.h"
#include "loading.h"

#define TEXT_OF(number) #number
#define TEXT(number)    TEXT_OF(number)
#define SONAME(name)    "libtetcast-" name ".so." TEXT(TETCAST_VERSION_MAJOR)

typedef struct Symbol {
  const char *name;
  size_t offset; /* of the function pointer in the adapter's struct */
} Symbol;

#define CHECKED(result, name, parameters)                                                                              \
  _Static_assert(_Generic(tetcast_##name, result(*) parameters : 1, default : 0), "tetcast_" #name " has another "     \
                                                                                  "type");
CLI_VTK_FUNCTIONS(CHECKED)
CLI_TETGEN_FUNCTIONS(CHECKED)
CLI_IMAGE_FUNCTIONS(CHECKED)
CLI_MPI_FUNCTIONS(CHECKED)

#define VTK_SYMBOL(result, name, parameters)    {"tetcast_" #name, offsetof(CliVtk, name)},
#define TETGEN_SYMBOL(result, name, parameters) {"tetcast_" #name, offsetof(CliTetgen, name)},
#define IMAGE_SYMBOL(result, name, parameters)  {"tetcast_" #name, offsetof(CliImage, name)},
#define MPI_SYMBOL(result, name, parameters)    {"tetcast_" #name, offsetof(CliMpi, name)},

static const Symbol vtk_symbols[] = {CLI_VTK_FUNCTIONS(VTK_SYMBOL){NULL, 0}};
static const Symbol tetgen_symbols[] = {CLI_TETGEN_FUNCTIONS(TETGEN_SYMBOL){NULL, 0}};
static const Symbol image_symbols[] = {CLI_IMAGE_FUNCTIONS(IMAGE_SYMBOL){NULL, 0}};
static const Symbol mpi_symbols[] = {CLI_MPI_FUNCTIONS(MPI_SYMBOL){NULL, 0}};

/* Adapters lie beside libtetcast. A sanitizer's dlopen() does not see the command's own RUNPATH, so it is not left to
 * that alone. */
static void *open_adapter(const char *soname) {
  Dl_info core;
  const char *(*known)(void) = tetcast_version_string;
  void *address;
  memcpy(&address, &known, sizeof address);
  char *path = NULL;
  if (dladdr(address, &core) && core.dli_fname) {
    char *folder = cli_path_folder(core.dli_fname);
    path = cli_print("%s/%s", folder, soname);
    free(folder);
  }
  void *library = cli_load_library(path && access(path, F_OK) == 0 ? path : soname);
  free(path);
  return library;
}

static bool load(const char *soname, const char *purpose, const Symbol *symbols, void *adapter) {
  void *library = open_adapter(soname);
  if (!library) {
    cli_error("%s needs the adapter %s, which cannot be loaded: %s", purpose, soname, dlerror());
    return false;
  }
  for (; symbols->name; symbols++) {
    void *function = dlsym(library, symbols->name);
    if (!function) {
      cli_error("%s is of another version of tetcast: %s is missing", soname, symbols->name);
      return false;
    }
    memcpy((char *)adapter + symbols->offset, &function, sizeof function);
  }
  return true;
}

static const CliVtk *other_source;

void cli_set_source(const CliVtk *source) {
  other_source = source;
}

const CliVtk *cli_vtk(void) {
  static CliVtk vtk;
  if (other_source)
    return other_source;
  return vtk.dataset_read || load(SONAME("vtk"), "reading and writing meshes", vtk_symbols, &vtk) ? &vtk : NULL;
}

const CliTetgen *cli_tetgen(void) {
  static CliTetgen tetgen;
  return tetgen.tetgen_mesh || load(SONAME("tetgen"), "making a mesh", tetgen_symbols, &tetgen) ? &tetgen : NULL;
}

const CliImage *cli_image(void) {
  static CliImage image;
  return image.image_write || load(SONAME("openimageio"), "writing an image", image_symbols, &image) ? &image : NULL;
}

const CliMpi *cli_mpi(void) {
  static CliMpi mpi;
  return mpi.mpi_render || load(SONAME("mpi"), "--mpi", mpi_symbols, &mpi) ? &mpi : NULL;
}

TetcastStatus cli_write_pixels(TetcastContext *context, const char *path, float *pixels, int64_t width, int64_t height,
                               const TetcastImageDesc *desc) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = width;
  frame_desc.height = height;
  frame_desc.type = TETCAST_TYPE_FLOAT32;
  frame_desc.pixels = pixels;
  TetcastFrame *frame = NULL;
  TetcastStatus status = tetcast_frame_create(context, &frame_desc, &frame);
  if (status == TETCAST_OK)
    status = cli_image()->image_write(context, path, frame, desc);
  tetcast_frame_destroy(&frame);
  return status;
}
