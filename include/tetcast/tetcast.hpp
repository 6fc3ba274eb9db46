/* SPDX-License-Identifier: Apache-2.0 */
/* libtetcast for C++17: handles that free what they hold, arrays from containers, and errors as exceptions or as
 * statuses, whichever is preferred, call by call:
 *
 *     tetcast::Context context;
 *     auto mesh = tetcast::make<tetcast::Mesh>(tetcast_mesh_create, context, &desc);   // throws tetcast::Error
 *
 *     tetcast::Mesh other;                                                             // throws nothing
 *     TetcastStatus status = tetcast_mesh_create(context, &desc, other.out());
 *
 * A handle converts to the pointer that C functions take, so all of them are called as they are; check() makes an
 * exception of what they return. Nothing here is compiled into the library. */
#ifndef TETCAST_TETCAST_HPP
#define TETCAST_TETCAST_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <tetcast/tetcast.h>

namespace tetcast {

/* ── errors ── */

namespace detail {
/* The last error's sentence on this thread, which is the one that contexts send it on. */
inline std::string &last_message() {
  thread_local std::string message;
  return message;
}
} // namespace detail

/* What a call failed with: its status, and the sentence that explains it, or the status' phrase where there was none.
 */
class Error : public std::runtime_error {
public:
  Error(TetcastStatus status, const std::string &text) : std::runtime_error(text), status_(status) {}
  TetcastStatus status() const noexcept { return status_; }

private:
  TetcastStatus status_;
};

/* Throws an Error unless the status is TETCAST_OK. The sentence is that of the last error on this thread in a Context.
 */
inline void check(TetcastStatus status) {
  const std::string message = std::exchange(detail::last_message(), std::string());
  if (status != TETCAST_OK)
    throw Error(status, message.empty() ? tetcast_status_string(status) : message);
}

/* ── handles ── */

/* Owns an object that has a destroy function, of this library or of an adapter. It can be moved, not copied. */
template <typename Object, void (*destroy)(Object **)> class Handle {
public:
  Handle() noexcept = default;
  explicit Handle(Object *object) noexcept : object_(object) {}
  Handle(Handle &&other) noexcept : object_(other.release()) {}
  Handle &operator=(Handle &&other) noexcept {
    if (this != &other)
      *out() = other.release();
    return *this;
  }
  Handle(const Handle &) = delete;
  Handle &operator=(const Handle &) = delete;
  ~Handle() { destroy(&object_); }

  operator Object *() const noexcept { return object_; }
  Object *get() const noexcept { return object_; }
  /* Frees what it holds, and says where a C function may put another object. */
  Object **out() noexcept {
    destroy(&object_);
    return &object_;
  }
  /* Hands the object over: it is not freed here any more. */
  Object *release() noexcept { return std::exchange(object_, nullptr); }

private:
  Object *object_ = nullptr;
};

using Mesh = Handle<TetcastMesh, tetcast_mesh_destroy>;
using Field = Handle<TetcastField, tetcast_field_destroy>;
using Cut = Handle<TetcastCut, tetcast_cut_destroy>;
using Volume = Handle<TetcastVolume, tetcast_volume_destroy>;
using TransferFunction = Handle<TetcastTransferFunction, tetcast_transfer_function_destroy>;
using Scene = Handle<TetcastScene, tetcast_scene_destroy>;
using Frame = Handle<TetcastFrame, tetcast_frame_destroy>;
using Fragments = Handle<TetcastFragments, tetcast_fragments_destroy>;

/* The object that create(arguments…, &object) makes; throws an Error if it makes none. */
template <typename Object, typename Create, typename... Arguments>
Object make(Create create, Arguments &&...arguments) {
  Object object;
  check(create(std::forward<Arguments>(arguments)..., object.out()));
  return object;
}

/* ── the context ── */

/* Receives every message. What it throws is dropped. */
using MessageHandler = std::function<void(TetcastSeverity, const char *)>;

/* A context that keeps errors' sentences for check(). It must outlive every object made from it. */
class Context {
public:
  /* `threads`: 0, one per processor. Throws an Error. */
  explicit Context(int threads = 0, MessageHandler handler = {}) : Context(with_threads(threads), std::move(handler)) {}
  /* The desc's own message function is not used. */
  explicit Context(TetcastContextDesc desc, MessageHandler handler = {})
      : handler_(std::make_unique<MessageHandler>(std::move(handler))) {
    desc.message = receive;
    desc.message_user = handler_.get();
    check(tetcast_context_create(&desc, context_.out()));
  }
  Context(Context &&) = default;
  Context &operator=(Context &&) = delete;
  operator TetcastContext *() const noexcept { return context_; }

private:
  static TetcastContextDesc with_threads(int threads) {
    TetcastContextDesc desc = tetcast_context_desc_default();
    desc.threads = threads;
    return desc;
  }
  static void receive(void *user, TetcastSeverity severity, const char *text) {
    try {
      if (severity == TETCAST_SEVERITY_ERROR)
        detail::last_message() = text;
      if (const auto &handler = *static_cast<const MessageHandler *>(user))
        handler(severity, text);
    } catch (...) { // the library may not be left by an exception
    }
  }

