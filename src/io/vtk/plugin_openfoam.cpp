// SPDX-License-Identifier: Apache-2.0
// OpenFOAM cases: the path is that of an empty file in the case's folder, as ParaView has it.
#include <vtkOpenFOAMReader.h>

#include "source.hpp"

namespace {

class OpenFoam : public tcv::VtkSource<vtkOpenFOAMReader> {
public:
  bool open(const std::string &path) override {
    reader_->SetFileName(path.c_str());
    reader_->SetCreateCellToPoint(false); // fields are as the file has them
    reader_->SetDecomposePolyhedra(false);
    return true;
  }
};

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &) {
  return std::make_unique<OpenFoam>();
}
