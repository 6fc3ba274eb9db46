// SPDX-License-Identifier: Apache-2.0
#ifndef TETCAST_VTK_SELECTOR_HPP
#define TETCAST_VTK_SELECTOR_HPP

#include <string>

namespace tcv {

// Whether a selector, "NAME", "NAME:2" or "NAME:mag" (null: any), may be of the array of this name.
inline bool may_name(const char *selector, const std::string &name) {
  if (!selector) return true;
  const std::string text = selector;
  return text.compare(0, name.size(), name) == 0 && (text.size() == name.size() || text[name.size()] == ':');
}

} // namespace tcv

#endif