  std::unique_ptr<MessageHandler> handler_; // stays where it is when the context is moved
  Handle<TetcastContext, tetcast_context_destroy> context_;
};

/* Calls a function during long work, with the fraction done; false cancels, and so does an exception, which comes out
 * of rethrow(). Must stay in place during the call: desc.progress = progress. */
class Progress {
public:
  explicit Progress(std::function<bool(double)> function) : function_(std::move(function)) {}
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;
  operator TetcastProgress() noexcept { return {call, this}; }
  void rethrow() {
    if (exception_)
      std::rethrow_exception(std::exchange(exception_, nullptr));
  }

private:
  static bool call(void *user, double fraction) {
    auto *progress = static_cast<Progress *>(user);
    try {
      return progress->function_(fraction);
    } catch (...) {
      progress->exception_ = std::current_exception();
      return false;
    }
  }

  std::function<bool(double)> function_;
  std::exception_ptr exception_;
};

/* ── arrays ── */

/* A pointer and a number of elements; C++20 has std::span. */
template <typename Element> class Span {
public:
  constexpr Span(Element *data, std::size_t size) noexcept : data_(data), size_(size) {}
  constexpr Element *data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr Element *begin() const noexcept { return data_; }
  constexpr Element *end() const noexcept { return data_ + size_; }
  constexpr Element &operator[](std::size_t i) const noexcept { return data_[i]; }

private:
  Element *data_;
  std::size_t size_;
};

/* The TetcastType of a type of numbers. */
template <typename Number> constexpr TetcastType type_of() {
  static_assert(std::is_arithmetic_v<Number> && (sizeof(Number) == 4 || sizeof(Number) == 8),
                "arrays hold numbers of four or eight bytes");
  constexpr bool wide = sizeof(Number) == 8;
  if constexpr (std::is_floating_point_v<Number>)
    return wide ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
  else if constexpr (std::is_signed_v<Number>)
    return wide ? TETCAST_TYPE_INT64 : TETCAST_TYPE_INT32;
  else
    return wide ? TETCAST_TYPE_UINT64 : TETCAST_TYPE_UINT32;
}

namespace detail {
template <typename Element> struct Tuple {
  using Number = Element;
  static constexpr std::size_t components = 1;
};
template <typename Component, std::size_t count> struct Tuple<std::array<Component, count>> {
  using Number = Component;
  static constexpr std::size_t components = count;
};
template <typename Component, std::size_t count> struct Tuple<Component[count]> {
  using Number = Component;
  static constexpr std::size_t components = count;
};
} // namespace detail

/* A view of a container whose elements lie in a row (std::vector, std::array, Span, an array), for a desc. An element
 * is a tuple, such as std::array<double, 3>, or a number, of which `components` make a tuple. Throws
 * std::invalid_argument if the last tuple isn't whole. Nothing is copied: the elements must stay where they are for as
 * long as the view is used. */
template <typename Element> TetcastArray array(Span<Element> elements, std::size_t components = 1) {
  using Tuple = detail::Tuple<std::remove_cv_t<Element>>;
  const std::size_t in_tuple = Tuple::components == 1 ? components : 1;
  if (in_tuple == 0 || elements.size() % in_tuple != 0)
    throw std::invalid_argument("an array of numbers that is not one of whole tuples");
  return {elements.data(), type_of<typename Tuple::Number>(), static_cast<std::int64_t>(elements.size() / in_tuple), 0};
}
template <typename Container> TetcastArray array(const Container &container, std::size_t components = 1) {
  return array(Span(std::data(container), std::size(container)), components);
}
/* A temporary container would be gone before the view is used. */
template <typename Container> TetcastArray array(const Container &&, std::size_t = 1) = delete;

/* ── pictures ── */

/* Renders, and says what was done; throws an Error. */
inline TetcastRenderStats render(const TetcastScene *scene, const TetcastCamera &camera, TetcastFrame *frame,
                                 const TetcastRenderDesc &desc = tetcast_render_desc_default()) {
  TetcastRenderStats stats = {};
  check(tetcast_scene_render(scene, &camera, &desc, frame, &stats));
  return stats;
}

/* Row `j` of a frame of floats or doubles: red, green, blue, alpha for each pixel. Throws std::invalid_argument if the
 * frame has pixels of the other type, and std::out_of_range if it has no such row. Valid while the frame lives. */
template <typename Number> Span<const Number> row_of(const TetcastFrame *frame, std::int64_t j) {
  if (tetcast_frame_type(frame) != type_of<Number>())
    throw std::invalid_argument("the frame's pixels are of another type");
  if (j < 0 || j >= tetcast_frame_height(frame))
    throw std::out_of_range("the frame has no such row");
  const auto *first = static_cast<const char *>(tetcast_frame_pixels(frame));
  return {reinterpret_cast<const Number *>(first + j * tetcast_frame_row_stride(frame)),
          static_cast<std::size_t>(tetcast_frame_width(frame)) * 4};
}

} // namespace tetcast

#endif
