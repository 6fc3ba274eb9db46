// SPDX-License-Identifier: Apache-2.0
// Reads formats by programs of their own (program.cpp), because VTK's readers of these formats crash, hang and print on
// some damaged files, and the libraries that they bring are not made for threads. A program is started by
// posix_spawn(), which copies nothing of this process, neither a lock that a thread holds nor memory. Only its pipe
// tells what becomes of it, because the host may ignore SIGCHLD, or wait for all of its children.
#include "plugin.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common.hpp"
#include "files.hpp"
#include "wire.hpp"

extern char **environ;

namespace tcv {

// Returns the folder that has the programs. That is the one that $TETCAST_LIBEXEC names, or where they are installed as
// seen from this library, or a folder beside the library in a build.
static std::string program_path(const char *name) {
  const std::string program = std::string("/tetcast-vtk-") + name;
  const char *named = std::getenv("TETCAST_LIBEXEC");
  if (named && *named)
    return named + program;
  Dl_info here;
  std::string folder = ".";
  if (dladdr(reinterpret_cast<void *>(&tetcast_dataset_read), &here) && here.dli_fname) {
    const std::string own = here.dli_fname;
    const size_t slash = own.rfind('/');
    if (slash != std::string::npos)
      folder = own.substr(0, slash);
  }
  const std::string installed = folder + "/" TETCAST_VTK_LIBEXEC + program,
                    built = folder + "/../libexec/tetcast" + program;
  return access(installed.c_str(), X_OK) != 0 && access(built.c_str(), X_OK) == 0 ? built : installed;
}

bool plugin_exists(const char *name) {
  return access(program_path(name).c_str(), X_OK) == 0;
}

// ── a program that runs ──

static bool is_alive(int process) {
  siginfo_t state = {};
  // If the system, or somebody else in this process, has waited for the child, it is no child any more.
  return waitid(P_PID, static_cast<id_t>(process), &state, WEXITED | WNOHANG | WNOWAIT) == 0 && state.si_pid == 0;
}

class Program {
public:
  Program(const std::string &program, const PluginRequest &request) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      no_process(request, errno);
    file_ = ends[0];
    const int error = start(program, arguments_of(request), ends[1]);
    close(ends[1]);
    if (error == 0)
      return;
    close(file_);
    if (error != ENOENT && error != EACCES)
      no_process(request, error);
    fail(TETCAST_ERROR_UNSUPPORTED, "%s: reading this format needs the program %s, which can't be started: %s",
         request.path.c_str(), program.c_str(), std::strerror(error));
  }
  ~Program() { // A program that still runs has nobody to write to any more, which ends it.
    close(file_);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR)
      continue;
  }
  Program(const Program &) = delete;
  Program &operator=(const Program &) = delete;

  int file() const { return file_; }
  pid_t process() const { return process_; }

private:
  [[noreturn]] static void no_process(const PluginRequest &request, int error) {
    fail(TETCAST_ERROR_MEMORY, "%s: no process could be started to read it: %s", request.path.c_str(),
         std::strerror(error));
  }

  // The program has all signals as they are by default, and none held back, whatever the host does with its own.
  int start(const std::string &program, const std::vector<std::string> &arguments, int channel) {
    std::vector<char *> list = {const_cast<char *>(program.c_str())};
    for (const std::string &one : arguments)
      list.push_back(const_cast<char *>(one.c_str()));
    list.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    if (posix_spawn_file_actions_init(&files) != 0)
      return ENOMEM;
    if (posix_spawnattr_init(&attributes) != 0) {
      posix_spawn_file_actions_destroy(&files);
      return ENOMEM;
    }
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    int error = posix_spawn_file_actions_adddup2(&files, channel, 3);
    if (error == 0)
      error = posix_spawn(&process_, program.c_str(), &files, &attributes, list.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    return error;
  }

  int file_ = -1;
  pid_t process_ = -1;
};

// ── what it tells ──

struct Trial {
  ArrayName array;
  bool of_array = false; // True if the program was trying to read this one array when it was last heard of.
};

static TetcastAssociation association_of(int64_t value) {
  return value == TETCAST_CELL ? TETCAST_CELL : TETCAST_POINT;
}

static void take_unread(WireReader *wire, bool unreadable, Contents *contents) {
  const TetcastAssociation association = association_of(wire->number());
  const std::string name = wire->text();
  note_unread(&contents->unread, {association, name}, unreadable ? wire->text() : "");
}

static void take_block(const Reading &reading, WireReader *wire, WireRecord record, Contents *contents) {
  const std::string block = wire->text();
  if (record == WIRE_GRID)
    return add_grid(reading, block, wire->grid(), contents);
  list_block(block, contents);
  contents->surfaces += record == WIRE_FLAT;
}

