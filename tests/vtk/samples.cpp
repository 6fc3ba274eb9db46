// SPDX-License-Identifier: Apache-2.0
#include "samples.h"

#include <cstring>
#include <string>
#include <vector>

#include <vtkCellData.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataSetAttributes.h>
#include <vtkDataSetWriter.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkSmartPointer.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataSetWriter.h>
#include <vtkXMLMultiBlockDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#ifdef SAMPLES_EXODUS
#include <vtkExodusIIWriter.h>
#include <vtkInformationVector.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnstructuredGridAlgorithm.h>
#endif
#ifdef SAMPLES_CGNS
#include <vtk_cgns.h>
#include VTK_CGNS(cgnslib.h)
#endif

namespace {

const int size[3] = {4, 3, 5};

double value_at(const double *p) {
  return p[0] + 2 * p[1] + 4 * p[2];
}

// Arrays s and c, of layers of cells from `first` on.
void add_arrays(vtkDataSet *dataset, int first) {
  vtkNew<vtkDoubleArray> s;
  s->SetName("s");
  for (vtkIdType i = 0; i < dataset->GetNumberOfPoints(); ++i)
    s->InsertNextValue(value_at(dataset->GetPoint(i)));
  vtkNew<vtkIntArray> c;
  c->SetName("c");
  for (vtkIdType i = 0; i < dataset->GetNumberOfCells(); ++i)
    c->InsertNextValue(static_cast<int>(i) + 6 * first);
  dataset->GetPointData()->AddArray(s);
  dataset->GetCellData()->AddArray(c);
}

vtkSmartPointer<vtkPoints> box_points(int first, int end) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (int k = first; k <= end; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i)
        points->InsertNextPoint(i, j, 0.5 * k);
    }
  }
  return points;
}

vtkSmartPointer<vtkUnstructuredGrid> layers(int first, int end) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(box_points(first, end));
  grid->Allocate();
  for (int k = 0; k < end - first; ++k) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) {
        const vtkIdType at = i + 4 * j + 12 * k;
        const vtkIdType corners[8] = {at, at + 1, at + 5, at + 4, at + 12, at + 13, at + 17, at + 16};
        grid->InsertNextCell(VTK_HEXAHEDRON, 8, corners);
      }
    }
  }
  add_arrays(grid, first);
  return grid;
}

vtkSmartPointer<vtkStructuredGrid> structured() {
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  grid->SetDimensions(size[0], size[1], size[2]);
  grid->SetPoints(box_points(0, 4));
  add_arrays(grid, 0);
  return grid;
}

vtkSmartPointer<vtkDataSet> dataset_of(char kind) {
  if (kind == 's')
    return structured();
  if (kind == 'i') {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(size[0], size[1], size[2]);
    image->SetSpacing(1, 1, 0.5);
    add_arrays(image, 0);
    return image;
  }
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  grid->SetDimensions(size[0], size[1], size[2]);
  for (int axis = 0; axis < 3; ++axis) {
    vtkNew<vtkDoubleArray> at;
    for (int i = 0; i < size[axis]; ++i)
      at->InsertNextValue(axis == 2 ? 0.5 * i : i);
    if (axis == 0)
      grid->SetXCoordinates(at);
    if (axis == 1)
      grid->SetYCoordinates(at);
    if (axis == 2)
      grid->SetZCoordinates(at);
  }
  add_arrays(grid, 0);
  return grid;
}

vtkSmartPointer<vtkUnsignedCharArray> marks(const char *name, vtkIdType count) {
  auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
  array->SetName(name);
  array->SetNumberOfTuples(count);
  array->FillValue(0);
  return array;
}

#ifdef SAMPLES_EXODUS
class TwoSteps : public vtkUnstructuredGridAlgorithm {
public:
  static TwoSteps *New() { VTK_STANDARD_NEW_BODY(TwoSteps); }

protected:
  TwoSteps() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(vtkInformation *, vtkInformationVector **, vtkInformationVector *output) override {
    double times[2] = {1, 2};
    output->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), times, 2);
    output->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), times, 2);
    return 1;
  }
  int RequestData(vtkInformation *, vtkInformationVector **, vtkInformationVector *output) override {
    vtkInformation *about = output->GetInformationObject(0);
    const double time = about->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    auto *grid = vtkUnstructuredGrid::GetData(about);
    grid->ShallowCopy(layers(0, 4));
    auto *s = vtkDoubleArray::SafeDownCast(grid->GetPointData()->GetArray("s"));
    for (vtkIdType i = 0; i < s->GetNumberOfTuples(); ++i)
      s->SetValue(i, time * s->GetValue(i));
    grid->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    return 1;
  }
};
#endif

} // namespace

void sample_structured(const char *path, char kind, SampleMode mode) {
  const auto dataset = dataset_of(kind);
  if (std::strstr(path, ".vtk")) {
    vtkNew<vtkDataSetWriter> writer;
    writer->SetFileName(path);
    writer->SetInputData(dataset);
    if (mode == SAMPLE_ASCII)
      writer->SetFileTypeToASCII();
    else
      writer->SetFileTypeToBinary();
    writer->Write();
    return;
  }
  vtkNew<vtkXMLDataSetWriter> writer;
  writer->SetFileName(path);
  writer->SetInputData(dataset);
  writer->SetDataMode(mode == SAMPLE_ASCII    ? vtkXMLWriter::Ascii
                      : mode == SAMPLE_BINARY ? vtkXMLWriter::Binary
                                              : vtkXMLWriter::Appended);
  writer->SetEncodeAppendedData(mode == SAMPLE_APPENDED);
  if (mode == SAMPLE_RAW)
    writer->SetCompressorTypeToNone();
  writer->Write();
}

