// SPDX-License-Identifier: Apache-2.0
// This is the program tetcast-vtk-NAME. The library starts it to read one file, and it writes what is in the file to
// descriptor 3 (wire.hpp). Whatever the readers of VTK do to this process on damaged files, the process of the library
// goes on.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <functional>
#include <new>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <vtkCompositeDataSet.h>
#include <vtkDataSet.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkMultiPieceDataSet.h>
#include <vtkSMPTools.h>
#include <vtkUnstructuredGrid.h>

#include "common.hpp"
#include "contents.hpp"
#include "plugin.hpp"
#include "source.hpp"
#include "wire.hpp"

namespace {

const int channel = 3;

// ── limits ──

double seconds_of_cpu() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Returns how many bytes this process has read, or -1 if the system does not say.
double bytes_read() {
  char text[32] = ""; // The text "rchar: " comes first.
  const int file = open("/proc/self/io", O_RDONLY | O_CLOEXEC);
  if (file < 0)
    return -1;
  const ssize_t size = read(file, text, sizeof text - 1);
  close(file);
  return size > 7 && std::strncmp(text, "rchar: ", 7) == 0 ? std::strtod(text + 7, nullptr) : -1;
}

struct Spent {
  double seconds, bytes;
} begun; // This is what was used when the attempt began.

// Ends a reader of VTK that looks without end for words which a damaged file does not have. Such a reader computes and
// reads nothing any more, and a whole file takes far less time than is allowed here. The timer calls this function.
void stop_if_endless(int) {
  const double bytes = bytes_read() - begun.bytes;
  if (begun.bytes < 0 || seconds_of_cpu() - begun.seconds <= 3 + 4e-6 * bytes)
    return;
  const char letter = tcv::WIRE_ENDLESS;
  _exit(write(channel, &letter, 1) == 1 ? 0 : 1);
}

void watch(bool on) {
  begun = {seconds_of_cpu(), bytes_read()};
  const itimerval interval = on ? itimerval{{0, 250000}, {0, 250000}} : itimerval{};
  std::signal(SIGALRM, stop_if_endless);
  setitimer(ITIMER_REAL, &interval, nullptr);
}

// Allows no more memory than the machine has, so that a size which a damaged file claims is refused.
void limit_memory() {
#ifndef __SANITIZE_ADDRESS__
  rlimit limit;
  if (getrlimit(RLIMIT_DATA, &limit) != 0)
    return;
  const auto memory = static_cast<rlim_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
  if (limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur > memory)
    limit.rlim_cur = memory;
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

// ── reading ──

int printed[2]; // A pipe that takes what readers print. A file that makes them print is damaged.

struct Attempt {
  vtkSmartPointer<vtkDataObject> object;
  bool good = false, foreign = false; // `foreign`: the file is not of the format.
  std::string error;
  std::vector<std::string> warnings;
  std::vector<tcv::UnreadArray> unreadable;
};

// Makes a new reader each time, because one that has failed once may be in any state.
std::unique_ptr<tcv::Source> open_source(const tcv::PluginRequest &request, Attempt *attempt) {
  tcv::SourceOptions options;
  options.displace = request.displace;
  auto source = tcv::make_source(options);
  attempt->foreign = !source->open(request.path);
  return source;
}

// Reads these arrays, and no others.
Attempt try_reading(const tcv::PluginRequest &request, const std::vector<tcv::ArrayName> &arrays) {
  Attempt attempt;
  watch(true);
  {
    const tcv::Capture capture;
    try {
      const auto source = open_source(request, &attempt);
      if (!attempt.foreign) {
        const int64_t step = tcv::choose_step(request.path, request.step, request.time, source->times());
        for (const tcv::ArrayName &array : source->arrays())
          source->enable(array, false);
        for (const tcv::ArrayName &array : arrays)
          source->enable(array, true);
        attempt.object = source->read(step);
        attempt.warnings = source->remarks;
        attempt.unreadable = source->unreadable;
      }
      attempt.good = !attempt.foreign && attempt.object && !capture.failed();
      attempt.error = capture.error();
    } catch (const tcv::Failure &) {
      throw;
    } catch (const std::bad_alloc &) {
      attempt.error = "not enough memory for what it holds or claims to hold";
    } catch (const std::exception &exception) {
      attempt.error = exception.what();
    }
    if (!capture.warning().empty())
      attempt.warnings.push_back(capture.warning());
  }
  watch(false);
  int size = 0;
  std::fflush(stdout);
  ioctl(printed[0], FIONREAD, &size);
  char text[4096];
  while (size > 0 && read(printed[0], text, sizeof text) > 0)
    ioctl(printed[0], FIONREAD, &size), attempt.good = false;
  if (!attempt.good && attempt.error.empty())
    attempt.error = "VTK's reader fails on it";
  return attempt;
}

// ── telling ──

// Tells of the parts of a group. Children that have no name go by their number, and pieces of a block go by the name of
// the block.
void each_leaf(const std::string &path, vtkDataObject *object,
               const std::function<void(const std::string &, vtkDataSet *)> &use) {
  if (auto *pieces = vtkMultiPieceDataSet::SafeDownCast(object)) {
    for (unsigned i = 0; i < pieces->GetNumberOfPieces(); ++i)
      each_leaf(path, pieces->GetPieceAsDataObject(i), use);
    return;
  }
  auto *blocks = vtkMultiBlockDataSet::SafeDownCast(object);
  if (!blocks) {
    if (auto *dataset = vtkDataSet::SafeDownCast(object))
      use(path, dataset);
    return;
  }
  for (unsigned i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
    vtkInformation *about = blocks->HasMetaData(i) ? blocks->GetMetaData(i) : nullptr;
    const char *name =
        about && about->Has(vtkCompositeDataSet::NAME()) ? about->Get(vtkCompositeDataSet::NAME()) : nullptr;
    const std::string own = name && *name ? name : std::to_string(i);
    each_leaf(path.empty() ? own : path + "/" + own, blocks->GetBlock(i), use);
  }
}

void tell(const tcv::PluginRequest &request, vtkDataObject *object, tcv::WireWriter *wire) {
  each_leaf(request.place, object, [&](const std::string &block, vtkDataSet *dataset) {
    if (!block.empty() && !tcv::block_wanted(block, request.block)) {
      wire->record(tcv::WIRE_BLOCK);
      return wire->text(block);
    }
    tcv::Grid grid = vtkUnstructuredGrid::SafeDownCast(dataset);
    if (!grid)
      grid = tcv::to_hexahedra(request.path + (block.empty() ? "" : ": block '" + block + "'"), dataset);
    wire->record(grid ? tcv::WIRE_GRID : tcv::WIRE_FLAT);
    wire->text(block);
    if (grid)
      wire->grid(grid);
  });
}

void tell_failure(TetcastStatus status, const std::string &text, tcv::WireWriter *wire) {
  wire->record(tcv::WIRE_FAILED);
  wire->number(status);
  wire->text(text);
  wire->flush();
}

void tell_lost(const tcv::UnreadArray &one, tcv::WireWriter *wire) {
  wire->record(tcv::WIRE_UNREADABLE);
  wire->number(one.array.association);
  wire->text(one.array.name);
  wire->text(one.reason);
}

// Tells the library what is tried before trying it, so that it knows the cause if this ends the program.
Attempt announced(const tcv::PluginRequest &request, const std::vector<tcv::ArrayName> &arrays, tcv::WireWriter *wire) {
  wire->record(tcv::WIRE_TRY);
  wire->text(arrays.size() == 1 ? arrays[0].name : "");
  wire->number(arrays.size() == 1 ? arrays[0].association : -1);
  wire->flush();
  return try_reading(request, arrays);
}

// Moves those of the arrays [begin, end) that can't be read to `bad`. At least one of them can't. Trying halves finds
// them with the fewest attempts.
void find_bad(const tcv::PluginRequest &request, const std::vector<tcv::ArrayName> &arrays, tcv::WireWriter *wire,
              const std::string &error, std::vector<tcv::UnreadArray> *bad) {
  if (arrays.size() == 1)
    return bad->push_back({arrays[0], error});
  const auto middle = arrays.begin() + static_cast<std::ptrdiff_t>(arrays.size() / 2);
  const std::vector<tcv::ArrayName> halves[2] = {{arrays.begin(), middle}, {middle, arrays.end()}};
  for (const auto &half : halves) {
    const Attempt attempt = announced(request, half, wire);
    if (!attempt.good)
      find_bad(request, half, wire, attempt.error, bad);
  }
}

// Sorts the arrays of the file into those to be read, and those that were not asked for, of which the library is told.
std::vector<tcv::ArrayName> choose_arrays(const tcv::PluginRequest &request, const std::vector<tcv::ArrayName> &all,
                                          tcv::WireWriter *wire) {
  std::vector<tcv::ArrayName> wanted;
  for (const tcv::ArrayName &array : all) {
    bool without = false;
    for (const tcv::ArrayName &one : request.without)
      without = without || one == array;
    if (without)
      continue;
    if (tcv::may_name(request.only, array.name)) {
      wanted.push_back(array);
      continue;
    }
    wire->record(tcv::WIRE_KNOWN);
    wire->number(array.association);
    wire->text(array.name);
  }
  return wanted;
}

// Reads the file without the arrays that can't be read. If there were crashes before, each array is tried on its own
// first.
Attempt read_what_can_be(const tcv::PluginRequest &request, std::vector<tcv::ArrayName> arrays, tcv::WireWriter *wire) {
  Attempt attempt;
  if (!request.apart) {
    attempt = announced(request, arrays, wire);
    if (attempt.good || arrays.empty())
      return attempt;
  }
  const std::string error = attempt.error;
  attempt = announced(request, {}, wire);
  if (!attempt.good)
    return attempt;
  std::vector<tcv::UnreadArray> bad;
  if (request.apart) {
    for (const tcv::ArrayName &array : arrays) {
      const Attempt one = announced(request, {array}, wire);
      if (!one.good)
        bad.push_back({array, one.error});
    }
  } else {
    find_bad(request, arrays, wire, error, &bad);
  }
  for (const tcv::UnreadArray &one : bad) {
    arrays.erase(std::find(arrays.begin(), arrays.end(), one.array));
    tell_lost(one, wire);
  }
  return arrays.empty() ? attempt : announced(request, arrays, wire);
}

void run(const tcv::PluginRequest &request, tcv::WireWriter *wire) {
  const char *path = request.path.c_str();
  Attempt attempt;
  std::vector<tcv::ArrayName> arrays;
  std::vector<double> times;
  wire->record(tcv::WIRE_TRY);
  wire->text("");
  wire->number(-1);
  wire->flush();
  watch(true);
  {
    const tcv::Capture capture;
    const auto source = open_source(request, &attempt);
    if (!attempt.foreign)
      times = source->times();
    if (!attempt.foreign)
      arrays = source->arrays();
    if (capture.failed())
      tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s", path, capture.error().c_str());
  }
  watch(false);
  if (attempt.foreign)
    return wire->record(tcv::WIRE_OTHER);
  const int64_t step = tcv::choose_step(request.path, request.step, request.time, times);
  wire->record(tcv::WIRE_TIMES);
  wire->number(static_cast<int64_t>(times.size()));
  for (const double time : times)
    wire->real(time);
  wire->number(step);
  attempt = read_what_can_be(request, choose_arrays(request, arrays, wire), wire);
  if (!attempt.good)
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s", path, attempt.error.c_str());
  for (const std::string &warning : attempt.warnings) {
    wire->record(tcv::WIRE_WARN);
    wire->text(warning);
  }
  for (const tcv::UnreadArray &one : attempt.unreadable)
    tell_lost(one, wire);
  tell(request, attempt.object, wire);
  wire->record(tcv::WIRE_END);
}

// Closes all descriptors but the channel, because the others belong to the host. A pipe takes what is printed.
bool arrange_files() {
  close_range(channel + 1, ~0U, 0);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || pipe2(printed, O_NONBLOCK | O_CLOEXEC) != 0)
    return false;
  return dup2(printed[1], STDOUT_FILENO) >= 0 && dup2(printed[1], STDERR_FILENO) >= 0;
}

} // namespace

int main(int argc, char **argv) {
  if (fcntl(channel, F_GETFD) < 0) {
    std::fprintf(stderr, "%s is a part of libtetcast-vtk, which starts it to read a file\n",
                 argc > 0 ? argv[0] : "this program");
    return 2;
  }
  fcntl(channel, F_SETFD, FD_CLOEXEC);
  if (!arrange_files())
    return 1;
  limit_memory();
  vtkSMPTools::SetBackend("Sequential"); // The host decides about threads, so there are no others here.
  tcv::WireWriter wire(channel);
  tcv::PluginRequest request;
  try {
    request = tcv::request_of(argv + 1);
    run(request, &wire);
  } catch (const tcv::Failure &failure) {
    tell_failure(failure.status, failure.text, &wire);
  } catch (const std::bad_alloc &) {
    tell_failure(TETCAST_ERROR_MEMORY, request.path + ": not enough memory for what it holds or claims to hold", &wire);
  } catch (const std::exception &exception) {
    tell_failure(TETCAST_ERROR_DATA, request.path + ": truncated or damaged: " + exception.what(), &wire);
  }
  wire.flush();
  _exit(0); // This leaves out what VTK does at its end.
}
