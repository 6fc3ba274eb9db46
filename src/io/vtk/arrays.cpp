// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <algorithm>

namespace tcv {

void note_unread(std::vector<UnreadArray> *list, const ArrayName &array, const std::string &reason) {
  const auto found =
      std::find_if(list->begin(), list->end(), [&](const UnreadArray &one) { return one.array == array; });
  if (found == list->end())
    list->push_back({array, reason});
  else if (found->reason.empty())
    found->reason = reason;
}

bool may_name(const char *selector, const std::string &name) {
  if (!selector)
    return true;
  const std::string text = selector;
  return text.compare(0, name.size(), name) == 0 && (text.size() == name.size() || text[name.size()] == ':');
}

} // namespace tcv
