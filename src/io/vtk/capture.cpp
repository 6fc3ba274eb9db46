// SPDX-License-Identifier: Apache-2.0
// VTK prints its errors through one global output window and, independently of that, a logger. Both are replaced while
// a capture lives, and put back with the last one; what threads without a capture say goes where it went before.
#include "common.hpp"

#include <cstring>
#include <mutex>
#include <utility>

#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>
#ifdef TETCAST_VTK_LOGURU
#include <vtk_loguru.h>
#endif

namespace {

thread_local tcv::Capture *current = nullptr;

std::mutex mutex; // It guards the variables below.
int captures = 0;
vtkSmartPointer<vtkOutputWindow> previous;
int previous_display = 1;
#ifdef TETCAST_VTK_LOGURU
loguru::Verbosity previous_verbosity = 0;
#endif

class Window : public vtkOutputWindow {
public:
  static Window *New();
  vtkTypeMacro(Window, vtkOutputWindow)

      void DisplayText(const char *text) override {
    take(text, false, &vtkOutputWindow::DisplayText);
  }
  void DisplayErrorText(const char *text) override { take(text, true, &vtkOutputWindow::DisplayErrorText); }
  void DisplayWarningText(const char *text) override { take(text, false, &vtkOutputWindow::DisplayWarningText); }
  // The legacy readers report unreadable values this way and go on.
  void DisplayGenericWarningText(const char *text) override {
    take(text, true, &vtkOutputWindow::DisplayGenericWarningText);
  }
  void DisplayDebugText(const char *text) override { take(text, false, &vtkOutputWindow::DisplayDebugText); }

protected:
  Window() = default;

private:
  static void take(const char *text, bool is_error, void (vtkOutputWindow::*display)(const char *)) {
    if (current) {
      current->add(text, is_error);
      return;
    }
    vtkSmartPointer<vtkOutputWindow> window;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (previous_display)
        window = previous;
    }
    if (window)
      (window.Get()->*display)(text);
  }
};
vtkStandardNewMacro(Window)

    vtkOutputWindow *our_window() {
  // It is never destroyed, as another thread may still be inside it.
  static vtkSmartPointer<Window> window = vtkSmartPointer<Window>::New();
  return window;
}

// Turns "ERROR: In file.cxx, line 7\nvtkReader (0x55): Bad thing\nhappened.\n\n" into "Bad thing happened."
std::string tidy(const char *text) {
  const char *start = text;
  if (std::strstr(text, ": In ") || std::strstr(text, ":  In ")) {
    const char *line = std::strchr(text, '\n');
    if (line)
      start = line + 1;
  }
  if (std::strncmp(start, "vtk", 3) == 0) {
    const char *object = std::strstr(start, "): ");
    if (object && std::strchr(start, '(') < object)
      start = object + 3;
  }
  std::string line;
  for (const char *c = start; *c && line.size() < 400; ++c) {
    const bool space = static_cast<unsigned char>(*c) <= ' ';
    if (!space)
      line += *c;
    else if (!line.empty() && line.back() != ' ')
      line += ' ';
  }
  while (!line.empty() && line.back() == ' ')
    line.pop_back();
  return line;
}

} // namespace

namespace tcv {

Capture::Capture() {
  const std::lock_guard<std::mutex> lock(mutex);
  if (captures == 0) {
    previous = vtkOutputWindow::GetInstance();
    vtkOutputWindow::SetInstance(our_window());
    previous_display = vtkObject::GetGlobalWarningDisplay();
    vtkObject::GlobalWarningDisplayOn(); // If warnings were off, readers would fail without a sign.
#ifdef TETCAST_VTK_LOGURU
    previous_verbosity = loguru::g_stderr_verbosity;
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
#endif
  }
  ++captures;
  current = this;
}

Capture::~Capture() {
  current = nullptr;
  const std::lock_guard<std::mutex> lock(mutex);
  if (--captures > 0)
    return;
#ifdef TETCAST_VTK_LOGURU
  loguru::g_stderr_verbosity = previous_verbosity;
#endif
  vtkObject::SetGlobalWarningDisplay(previous_display);
  if (vtkOutputWindow::GetInstance() == our_window())
    vtkOutputWindow::SetInstance(previous);
  previous = nullptr;
}

Doubt::Doubt() : capture_(current) {
  if (!capture_)
    return;
  std::swap(failed_, capture_->failed_);
  std::swap(error_, capture_->error_);
}

Doubt::~Doubt() {
  if (!capture_)
    return;
  std::swap(failed_, capture_->failed_);
  std::swap(error_, capture_->error_);
}

bool Doubt::failed() const {
  return capture_ && capture_->failed_;
}
std::string Doubt::error() const {
  return capture_ ? capture_->error_ : "";
}

void Capture::add(const char *text, bool is_error) noexcept {
  try {
    // This message only says that a note in the file belongs to a part of VTK that is not loaded. The mesh does not
    // depend on it.
    if (!is_error && std::strstr(text, "Could not locate key"))
      return;
    // This message follows the error itself, or an error code, and is a page of addresses that help nobody.
    const bool says_nothing = std::strstr(text, "returned failure for request") != nullptr;
    std::string &first = is_error ? error_ : warning_;
    if (first.empty() && !says_nothing)
      first = tidy(text);
  } catch (...) { // Memory has run out. That something was said still counts.
  }
  if (is_error)
    failed_ = true;
}

} // namespace tcv
