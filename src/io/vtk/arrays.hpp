// SPDX-License-Identifier: Apache-2.0
// Arrays by name: which the file has, which are asked for, and which could not be read.
#ifndef TETCAST_VTK_ARRAYS_HPP
#define TETCAST_VTK_ARRAYS_HPP

#include <string>
#include <vector>

#include <tetcast/field.h>

namespace tcv {

struct ArrayName {
  TetcastAssociation association;
  std::string name;
};

inline bool operator==(const ArrayName &a, const ArrayName &b) {
  return a.association == b.association && a.name == b.name;
}

// An array of the file that was not read into the dataset.
struct UnreadArray {
  ArrayName array;
  std::string reason; // why it can't be read; empty: it was not asked for
};

// "point" or "cell".
inline const char *word_of(TetcastAssociation association) {
  return association == TETCAST_POINT ? "point" : "cell";
}

// Adds an array to the list, unless it is there already; a reason that was noted is kept.
void note_unread(std::vector<UnreadArray> *list, const ArrayName &array, const std::string &reason);

// Whether a selector, "NAME", "NAME:cell", "NAME:2" and the like (null: any), may be of the array of this name.
bool may_name(const char *selector, const std::string &name);

} // namespace tcv

#endif
