// SPDX-License-Identifier: Apache-2.0
// Formats that programs of their own read: what the library asks these programs for.
#ifndef TETCAST_VTK_PLUGIN_HPP
#define TETCAST_VTK_PLUGIN_HPP

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "contents.hpp"

namespace tcv {

struct PluginRequest {
  std::string path;
  std::string place;                            // the block that the file is a part of, "" if there is none
  const char *block = nullptr, *only = nullptr; // as in TetcastDatasetDesc
  int64_t step = 0;
  double time = std::nan("");
  bool displace = true;
  bool apart = false;             // arrays are tried one by one: there were crashes
  std::vector<ArrayName> without; // arrays that are not to be tried again
};

// As the arguments of the program, and back.
std::vector<std::string> arguments_of(const PluginRequest &request);
PluginRequest request_of(char **arguments);

// The number of the step that is asked for. Fails if there is no such step.
int64_t choose_step(const std::string &path, int64_t step, double time, const std::vector<double> &times);

bool plugin_exists(const char *name);

void read_exodus(const Reading &reading, Contents *contents);
void read_vtkhdf(const Reading &reading, Contents *contents);
void read_ensight(const Reading &reading, Contents *contents);
void read_cgns(const Reading &reading, Contents *contents);
void read_openfoam(const Reading &reading, Contents *contents);

} // namespace tcv

#endif
