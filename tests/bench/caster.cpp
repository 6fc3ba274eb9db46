// SPDX-License-Identifier: Apache-2.0
#include "caster.h"

#include <exception>
#include <memory>

#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkColorTransferFunction.h>
#include <vtkContourFilter.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRayCastImageDisplayHelper.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridBunykRayCastFunction.h>
#include <vtkUnstructuredGridLinearRayIntegrator.h>
#include <vtkUnstructuredGridPartialPreIntegration.h>
#include <vtkUnstructuredGridPreIntegration.h>
#include <vtkUnstructuredGridVolumeRayCastIterator.h>
#include <vtkUnstructuredGridVolumeRayCastMapper.h>
#include <vtkVersion.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

namespace {

// The ray cast function asks its mapper for the picture's size, which the mapper otherwise takes from a window.
class WindowlessMapper : public vtkUnstructuredGridVolumeRayCastMapper {
public:
  static WindowlessMapper *New();
  vtkTypeMacro(WindowlessMapper, vtkUnstructuredGridVolumeRayCastMapper)

      void SetImageSize(int width, int height) {
    ImageViewportSize[0] = ImageInUseSize[0] = width;
    ImageViewportSize[1] = ImageInUseSize[1] = height;
    ImageOrigin[0] = ImageOrigin[1] = 0;
  }

protected:
  WindowlessMapper() = default;
};
vtkStandardNewMacro(WindowlessMapper);

// Where the mapper would send its pictures. The class that VTK has for it belongs to OpenGL, and the mapper can't do
// without one.
class NoDisplay : public vtkRayCastImageDisplayHelper {
public:
  static NoDisplay *New();
  vtkTypeMacro(NoDisplay, vtkRayCastImageDisplayHelper) void RenderTexture(vtkVolume *, vtkRenderer *, int[2], int[2],
                                                                           int[2], int[2], float,
                                                                           unsigned char *) override {}
  void RenderTexture(vtkVolume *, vtkRenderer *, int[2], int[2], int[2], int[2], float, unsigned short *) override {}
  void RenderTexture(vtkVolume *, vtkRenderer *, vtkFixedPointRayCastImage *, float) override {}
};
vtkStandardNewMacro(NoDisplay);
VTK_CREATE_CREATE_FUNCTION(NoDisplay)

class Factory : public vtkObjectFactory {
public:
  static Factory *New();
  vtkTypeMacro(Factory, vtkObjectFactory) const char *GetVTKSourceVersion() override { return VTK_SOURCE_VERSION; }
  const char *GetDescription() override { return "no display"; }

protected:
  Factory() {
    RegisterOverride("vtkRayCastImageDisplayHelper", "NoDisplay", "no display", 1, vtkObjectFactoryCreateNoDisplay);
  }
};
vtkStandardNewMacro(Factory);

vtkSmartPointer<vtkDataArray> borrow(TetcastType type, void *data, vtkIdType count, int components) {
  vtkSmartPointer<vtkDataArray> array;
  if (type == TETCAST_TYPE_FLOAT32) {
    array = vtkSmartPointer<vtkFloatArray>::New();
  } else {
    array = vtkSmartPointer<vtkDoubleArray>::New();
  }
  array->SetNumberOfComponents(components);
  array->SetVoidArray(data, count * components, 1);
  return array;
}

vtkSmartPointer<vtkUnstructuredGrid> make_grid(const BenchMesh &mesh) {
  vtkNew<vtkPoints> points;
  points->SetData(borrow(mesh.type, mesh.vertices, mesh.vertex_count, 3));
  vtkNew<vtkTypeInt32Array> offsets, corners;
  offsets->SetNumberOfValues(mesh.cell_count + 1);
  for (vtkIdType i = 0; i <= mesh.cell_count; i++) {
    offsets->SetValue(i, static_cast<vtkTypeInt32>(4 * i));
  }
  corners->SetVoidArray(mesh.cells, 4 * mesh.cell_count, 1);
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, corners);
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, cells);
  grid->GetPointData()->SetScalars(borrow(mesh.type, mesh.scalars, mesh.vertex_count, 1));
  return grid;
}

} // namespace

struct Caster {
  vtkSmartPointer<vtkUnstructuredGrid> grid;
  vtkNew<WindowlessMapper> mapper;
  vtkNew<vtkVolume> volume;
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkUnstructuredGridBunykRayCastFunction> function;
  vtkSmartPointer<vtkUnstructuredGridVolumeRayIntegrator> integrator;
  int width = 0, height = 0;
};

// The field and the unit vector from eye to target, and how far off along it the grid's bounds begin and end.
static void set_camera(vtkCamera *to, const TetcastCamera &from, const double bounds[6], int width, int height) {
  to->SetPosition(from.eye);
  to->SetFocalPoint(from.target);
  to->SetViewUp(from.up);
  to->SetParallelProjection(from.projection == TETCAST_ORTHOGRAPHIC);
  to->SetParallelScale(from.height / 2);
  to->SetViewAngle(from.fovy);
  // VTK casts the ray of pixel x through x pixels from the left edge, where tetcast's goes through x + 1/2.
  to->SetWindowCenter(1. / width, 1. / height);
  double direction[3], nearest = 0, farthest = 0;
  to->GetDirectionOfProjection(direction);
  for (int corner = 0; corner < 8; corner++) {
    double depth = 0;
    for (int k = 0; k < 3; k++) {
      depth += direction[k] * (bounds[2 * k + (corner >> k & 1)] - from.eye[k]);
    }
    nearest = corner == 0 || depth < nearest ? depth : nearest;
    farthest = corner == 0 || depth > farthest ? depth : farthest;
  }
  double margin = 0.01 * (farthest - nearest);
  to->SetClippingRange(nearest - margin, farthest + margin);
}

