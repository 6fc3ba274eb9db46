// SPDX-License-Identifier: Apache-2.0
// What adapters have in common with the core in a host that is not ours: the floating-point environment.
#ifndef TCIO_FLOATING_HPP
#define TCIO_FLOATING_HPP

#include <cfenv>

// While it lives, the default environment is set: results don't depend on the host's rounding, and no exception of VTK,
// TetGen or OpenImageIO is trapped. Then the host's is as it was, flags included. The first thing in what a public
// function does.
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