void sample_blanked(const char *path) {
  const auto grid = structured();
  const auto cells = marks("vtkGhostType", BOX_CELLS), points = marks("vtkGhostType", BOX_POINTS);
  cells->SetValue(0, vtkDataSetAttributes::HIDDENCELL);
  points->SetValue(BOX_POINTS - 1, vtkDataSetAttributes::HIDDENPOINT);
  grid->GetCellData()->AddArray(cells);
  grid->GetPointData()->AddArray(points);
  vtkNew<vtkXMLDataSetWriter> writer;
  writer->SetFileName(path);
  writer->SetInputData(grid);
  writer->Write();
}

void sample_layers(const char *path, int first, int end, SampleGhosts ghosts) {
  const int low = ghosts && first > 0 ? first - 1 : first, high = ghosts && end < 4 ? end + 1 : end;
  const auto grid = layers(low, high);
  if (ghosts != GHOST_NONE) {
    const auto cells = marks(ghosts == GHOST_TYPES ? "vtkGhostType" : "vtkGhostLevels", grid->GetNumberOfCells());
    for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
      const int layer = low + static_cast<int>(i / 6);
      cells->SetValue(i, layer < first || layer >= end); // DUPLICATECELL, and a level, are 1
    }
    grid->GetCellData()->AddArray(cells);
  }
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName(path);
  writer->SetInputData(grid);
  writer->Write();
}

void sample_blocks(const char *path) {
  const auto name = [](vtkMultiBlockDataSet *group, unsigned i, const char *text) {
    group->GetMetaData(i)->Set(vtkCompositeDataSet::NAME(), text);
  };
  const auto upper = layers(2, 4);
  upper->GetCellData()->RemoveArray("c");
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(box_points(0, 0));
  surface->Allocate(1);
  const vtkIdType triangle[3] = {0, 1, 4};
  surface->InsertNextCell(VTK_TRIANGLE, 3, triangle);
  vtkNew<vtkMultiBlockDataSet> body, all;
  body->SetBlock(0, layers(0, 2));
  body->SetBlock(1, upper);
  name(body, 0, "lower");
  name(body, 1, "upper");
  all->SetBlock(0, body);
  name(all, 0, "body");
  all->SetBlock(1, surface);
  all->SetNumberOfBlocks(3);
  vtkNew<vtkXMLMultiBlockDataWriter> writer;
  writer->SetFileName(path);
  writer->SetInputData(all);
  writer->Write();
}

bool sample_exodus(const char *path) {
#ifdef SAMPLES_EXODUS
  vtkNew<TwoSteps> source;
  vtkNew<vtkExodusIIWriter> writer;
  writer->SetFileName(path);
  writer->SetInputConnection(source->GetOutputPort());
  writer->WriteAllTimeStepsOn();
  writer->Write();
  return true;
#else
  (void)path;
  return false;
#endif
}

#ifdef SAMPLES_CGNS
static void cgns_zone(int file, int base, const char *name, vtkUnstructuredGrid *grid, bool as_structured) {
  int zone, solution, id;
  cgsize_t sizes[9] = {grid->GetNumberOfPoints(), grid->GetNumberOfCells(), 0};
  const cgsize_t box[9] = {4, 3, 3, 3, 2, 2, 0, 0, 0};
  cg_zone_write(file, base, name, as_structured ? box : sizes,
                as_structured ? CGNS_ENUMV(Structured) : CGNS_ENUMV(Unstructured), &zone);
  std::vector<double> values(static_cast<size_t>(sizes[0]));
  const char *const axes[3] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
  for (int k = 0; k < 3; ++k) {
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = grid->GetPoint(static_cast<vtkIdType>(i))[k];
    cg_coord_write(file, base, zone, CGNS_ENUMV(RealDouble), axes[k], values.data(), &id);
  }
  if (!as_structured) {
    std::vector<cgsize_t> corners;
    vtkNew<vtkIdList> cell;
    for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
      grid->GetCellPoints(i, cell);
      for (const vtkIdType point : *cell)
        corners.push_back(point + 1);
    }
    cg_section_write(file, base, zone, "cells", CGNS_ENUMV(HEXA_8), 1, sizes[1], 0, corners.data(), &id);
  }
  cg_sol_write(file, base, zone, "solution", CGNS_ENUMV(Vertex), &solution);
  vtkDataArray *s = grid->GetPointData()->GetArray("s");
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = s->GetTuple1(static_cast<vtkIdType>(i));
  cg_field_write(file, base, zone, solution, CGNS_ENUMV(RealDouble), "s", values.data(), &id);
}
#endif

bool sample_cgns(const char *path) {
#ifdef SAMPLES_CGNS
  int file, base;
  if (cg_open(path, CG_MODE_WRITE, &file) != CG_OK)
    return false;
  cg_base_write(file, "base", 3, 3, &base);
  cgns_zone(file, base, "lower", layers(0, 2), false);
  cgns_zone(file, base, "upper", layers(2, 4), true);
  return cg_close(file) == CG_OK;
#else
  (void)path;
  return false;
#endif
}
