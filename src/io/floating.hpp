// SPDX-License-Identifier: Apache-2.0
// The floating-point environment, which adapters handle as the core does (base/floating.h).
#ifndef TCIO_FLOATING_HPP
#define TCIO_FLOATING_HPP

#include <cfenv>

// While an object lives, the default environment is set, so that results don't depend on the host's rounding and no
// exception of VTK, TetGen or OpenImageIO is trapped. Then the host's environment is as it was, flags included. Every
// public function begins with one.
class FloatingPoint {
public:
  FloatingPoint() {
    std::fegetenv(&host);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatingPoint() { std::fesetenv(&host); }
  FloatingPoint(const FloatingPoint &) = delete;
  FloatingPoint &operator=(const FloatingPoint &) = delete;

private:
  std::fenv_t host;
};

#endif
