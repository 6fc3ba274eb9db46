/* SPDX-License-Identifier: Apache-2.0 */
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "caster.h"
#include "judge.h"

using namespace reference;

namespace {

const char usage[] =
    "usage: tetcast_reference SCENE.json [IMAGE.tif [OTHER.tif]] [options]\n"
    "       tetcast_reference --describe SCENE.json\n"
    "Computes the picture of a scene file (tetcast render --save-scene) by brute force and compares one or two "
    "images,\n"
    "RGBA of 64 bits, with it; two also with each other, in all pixels. Exit code 1: they differ by more.\n"
    "  --tolerance X   largest difference of a channel, default 1e-12\n"
    "  --every N       only each N-th pixel, counted along the rows, and where the two images differ\n"
    "  --pixel X,Y     only this pixel, from 0,0 at the top left; may be repeated; its values are printed\n"
    "  --condition     a pixel may also differ by as much as it changes if its ray is moved by 2^-50 of the largest\n"
    "                  coordinate, a few roundings\n"
    "  --quad          in __float128 instead of long double, about fifty times slower\n"
    "  --threads N     default: all processors\n"
    "  --transfer FILE reads the transfer function from this file instead: opacities are saved in scenes as "
    "extinction\n"
    "  --output FILE   writes what was computed, zero where nothing was\n"
    "Pixels behind which cells overlap, so that there is no right answer, are left out and counted.\n"
    "--describe prints xmin xmax ymin ymax zmin zmax, lowest and highest finite value, x y z of a point inside a "
    "cell,\n"
    "and the number of cells.\n";

struct Options {
  std::vector<std::string> paths;
  double tolerance = 1e-12;
  int64_t every = 1;
  std::vector<std::array<int64_t, 2>> pixels;
  bool quad = false, describe = false, condition = false;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  std::string transfer, output;
};

struct Usage : Error {
  using Error::Error;
};

Options parse(int argc, char **argv) {
  Options options;
  for (int i = 1; i < argc; i++) {
    const std::string word = argv[i];
    const auto argument = [&]() -> std::string {
      if (++i == argc)
        throw Usage(word + " needs an argument");
      return argv[i];
    };
    if (word == "--tolerance") {
      options.tolerance = std::stod(argument());
    } else if (word == "--every") {
      options.every = std::max(1LL, std::stoll(argument()));
    } else if (word == "--pixel") {
      long long x, y;
      if (std::sscanf(argument().c_str(), "%lld,%lld", &x, &y) != 2)
        throw Usage("--pixel needs X,Y");
      options.pixels.push_back({x, y});
    } else if (word == "--quad") {
      options.quad = true;
    } else if (word == "--condition") {
      options.condition = true;
    } else if (word == "--describe") {
      options.describe = true;
    } else if (word == "--threads") {
      options.threads = unsigned(std::max(1, std::stoi(argument())));
    } else if (word == "--transfer") {
      options.transfer = argument();
    } else if (word == "--output") {
      options.output = argument();
    } else if (word.rfind("--", 0) == 0) {
      throw Usage("unknown option " + word);
    } else {
      options.paths.push_back(word);
    }
  }
  if (options.paths.empty() || options.paths.size() > (options.describe ? 1 : 3))
    throw Usage("wrong number of files");
  return options;
}

/* Indices of the pixels to be computed. */
std::vector<size_t> choose(const Options &options, const Scene &scene, const std::vector<std::vector<double>> &images) {
  std::vector<size_t> chosen;
  for (const auto &[x, y] : options.pixels) {
    if (x < 0 || y < 0 || x >= scene.width || y >= scene.height)
      throw Usage("--pixel: outside the picture");
    chosen.push_back(size_t(y * scene.width + x));
  }
  if (options.pixels.empty())
    for (int64_t i = 0; i < scene.width * scene.height; i++)
      if (i % options.every == 0 ||
          (images.size() > 1 && distance(images[0], images[1], size_t(i)) > options.tolerance))
        chosen.push_back(size_t(i));
  return chosen;
}

/* Half an image each may be off before it is asked how well conditioned a pixel is, as two are compared. */
template <class Real>
Truth compute(const Scene &scene, const std::vector<size_t> &chosen, const std::vector<std::vector<double>> &images,
              const Options &options) {
  const Caster<Real> caster(scene);
  const size_t count = size_t(scene.width * scene.height);
  Truth truth{std::vector<double>(4 * count), std::vector<char>(count), std::vector<double>(count)};
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < chosen.size(); i = next++) {
      const size_t pixel = chosen[i];
      bool folded = false;
      const auto rgba = caster.pixel_rgba(int64_t(pixel) % scene.width, int64_t(pixel) / scene.width, &folded);
      for (size_t c = 0; c < 4; c++)
        truth.rgba[pixel * 4 + c] = double(rgba[c]);
      truth.folded[pixel] = folded;
      for (const auto &image : images)
        if (distance(truth.rgba, image, pixel) > options.tolerance / 2)
          truth.moved[pixel] = double(caster.pixel_change(int64_t(pixel) % scene.width, int64_t(pixel) / scene.width));
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < options.threads; i++)
    threads.emplace_back(work);
  work();
  for (auto &thread : threads)
    thread.join();
  return truth;
}

