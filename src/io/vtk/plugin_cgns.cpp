// SPDX-License-Identifier: Apache-2.0
#include <vtkCGNSReader.h>

#include "source.hpp"

namespace {

class Cgns : public tcv::VtkSource<vtkCGNSReader> {
public:
  bool open(const std::string &path) override {
    if (!reader_->CanReadFile(path.c_str()))
      return false;
    reader_->SetFileName(path.c_str());
    reader_->UpdateInformation();
    reader_->EnableAllBases();
    reader_->DoublePrecisionMeshOn();
    return true;
  }
};

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &) {
  return std::make_unique<Cgns>();
}
