// SPDX-License-Identifier: Apache-2.0
#ifndef TETCAST_VTK_LISTS_HPP
#define TETCAST_VTK_LISTS_HPP

#include "contents.hpp"

namespace tcv {

struct Step {
  double time;
  std::string path;
};

// Reads the files of the step that is asked for. Files of the same time are parts of one step; not `timed`: all are.
void read_steps(const Reading &reading, std::vector<Step> steps, bool timed, Contents *contents);

// The path of `file` as a file at `path` names it, with / or \ between folders.
std::string beside(const std::string &path, const std::string &file);

} // namespace tcv

#endif
