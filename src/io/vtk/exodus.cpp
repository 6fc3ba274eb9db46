// SPDX-License-Identifier: Apache-2.0
// Loads the plugin that reads Exodus files when there is one to read.
#include "exodus.hpp"

#include <cerrno>
#include <csignal>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <tetcast/dataset.h>

#include "common.hpp"
#include "files.hpp"

namespace tcv {

using Read = decltype(&tetcast_vtk_exodus_read);

// VTK's reader crashes on some damaged files, and prints about others: a child process tries first.
static void try_in_child(const char *path, Read read) {
  const pid_t child = fork();
  if (child < 0) fail(TETCAST_ERROR_MEMORY, "%s: no process could be started to try reading it", path);
  if (child == 0) {
    // A crash ends this process, whatever handlers the host has: they would go on with its work in here.
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
    const int null = open("/dev/null", O_WRONLY);
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    alarm(600);
    try {
      const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::Take(read(path));
      _exit(grid ? 0 : 2);
    } catch (...) {
      _exit(1);
    }
  }
  int status;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail(TETCAST_ERROR_IO, "%s: the process that tried reading it is lost", path);
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 2) {
    fail(TETCAST_ERROR_UNSUPPORTED, "%s: is in a format on top of NetCDF or HDF5 that is not Exodus, or damaged", path);
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: VTK's Exodus reader fails on it", path);
  }
}

vtkSmartPointer<vtkUnstructuredGrid> read_exodus(const char *path) {
  check_netcdf(path);
  const char *const name = "libtetcast-vtk-exodus.so";
  Dl_info here;
  std::string library = name; // beside this library
  if (dladdr(reinterpret_cast<void *>(&tetcast_dataset_read), &here) && here.dli_fname) {
    const std::string file = here.dli_fname;
    const size_t slash = file.rfind('/');
    if (slash != std::string::npos) library = file.substr(0, slash + 1) + name;
  }
  // Stays loaded: objects that it made may live on.
  void *handle = dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void *symbol = handle ? dlsym(handle, "tetcast_vtk_exodus_read") : nullptr;
  if (!symbol) {
    fail(TETCAST_ERROR_UNSUPPORTED, "%s: reading Exodus needs %s, which can't be loaded: %s", path, name, dlerror());
  }
  const auto read = reinterpret_cast<Read>(symbol);
  try_in_child(path, read);
  const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::Take(read(path));
  return grid;
}

} // namespace tcv
