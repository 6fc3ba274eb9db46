// SPDX-License-Identifier: Apache-2.0
// tetcast_bench_plain FILE.vtu PICTURE.png WIDTHxHEIGHT: reads a mesh with VTK and writes a picture with OpenImageIO,
// and nothing between: what `tetcast render` can't do without.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

int main(int argc, char **argv) {
  int width = 0, height = 0;
  if (argc != 4 || std::sscanf(argv[3], "%dx%d", &width, &height) != 2 || width < 1 || height < 1) {
    std::fprintf(stderr, "usage: tetcast_bench_plain FILE.vtu PICTURE.png WIDTHxHEIGHT\n");
    return 2;
  }
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(argv[1]);
  reader->Update();
  if (reader->GetOutput()->GetNumberOfCells() == 0) {
    std::fprintf(stderr, "tetcast_bench_plain: %s has no cells\n", argv[1]);
    return 1;
  }
  std::vector<unsigned char> pixels;
  for (int j = 0; j < height; j++) {
    for (int i = 0; i < width; i++) {
      for (int k = 1; k <= 4; k++) {
        pixels.push_back(static_cast<unsigned char>((i * k + j) / 4));
      }
    }
  }
  auto output = OIIO::ImageOutput::create(argv[2]);
  if (!output || !output->open(argv[2], OIIO::ImageSpec(width, height, 4, OIIO::TypeDesc::UINT8)) ||
      !output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !output->close()) {
    std::fprintf(stderr, "tetcast_bench_plain: %s can't be written\n", argv[2]);
    return 1;
  }
  return 0;
}