void describe(const Options &options) {
  const Mesh mesh = read_scene(options.paths[0]).mesh;
  double low[4], high[4];
  std::fill(low, low + 4, HUGE_VAL);
  std::fill(high, high + 4, -HUGE_VAL);
  const auto widen = [&](size_t k, double value) {
    low[k] = std::min(low[k], value);
    high[k] = std::max(high[k], value);
  };
  for (const auto &cell : mesh.cells)
    for (int64_t v : cell)
      for (size_t k = 0; k < 3; k++)
        widen(k, mesh.points[size_t(v)][k]);
  for (double value : mesh.values)
    if (std::isfinite(value))
      widen(3, value);
  for (size_t k = 0; k < 4; k++)
    std::printf("%.17g %.17g ", low[k], high[k]);
  const auto &cell = mesh.cells.at(mesh.cells.size() / 2);
  for (size_t k = 0; k < 3; k++) {
    double sum = 0;
    for (int64_t v : cell)
      sum += mesh.points[size_t(v)][k] / 4;
    std::printf("%.17g ", sum);
  }
  std::printf("%zu\n", mesh.cells.size());
}

bool run(const Options &options) {
  if (options.describe) {
    describe(options);
    return true;
  }
  Scene scene = read_scene(options.paths[0]);
  if (!options.transfer.empty())
    scene.transfer = read_transfer(options.transfer);
  std::vector<std::vector<double>> images;
  for (size_t i = 1; i < options.paths.size(); i++)
    images.push_back(read_image(options.paths[i], scene.width, scene.height));
  const std::vector<size_t> chosen = choose(options, scene, images);
  Truth truth;
  if (options.quad)
#ifdef TETCAST_REFERENCE_QUAD
    truth = compute<Quad>(scene, chosen, images, options);
#else
    throw Error("--quad: the compiler has no __float128");
#endif
  else
    truth = compute<Extended>(scene, chosen, images, options);
  if (!options.output.empty())
    write_image(options.output, truth.rgba, scene.width, scene.height);
  for (size_t i = 0; i < options.pixels.size(); i++) {
    const double *rgba = &truth.rgba[chosen[i] * 4];
    std::printf("%lld,%lld: %.17g %.17g %.17g %.17g%s\n", static_cast<long long>(options.pixels[i][0]),
                static_cast<long long>(options.pixels[i][1]), rgba[0], rgba[1], rgba[2], rgba[3],
                truth.folded[chosen[i]] ? ", but cells overlap" : "");
  }
  return images.empty() || judge(scene, truth, chosen, images, options.tolerance, options.condition);
}

} // namespace

int main(int argc, char **argv) {
  try {
    return run(parse(argc, argv)) ? 0 : 1;
  } catch (const Usage &error) {
    std::fprintf(stderr, "tetcast_reference: %s\n%s", error.what(), usage);
    return 2;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "tetcast_reference: %s\n", error.what());
    return 1;
  }
}