Caster *caster_create(const BenchMesh *mesh) try {
  static const bool registered = [] {
    vtkNew<Factory> factory;
    vtkObjectFactory::RegisterFactory(factory);
    return true;
  }();
  static_cast<void>(registered);
  auto caster = std::make_unique<Caster>();
  caster->grid = make_grid(*mesh);
  caster->mapper->SetInputData(static_cast<vtkUnstructuredGridBase *>(caster->grid.Get()));
  caster->volume->SetMapper(caster->mapper);
  vtkNew<vtkCamera> camera; // the renderer would make one that looks at everything
  caster->renderer->SetActiveCamera(camera);
  return caster.release();
} catch (const std::exception &) {
  return nullptr;
}

void caster_destroy(Caster *caster) {
  delete caster;
}

bool caster_view(Caster *caster, const TetcastCamera *camera, int width, int height) try {
  caster->width = width;
  caster->height = height;
  caster->mapper->SetImageSize(width, height);
  caster->renderer->SetAspect(static_cast<double>(width) / height, 1);
  set_camera(caster->renderer->GetActiveCamera(), *camera, caster->grid->GetBounds(), width, height);
  caster->function->Initialize(caster->renderer, caster->volume);
  return true;
} catch (const std::exception &) {
  return false;
}

bool caster_transfer(Caster *caster, const TetcastTransferFunctionDesc *transfer, CasterIntegrator integrator) try {
  vtkNew<vtkColorTransferFunction> color;
  for (int64_t i = 0; i < transfer->color_count; i++) {
    const double *knot = transfer->color + 4 * i;
    color->AddRGBPoint(knot[0], knot[1], knot[2], knot[3]);
  }
  vtkNew<vtkPiecewiseFunction> opacity;
  for (int64_t i = 0; i < transfer->opacity_count; i++) {
    const double *knot = transfer->opacity + 2 * i;
    opacity->AddPoint(knot[0], knot[1]);
    // VTK 9.1's linear integrators split at the colours' knots but only at the first of the opacity: theirs go for
    // both.
    double rgb[3];
    color->GetColor(knot[0], rgb);
    color->AddRGBPoint(knot[0], rgb[0], rgb[1], rgb[2]);
  }
  vtkNew<vtkVolumeProperty> property;
  property->SetColor(color);
  property->SetScalarOpacity(opacity);
  property->SetScalarOpacityUnitDistance(transfer->unit_distance);
  caster->volume->SetProperty(property);
  if (integrator == CASTER_LINEAR) {
    caster->integrator = vtkSmartPointer<vtkUnstructuredGridLinearRayIntegrator>::New();
  } else if (integrator == CASTER_PARTIAL) {
    caster->integrator = vtkSmartPointer<vtkUnstructuredGridPartialPreIntegration>::New();
  } else {
    caster->integrator = vtkSmartPointer<vtkUnstructuredGridPreIntegration>::New();
  }
  caster->integrator->Initialize(caster->volume, caster->grid->GetPointData()->GetScalars());
  return true;
} catch (const std::exception &) {
  return false;
}

int64_t caster_cast(Caster *caster, float *pixels) {
  vtkDataArray *scalars = caster->grid->GetPointData()->GetScalars();
  auto iterator = vtkSmartPointer<vtkUnstructuredGridVolumeRayCastIterator>::Take(caster->function->NewIterator());
  auto near = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(scalars->GetDataType()));
  auto far = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(scalars->GetDataType()));
  vtkNew<vtkDoubleArray> lengths;
  int64_t crossed = 0;
  for (int y = 0; y < caster->height; y++) {
    for (int x = 0; x < caster->width; x++) {
      float *pixel = pixels + 4 * (static_cast<size_t>(caster->height - 1 - y) * caster->width + x);
      pixel[0] = pixel[1] = pixel[2] = pixel[3] = 0;
      iterator->SetBounds(0, 1);
      iterator->Initialize(x, y);
      do {
        vtkIdType count = iterator->GetNextIntersections(nullptr, lengths, scalars, near, far);
        if (count < 1) {
          break;
        }
        crossed += count;
        caster->integrator->Integrate(lengths, near, far, pixel);
      } while (pixel[3] < 0.99);
    }
  }
  return crossed;
}

int64_t caster_contour(Caster *caster, const double *values, int count) try {
  vtkNew<vtkContourFilter> filter;
  filter->SetInputData(caster->grid);
  filter->ComputeNormalsOff();
  filter->ComputeScalarsOff();
  for (int i = 0; i < count; i++) {
    filter->SetValue(i, values[i]);
  }
  filter->Update();
  return filter->GetOutput()->GetNumberOfPolys();
} catch (const std::exception &) {
  return -1;
}

const char *caster_vtk_version(void) {
  return vtkVersion::GetVTKVersion();
}
