// SPDX-License-Identifier: Apache-2.0
// What is asked for, in a form that the library and its reader programs both understand.
#include "plugin.hpp"

#include <cstdio>
#include <cstdlib>

#include "common.hpp"
#include "contents.hpp"

namespace tcv {

// Each option is a letter, followed by what it says.
std::vector<std::string> arguments_of(const PluginRequest &request) {
  char time[64];
  std::snprintf(time, sizeof time, "t%a", request.time);
  std::vector<std::string> arguments = {"f" + request.path, "i" + request.place, "s" + std::to_string(request.step),
                                        time};
  if (request.block)
    arguments.push_back(std::string("b") + request.block);
  if (request.only)
    arguments.push_back(std::string("o") + request.only);
  if (!request.displace)
    arguments.push_back("u");
  if (request.apart)
    arguments.push_back("a");
  for (const ArrayName &array : request.without)
    arguments.push_back((array.association == TETCAST_POINT ? "p" : "c") + array.name);
  return arguments;
}

PluginRequest request_of(char **arguments) {
  PluginRequest request;
  for (char **at = arguments; *at; ++at) {
    const char *value = *at + 1;
    switch (**at) {
    case 'f':
      request.path = value;
      break;
    case 'i':
      request.place = value;
      break;
    case 's':
      request.step = std::strtoll(value, nullptr, 10);
      break;
    case 't':
      request.time = std::strtod(value, nullptr);
      break;
    case 'b':
      request.block = value;
      break;
    case 'o':
      request.only = value;
      break;
    case 'u':
      request.displace = false;
      break;
    case 'a':
      request.apart = true;
      break;
    case 'p':
      request.without.push_back({TETCAST_POINT, value});
      break;
    case 'c':
      request.without.push_back({TETCAST_CELL, value});
      break;
    default:
      break;
    }
  }
  return request;
}

bool block_wanted(const std::string &path, const char *name) {
  return !name || ("/" + path + "/").find("/" + std::string(name) + "/") != std::string::npos;
}

static std::string list_of(const std::vector<double> &times) {
  char text[160];
  const size_t last = times.size() - 1;
  std::snprintf(text, sizeof text, "there are steps 0 to %zu, at times %.9g to %.9g", last, times[0], times[last]);
  return text;
}

int64_t choose_step(const std::string &path, int64_t step, double time, const std::vector<double> &times) {
  const auto count = static_cast<int64_t>(times.size());
  if (!std::isnan(time)) {
    if (count == 0)
      fail(TETCAST_ERROR_ARGUMENT, "%s: knows of no times: it is of one step", path.c_str());
    int64_t nearest = 0;
    for (int64_t i = 1; i < count; ++i) {
      if (std::fabs(times[static_cast<size_t>(i)] - time) < std::fabs(times[static_cast<size_t>(nearest)] - time))
        nearest = i;
    }
    // Times are compared with a tolerance, as decimal fractions are not exact, and some formats keep times in single
    // precision.
    const double found = times[static_cast<size_t>(nearest)];
    const double scale = std::fmax(std::fabs(found), times.back() - times.front());
    if (!(std::fabs(found - time) <= 1e-6 * scale)) {
      fail(TETCAST_ERROR_ARGUMENT, "%s: has no time %.9g; the nearest is %.9g, of step %lld; %s", path.c_str(), time,
           found, static_cast<long long>(nearest), list_of(times).c_str());
    }
    return nearest;
  }
  const int64_t steps = count ? count : 1;
  if (step >= steps || step < -steps) {
    fail(TETCAST_ERROR_ARGUMENT, "%s: has no time step %lld; %s", path.c_str(), static_cast<long long>(step),
         count ? list_of(times).c_str() : "it is of one step, 0");
  }
  return step < 0 ? step + steps : step;
}

} // namespace tcv
