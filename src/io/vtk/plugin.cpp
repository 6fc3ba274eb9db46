// SPDX-License-Identifier: Apache-2.0
#include "plugin.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vtkSMPTools.h>

#include "common.hpp"
#include "files.hpp"
#include "formats.hpp"

namespace tcv {

static std::string plugin_path(const char *name) {
  const std::string file = std::string("libtetcast-vtk-") + name + ".so";
  Dl_info here;
  if (!dladdr(reinterpret_cast<void *>(&tetcast_dataset_read), &here) || !here.dli_fname) return file;
  const std::string own = here.dli_fname;
  const size_t slash = own.rfind('/');
  return slash == std::string::npos ? file : own.substr(0, slash + 1) + file;
}

bool plugin_exists(const char *name) { return access(plugin_path(name).c_str(), R_OK) == 0; }

static PluginRead load(const char *path, const char *name) {
  const std::string library = plugin_path(name);
  // Stays loaded: objects that it made may live on.
  void *handle = dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void *symbol = handle ? dlsym(handle, "tetcast_vtk_plugin_read") : nullptr;
  if (!symbol) fail(TETCAST_ERROR_UNSUPPORTED, "%s: reading this format needs %s, which can't be loaded: %s", path, library.c_str(), dlerror());
  return reinterpret_cast<PluginRead>(symbol);
}

// No more than the machine has, beside what the process has already: a size that a damaged file claims is then refused.
static void limit_memory() {
#ifndef __SANITIZE_ADDRESS__
  rlimit limit;
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  const auto memory = static_cast<rlim_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
  if (limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur > memory) limit.rlim_cur = memory;
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

enum Trial { GOOD = 0, BAD = 1, OTHER_FORMAT = 2, ENDLESS = 3, STUCK = 4 };

const int trials = 3, patience = 16; // a trial that waits is stopped after this many quarters of a second, and a sleeping disk is up again

// How many bytes this process has read; -1 where the system does not say.
static double bytes_read() {
  char text[32] = ""; // "rchar: " comes first
  const int file = open("/proc/self/io", O_RDONLY);
  if (file < 0) return -1;
  const ssize_t size = read(file, text, sizeof text - 1);
  close(file);
  return size > 7 && std::strncmp(text, "rchar: ", 7) == 0 ? std::strtod(text + 7, nullptr) : -1;
}

// VTK's readers look for words that a damaged file does not have, without end: they compute and read nothing any more. What a whole file
// takes is far less than this. And a process that neither computes nor reads waits for a lock that some thread of the host's held when it
// began, a thread that it has not. Called by the timer.
static void stop_if_endless(int) {
  static double bytes_before, seconds_before;
  static int waits;
  const double bytes = bytes_read(), seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  if (bytes >= 0 && seconds > 3 + 4e-6 * bytes) _exit(ENDLESS);
  waits = bytes - bytes_before < 64 && seconds - seconds_before < 1e-3 ? waits + 1 : 0; // less is the timer's own
  if (waits == patience) _exit(STUCK);
  bytes_before = bytes;
  seconds_before = seconds;
}

// `output` is a pipe, for what is printed: a library must not, and what makes a reader do so is damaged.
[[noreturn]] static void try_here(PluginRead read, const PluginRequest &request, const int output[2]) {
  // A crash ends this process, whatever handlers the host has: they would go on with its work in here.
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  dup2(output[1], STDOUT_FILENO);
  dup2(output[1], STDERR_FILENO);
  std::signal(SIGALRM, stop_if_endless);
  const itimerval interval = {{0, 250000}, {0, 250000}};
  setitimer(ITIMER_REAL, &interval, nullptr);
  limit_memory();
  vtkSMPTools::SetBackend("Sequential"); // threads that the host has started for TBB are not in this process
  try {
    PluginResult result;
    read(&request, &result);
    int printed = 0;
    std::fflush(stdout);
    ioctl(output[0], FIONREAD, &printed);
    _exit(!result.object ? OTHER_FORMAT : printed > 0 ? BAD : GOOD);
  } catch (const Failure &) {
    _exit(GOOD); // this library's own, as for a step there is not: will be heard of again
  } catch (...) {
    _exit(BAD);
  }
}

// What became of a child process that reads the file: a status as of waitpid().
static int trial(PluginRead read, const PluginRequest &request) {
  const char *path = request.path.c_str();
  int output[2];
  if (pipe2(output, O_NONBLOCK | O_CLOEXEC) != 0) fail(TETCAST_ERROR_MEMORY, "%s: no process could be started to try reading it", path);
  std::fflush(stdout); // the child would print what is left in there
  const pid_t child = fork();
  if (child == 0) try_here(read, request, output);
  close(output[0]);
  close(output[1]);
  if (child < 0) fail(TETCAST_ERROR_MEMORY, "%s: no process could be started to try reading it", path);
  int status;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail(TETCAST_ERROR_IO, "%s: the process that tried reading it is lost", path);
  }
  return status;
}

// VTK's readers crash on some damaged files, and print about others: a child process tries first. One that is stuck is followed by another,
// as threads hold locks for moments only.
static void try_in_child(PluginRead read, const PluginRequest &request, const char *format) {
  const char *path = request.path.c_str();
  const Capture capture; // what is said through VTK is none of the printing
  int result = STUCK;
  for (int i = 0; i < trials && result == STUCK; ++i) {
    const int status = trial(read, request);
    result = WIFEXITED(status) ? WEXITSTATUS(status) : BAD;
  }
  switch (result) {
  case GOOD: return;
  case OTHER_FORMAT: fail(TETCAST_ERROR_UNSUPPORTED, "%s: is not a file of format %s, or damaged", path, format);
  case ENDLESS: fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: VTK's reader of %s files does not come to an end", path, format);
  case STUCK: fail(TETCAST_ERROR_IO, "%s: the process that tries reading it waits, for its disk or for locks that threads of this program hold", path);
  default: fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: VTK's reader of %s files fails on it", path, format);
  }
}

// Reads by plugin `name`.
static void read_plugin(const Reading &reading, const char *name, const char *format, Contents *contents) {
  const char *path = reading.path.c_str();
  const PluginRead read = load(path, name);
  const PluginRequest request = {reading.path, reading.desc->only, [&](const std::vector<double> &times) { return choose_step(reading.path, *reading.desc, times); }};
  try_in_child(read, request, format);
  const auto result = captured(reading.context, path, [&] {
    PluginResult all;
    read(&request, &all);
    return all;
  });
  if (!result.object) fail(TETCAST_ERROR_DATA, "%s: changed while it was read", path);
  add_object(reading, result.object, contents);
  contents->times = result.times;
  contents->step = result.step;
}

void read_exodus(const Reading &reading, Contents *contents) {
  check_netcdf(reading.path.c_str());
  read_plugin(reading, "exodus", "Exodus (on NetCDF or HDF5)", contents);
}

void read_vtkhdf(const Reading &reading, Contents *contents) { read_plugin(reading, "hdf", "VTKHDF", contents); }
void read_ensight(const Reading &reading, Contents *contents) { read_plugin(reading, "ensight", "EnSight", contents); }
void read_cgns(const Reading &reading, Contents *contents) { read_plugin(reading, "cgns", "CGNS", contents); }

void read_openfoam(const Reading &reading, Contents *contents) { // VTK would read the folder without looking for the file
  const char *path = reading.path.c_str();
  if (access(path, R_OK) != 0) fail(TETCAST_ERROR_IO, "%s: can't be opened: %s", path, std::strerror(errno));
  read_plugin(reading, "openfoam", "OpenFOAM", contents);
}

} // namespace tcv
