/* SPDX-License-Identifier: Apache-2.0 */
/* The layer for C++: what handles free and when, errors as exceptions and as statuses, views of containers, a picture.
 */
#include <tetcast/tetcast.hpp>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <vector>

static int failures = 0;

static void expect(bool condition, const char *what) {
  if (!condition) {
    std::fprintf(stderr, "not as it should be: %s\n", what);
    ++failures;
  }
}

/* The exception that a function leaves with; nothing if it returns. */
template <typename Exception, typename Function> static std::string thrown(Function function) {
  try {
    function();
  } catch (const Exception &exception) {
    return exception.what();
  }
  return {};
}

static_assert(!std::is_copy_constructible_v<tetcast::Mesh> && !std::is_copy_assignable_v<tetcast::Mesh>);
static_assert(std::is_nothrow_move_constructible_v<tetcast::Mesh> && std::is_nothrow_move_assignable_v<tetcast::Mesh>);
static_assert(sizeof(tetcast::Mesh) == sizeof(TetcastMesh *));
static_assert(tetcast::type_of<float>() == TETCAST_TYPE_FLOAT32 && tetcast::type_of<double>() == TETCAST_TYPE_FLOAT64);
static_assert(tetcast::type_of<int>() == TETCAST_TYPE_INT32 && tetcast::type_of<unsigned>() == TETCAST_TYPE_UINT32);
static_assert(tetcast::type_of<long long>() == TETCAST_TYPE_INT64 &&
              tetcast::type_of<std::size_t>() == TETCAST_TYPE_UINT64);

/* An octahedron around an axis. */
static const std::vector<std::array<double, 3>> vertices = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0},
                                                            {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
static const int cells[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 2}};
static const std::vector<float> values = {1, 0, 0.5F, 0.5F, 0.5F, 0.5F};

static TetcastMeshDesc mesh_desc() {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = tetcast::array(vertices);
  desc.tetrahedra = tetcast::array(cells);
  desc.ownership = TETCAST_BORROW;
  return desc;
}

static void views_of_containers() {
  const TetcastArray points = tetcast::array(vertices), corners = tetcast::array(cells);
  expect(points.data == vertices.data() && points.count == 6 && points.type == TETCAST_TYPE_FLOAT64, "tuples");
  expect(corners.count == 4 && corners.type == TETCAST_TYPE_INT32 && corners.stride == 0, "rows");
  expect(tetcast::array(values).count == 6 && tetcast::array(values, 3).count == 2, "numbers");
  expect(tetcast::array(tetcast::Span(&cells[0][0], 16), 4).count == 4, "a span");
  const std::vector<double> none;
  expect(tetcast::array(none, 3).count == 0, "nothing");
  expect(!thrown<std::invalid_argument>([] { (void)tetcast::array(values, 4); }).empty(), "a tuple that isn't whole");
  expect(!thrown<std::invalid_argument>([] { (void)tetcast::array(values, 0); }).empty(), "tuples of nothing");
}

/* By an exception, with the sentence of just this call, or by a status, whatever the handler does. */
static void errors() {
  int messages = 0;
  const tetcast::Context context(1, [&](TetcastSeverity, const char *) {
    ++messages;
    throw 1; // is dropped
  });
  const std::vector<int> bad = {0, 1, 2, 6};
  TetcastMeshDesc desc = mesh_desc();
  desc.tetrahedra = tetcast::array(bad, 4);
  tetcast::Mesh mesh;
  expect(tetcast_mesh_create(context, &desc, mesh.out()) == TETCAST_ERROR_DATA && !mesh, "a status");
  const auto create = [&] { mesh = tetcast::make<tetcast::Mesh>(tetcast_mesh_create, context, &desc); };
  expect(thrown<tetcast::Error>(create) == "tetrahedron 0 names vertex 6, but there are 6 vertices, counted from 0",
         "an exception");
  expect(messages == 2, "the handler is called");
  try {
    create();
    expect(false, "an exception is thrown");
  } catch (const tetcast::Error &error) {
    expect(error.status() == TETCAST_ERROR_DATA, "its status");
  }
  const std::string phrase = tetcast_status_string(TETCAST_ERROR_LIMIT);
  expect(thrown<tetcast::Error>([] { tetcast::check(TETCAST_ERROR_LIMIT); }) == phrase,
         "an old sentence is not said again");
  tetcast::check(TETCAST_OK);
}

