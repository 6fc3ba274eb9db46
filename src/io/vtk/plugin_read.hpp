// SPDX-License-Identifier: Apache-2.0
// What the plugins share.
#ifndef TETCAST_VTK_PLUGIN_READ_HPP
#define TETCAST_VTK_PLUGIN_READ_HPP

#include <vtkAlgorithm.h>
#include <vtkInformation.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include "plugin.hpp"

namespace tcv {

// The times of a reader whose file is set.
inline std::vector<double> times_of(vtkAlgorithm *reader) {
  reader->UpdateInformation();
  vtkInformation *about = reader->GetOutputInformation(0);
  const auto key = vtkStreamingDemandDrivenPipeline::TIME_STEPS();
  if (!about || !about->Has(key)) return {};
  const double *times = about->Get(key);
  return std::vector<double>(times, times + about->Length(key));
}

// Reads the step that is asked for.
inline void read_step(vtkAlgorithm *reader, const PluginRequest &request, PluginResult *result) {
  result->times = times_of(reader);
  result->step = request.choose(result->times);
  if (result->times.empty()) reader->Update();
  else reader->UpdateTimeStep(result->times[static_cast<size_t>(result->step)]);
  result->object = reader->GetOutputDataObject(0);
}

} // namespace tcv

#endif