// Returns true if all has been told, and false if nothing more will be, because what is in `trial` has ended the
// program. Fails if the file is damaged.
static bool listen(const Reading &reading, const char *format, WireReader *wire, Contents *contents, Trial *trial) {
  const char *path = reading.path.c_str();
  try {
    for (;;) {
      const WireRecord record = wire->record();
      switch (record) {
      case WIRE_TRY: {
        const std::string name = wire->text();
        const int64_t association = wire->number();
        *trial = {{association_of(association), name}, association >= 0};
        break;
      }
      case WIRE_KNOWN:
      case WIRE_UNREADABLE:
        take_unread(wire, record == WIRE_UNREADABLE, contents);
        break;
      case WIRE_TIMES:
        contents->times.clear();
        for (int64_t count = wire->number(); count > 0; --count)
          contents->times.push_back(wire->real());
        contents->step = wire->number();
        break;
      case WIRE_WARN:
        tetcast_context_message(reading.context, TETCAST_SEVERITY_WARNING, "%s: %s", path, wire->text().c_str());
        break;
      case WIRE_BLOCK:
      case WIRE_FLAT:
      case WIRE_GRID:
        take_block(reading, wire, record, contents);
        break;
      case WIRE_END:
        return true;
      case WIRE_FAILED: {
        const auto status = static_cast<TetcastStatus>(wire->number());
        throw Failure{status, wire->text()};
      }
      case WIRE_OTHER:
        fail(TETCAST_ERROR_UNSUPPORTED, "%s: is not a file of format %s, or damaged", path, format);
      case WIRE_ENDLESS:
        return false;
      default:
        throw WireBroken();
      }
    }
  } catch (const WireBroken &) {
    return false;
  }
}

// Reads a file by the program `name`. If an array ends the program, another one is started, which tries each array on
// its own first and then reads the file without those that are at fault.
static void read_plugin(const Reading &reading, const char *name, const char *format, Contents *contents) {
  const char *path = reading.path.c_str();
  const std::string program = program_path(name);
  PluginRequest request = {reading.path,
                           reading.block,
                           reading.desc->block,
                           reading.desc->only,
                           reading.desc->step,
                           reading.desc->time,
                           !reading.desc->no_displacement,
                           false,
                           {}};
  const int patience = 6;
  for (int i = 0; i < patience; ++i) {
    Contents found;
    Trial trial;
    bool whole = false;
    {
      const Program running(program, request);
      WireReader wire(running.file(), is_alive, running.process());
      whole = captured(reading.context, path, [&] { return listen(reading, format, &wire, &found, &trial); });
    }
    if (whole) {
      std::move(found.pieces.begin(), found.pieces.end(), std::back_inserter(contents->pieces));
      for (const std::string &block : found.blocks)
        list_block(block, contents);
      for (const UnreadArray &one : found.unread)
        note_unread(&contents->unread, one.array, one.reason);
      for (const ArrayName &array : request.without)
        note_unread(&contents->unread, array, std::string("VTK's reader of ") + format + " files ends on it");
      contents->surfaces += found.surfaces;
      contents->times = found.times;
      contents->step = found.step;
      return;
    }
    if (request.apart && !trial.of_array)
      break;
    request.apart = true;
    if (trial.of_array)
      request.without.push_back(trial.array);
  }
  fail(TETCAST_ERROR_DATA,
       "%s: truncated or damaged: VTK's reader of %s files crashes on it or does not come to an end", path, format);
}

void read_exodus(const Reading &reading, Contents *contents) {
  check_netcdf(reading.path.c_str());
  read_plugin(reading, "exodus", "Exodus (on NetCDF or HDF5)", contents);
}

void read_vtkhdf(const Reading &reading, Contents *contents) {
  read_plugin(reading, "hdf", "VTKHDF", contents);
}
void read_ensight(const Reading &reading, Contents *contents) {
  read_plugin(reading, "ensight", "EnSight", contents);
}
void read_cgns(const Reading &reading, Contents *contents) {
  read_plugin(reading, "cgns", "CGNS", contents);
}

void read_openfoam(const Reading &reading,
                   Contents *contents) { // VTK would read the folder without looking for the file.
  const char *path = reading.path.c_str();
  if (access(path, R_OK) != 0)
    fail(TETCAST_ERROR_IO, "%s: can't be opened: %s", path, std::strerror(errno));
  read_plugin(reading, "openfoam", "OpenFOAM", contents);
}

} // namespace tcv
