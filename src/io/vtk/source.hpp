// SPDX-License-Identifier: Apache-2.0
// A format whose reader needs libraries of its own, or crashes on some damaged files. It is read by a program of its
// own, tetcast-vtk-NAME, which the library starts for each file (plugin.cpp) and which sends what it has read
// (program.cpp).
#ifndef TETCAST_VTK_SOURCE_HPP
#define TETCAST_VTK_SOURCE_HPP

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <vtkAlgorithm.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include "arrays.hpp"

namespace tcv {

// A file of the format. Its functions report failure through VTK or by an exception.
class Source {
public:
  virtual ~Source() = default;
  // False: the file is not of this format.
  virtual bool open(const std::string &path) = 0;
  virtual std::vector<double> times() = 0;
  // The arrays of the file. Only enabled ones are read.
  virtual std::vector<ArrayName> arrays() = 0;
  virtual void enable(const ArrayName &array, bool on) = 0;
  virtual vtkSmartPointer<vtkDataObject> read(int64_t step) = 0;

  std::vector<std::string> remarks;    // messages for the user
  std::vector<UnreadArray> unreadable; // enabled arrays that it knows it can't read
};

// Options beside arrays and steps.
struct SourceOptions {
  bool displace = true; // whether points are moved by the file's displacements
};

// Makes the source of a program; each plugin_NAME.cpp defines it.
std::unique_ptr<Source> make_source(const SourceOptions &options);

// A source that reads by one of VTK's readers, whose arrays can be chosen by name.
template <typename Reader> class VtkSource : public Source {
public:
  std::vector<double> times() override {
    reader_->UpdateInformation();
    vtkInformation *about = reader_->GetOutputInformation(0);
    const auto key = vtkStreamingDemandDrivenPipeline::TIME_STEPS();
    if (about && about->Has(key))
      times_.assign(about->Get(key), about->Get(key) + about->Length(key));
    return times_;
  }
  std::vector<ArrayName> arrays() override {
    std::vector<ArrayName> names;
    for (int i = 0; i < reader_->GetNumberOfPointArrays(); ++i)
      names.push_back({TETCAST_POINT, reader_->GetPointArrayName(i)});
    for (int i = 0; i < reader_->GetNumberOfCellArrays(); ++i)
      names.push_back({TETCAST_CELL, reader_->GetCellArrayName(i)});
    return names;
  }
  void enable(const ArrayName &array, bool on) override {
    if (array.association == TETCAST_POINT)
      reader_->SetPointArrayStatus(array.name.c_str(), on);
    else
      reader_->SetCellArrayStatus(array.name.c_str(), on);
  }
  vtkSmartPointer<vtkDataObject> read(int64_t step) override {
    if (times_.empty())
      reader_->Update();
    else
      reader_->UpdateTimeStep(times_[static_cast<size_t>(step)]);
    return reader_->GetOutputDataObject(0);
  }

protected:
  vtkNew<Reader> reader_;

private:
  std::vector<double> times_;
};

} // namespace tcv

#endif
