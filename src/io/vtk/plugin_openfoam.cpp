// SPDX-License-Identifier: Apache-2.0
// Reads OpenFOAM cases. The path is that of an empty file in the folder of the case, as in ParaView.
#include <vtkOpenFOAMReader.h>

#include "source.hpp"

namespace {

class OpenFoam : public tcv::VtkSource<vtkOpenFOAMReader> {
public:
  bool open(const std::string &path) override {
    reader_->SetFileName(path.c_str());
    reader_->SetCreateCellToPoint(false); // Fields stay as the file has them.
    reader_->SetDecomposePolyhedra(false);
    return true;
  }
};

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &) {
  return std::make_unique<OpenFoam>();
}
