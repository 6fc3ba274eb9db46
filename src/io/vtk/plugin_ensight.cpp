// SPDX-License-Identifier: Apache-2.0
// Reads EnSight 6 and EnSight Gold, binary and ASCII.
#include <vtkGenericEnSightReader.h>

#include "source.hpp"

namespace {

class EnSight : public tcv::VtkSource<vtkGenericEnSightReader> {
public:
  bool open(const std::string &path) override {
    const size_t slash = path.rfind('/'); // The reader looks for the other files in the folder that it is given.
    if (slash != std::string::npos)
      reader_->SetFilePath(path.substr(0, slash + 1).c_str());
    reader_->SetCaseFileName(path.substr(slash == std::string::npos ? 0 : slash + 1).c_str());
    return true;
  }
};

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &) {
  return std::make_unique<EnSight>();
}