static void handles() {
  const tetcast::Context context(2);
  expect(tetcast_context_threads(context) == 2, "threads");
  const TetcastMeshDesc desc = mesh_desc();
  auto mesh = tetcast::make<tetcast::Mesh>(tetcast_mesh_create, context, &desc);
  TetcastMesh *const object = mesh;
  tetcast::Mesh other = std::move(mesh);
  expect(!mesh && other == object, "moved"); // NOLINT: what is left there is what is tested
  mesh = std::move(other);
  expect(mesh.get() == object && !other, "moved back");                     // NOLINT
  mesh = tetcast::make<tetcast::Mesh>(tetcast_mesh_create, context, &desc); // frees the first one
  expect(tetcast_mesh_create(context, &desc, mesh.out()) == TETCAST_OK && mesh, "another one in its place");
  TetcastMesh *released = mesh.release();
  expect(released && !mesh, "released");
  tetcast_mesh_destroy(&released);
}

static tetcast::Frame frame_of(const tetcast::Context &context, TetcastType type) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = 32;
  desc.height = 24;
  desc.type = type;
  return tetcast::make<tetcast::Frame>(tetcast_frame_create, context, &desc);
}

static void pictures() {
  tetcast::Context first;
  const tetcast::Context context = std::move(first);
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = tetcast::array(values);
  const auto field = tetcast::make<tetcast::Field>(tetcast_field_create, context, &field_desc);
  const auto volume = [&] {
    const TetcastMeshDesc desc = mesh_desc();
    const auto mesh = tetcast::make<tetcast::Mesh>(tetcast_mesh_create, context, &desc);
    return tetcast::make<tetcast::Volume>(tetcast_volume_create, context, mesh, nullptr);
  }();
  const auto scene = tetcast::make<tetcast::Scene>(tetcast_scene_create, context, volume);
  tetcast::check(tetcast_scene_set_field(scene, field));
  const auto transfer_function =
      tetcast::make<tetcast::TransferFunction>(tetcast_scene_create_preset, scene, "viridis", 0.0, 1.0);
  tetcast::check(tetcast_scene_set_transfer_function(scene, transfer_function));

  const double bounds[6] = {-1, 1, -1, 1, -1, 1};
  const TetcastCamera camera = tetcast_camera_default(bounds, 4.0 / 3);
  const tetcast::Frame frame = frame_of(context, TETCAST_TYPE_FLOAT64);
  expect(tetcast::render(scene, camera, frame).rays == 32 * 24, "rays");
  const auto row = tetcast::row_of<double>(frame, 12);
  expect(row.size() == 32 * 4 && row[4 * 16 + 3] > 0.1 && row[3] <= 0, "the middle is seen, the corner is not");
  expect(!thrown<std::invalid_argument>([&] { (void)tetcast::row_of<float>(frame, 0); }).empty(), "floats of doubles");
  expect(!thrown<std::out_of_range>([&] { (void)tetcast::row_of<double>(frame, 24); }).empty(), "a row too many");
  const tetcast::Frame narrow = frame_of(context, TETCAST_TYPE_FLOAT32);
  tetcast::render(scene, camera, narrow);
  expect(tetcast::row_of<float>(narrow, 12)[4 * 16 + 3] == static_cast<float>(row[4 * 16 + 3]), "a frame of floats");

  TetcastRenderDesc desc = tetcast_render_desc_default();
  tetcast::Progress progress([](double) -> bool { throw std::length_error("enough"); });
  desc.progress = progress;
  tetcast::check(tetcast_context_set_threads(context, 1)); // the others might be done before the calling one reports
  expect(!thrown<tetcast::Error>([&] { tetcast::render(scene, camera, frame, desc); }).empty(), "cancelled");
  expect(thrown<std::length_error>([&] { progress.rethrow(); }) == "enough", "the exception that did it");
  progress.rethrow();
}

int main() {
  views_of_containers();
  errors();
  handles();
  pictures();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
