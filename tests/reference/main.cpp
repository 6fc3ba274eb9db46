/* SPDX-License-Identifier: Apache-2.0 */
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <thread>

#include "caster.h"

using namespace reference;

namespace {

const char usage[] =
  "usage: tetcast_reference SCENE.json [IMAGE.tif] [options]\n"
  "       tetcast_reference --compare A.tif B.tif WxH [--tolerance X]\n"
  "       tetcast_reference --describe SCENE.json\n"
  "Computes the picture of a scene file (tetcast render --save-scene) by brute force and compares IMAGE.tif, RGBA of\n"
  "64 bits, with it. Exit code 1: they differ by more than the tolerance.\n"
  "  --tolerance X   largest difference of a channel, default 1e-12\n"
  "  --every N       only each N-th pixel, counted along the rows\n"
  "  --pixel X,Y     only this pixel, from 0,0 at the top left; may be repeated; its values are printed\n"
  "  --quad          in __float128 instead of long double, about fifty times slower\n"
  "  --threads N     default: all processors\n"
  "  --transfer FILE reads the transfer function from this file instead: opacities are saved in scenes as extinction\n"
  "  --output FILE   writes what was computed, zero where nothing was\n"
  "--compare compares two images; --describe prints xmin xmax ymin ymax zmin zmax, lowest and highest finite value,\n"
  "x y z of a point inside a cell, and the number of cells.\n";

struct Options {
  std::vector<std::string> paths;
  double tolerance = 1e-12;
  int64_t every = 1;
  std::vector<std::array<int64_t, 2>> pixels;
  bool quad = false, compare = false, describe = false;
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
    } else if (word == "--compare") {
      options.compare = true;
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
  const size_t least = options.compare ? 3 : 1, most = options.compare ? 3 : options.describe ? 1 : 2;
  if (options.paths.size() < least || options.paths.size() > most)
    throw Usage("wrong number of files");
  return options;
}

/* Indices of the pixels to be computed. */
std::vector<size_t> choose(const Options &options, int64_t width, int64_t height) {
  std::vector<size_t> chosen;
  for (const auto &[x, y] : options.pixels) {
    if (x < 0 || y < 0 || x >= width || y >= height)
      throw Usage("--pixel: outside the picture");
    chosen.push_back(size_t(y * width + x));
  }
  if (chosen.empty())
    for (int64_t i = 0; i < width * height; i += options.every)
      chosen.push_back(size_t(i));
  return chosen;
}

template <class Real>
std::vector<double> compute(const Scene &scene, const std::vector<size_t> &chosen, unsigned thread_count) {
  const Caster<Real> caster(scene);
  std::vector<double> image(size_t(scene.width * scene.height * 4));
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < chosen.size(); i = next++) {
      const int64_t index = int64_t(chosen[i]);
      const auto rgba = caster.pixel_rgba(index % scene.width, index / scene.width);
      for (size_t c = 0; c < 4; c++)
        image[chosen[i] * 4 + c] = double(rgba[c]);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < thread_count; i++)
    threads.emplace_back(work);
  work();
  for (auto &thread : threads)
    thread.join();
  return image;
}

/* Prints how far `image` is from `truth`; whether that is within the tolerance. */
bool compare(const std::vector<double> &truth, const std::vector<double> &image, const std::vector<size_t> &chosen,
             int64_t width, double tolerance) {
  double overall = 0, alpha = 0;
  int64_t beyond = 0;
  for (size_t pixel : chosen)
    alpha += truth[pixel * 4 + 3] / double(chosen.size());
  for (size_t c = 0; c < 4; c++) {
    double largest = -1, squares = 0;
    size_t where = 0;
    for (size_t pixel : chosen) {
      const double difference = std::abs(image[pixel * 4 + c] - truth[pixel * 4 + c]);
      const double error = std::isnan(difference) ? HUGE_VAL : difference;
      squares += error * error;
      beyond += error > tolerance;
      if (error > largest) {
        largest = error;
        where = pixel;
      }
    }
    std::printf("%c  max %.2e  rms %.2e  worst at %zu,%zu: %.17g, should be %.17g\n", "RGBA"[c], largest,
                std::sqrt(squares / double(chosen.size())), where % size_t(width), where / size_t(width),
                image[where * 4 + c], truth[where * 4 + c]);
    overall = std::max(overall, largest);
  }
  std::printf("%zu pixels of average alpha %.3f compared, max %.2e, %lld values beyond %g\n", chosen.size(), alpha,
              overall, static_cast<long long>(beyond), tolerance);
  return overall <= tolerance;
}

bool compare_files(const Options &options) {
  int width, height;
  if (std::sscanf(options.paths[2].c_str(), "%dx%d", &width, &height) != 2)
    throw Usage("--compare needs WxH");
  return compare(read_image(options.paths[0], width, height), read_image(options.paths[1], width, height),
                 choose(options, width, height), width, options.tolerance);
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
  if (options.compare)
    return compare_files(options);
  Scene scene = read_scene(options.paths[0]);
  if (!options.transfer.empty())
    scene.transfer = read_transfer(options.transfer);
  const std::vector<size_t> chosen = choose(options, scene.width, scene.height);
  std::vector<double> truth;
  if (options.quad)
#ifdef TETCAST_REFERENCE_QUAD
    truth = compute<Quad>(scene, chosen, options.threads);
#else
    throw Error("--quad: the compiler has no __float128");
#endif
  else
    truth = compute<Extended>(scene, chosen, options.threads);
  if (!options.output.empty())
    write_image(options.output, truth, scene.width, scene.height);
  for (size_t i = 0; i < options.pixels.size(); i++) {
    const double *rgba = &truth[chosen[i] * 4];
    std::printf("%zu,%zu: %.17g %.17g %.17g %.17g\n", chosen[i] % size_t(scene.width), chosen[i] / size_t(scene.width),
                rgba[0], rgba[1], rgba[2], rgba[3]);
  }
  if (options.paths.size() < 2)
    return true;
  return compare(truth, read_image(options.paths[1], scene.width, scene.height), chosen, scene.width,
                 options.tolerance);
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
