// SPDX-License-Identifier: Apache-2.0
// The functions of the table of formats, one for each kind of content.
#ifndef TETCAST_VTK_FORMATS_HPP
#define TETCAST_VTK_FORMATS_HPP

#include "contents.hpp"

namespace tcv {

void read_vtu(const Reading &reading, Contents *contents);
void read_vti(const Reading &reading, Contents *contents);
void read_vtr(const Reading &reading, Contents *contents);
void read_vts(const Reading &reading, Contents *contents);
void read_pieces(const Reading &reading, Contents *contents); // .pvtu and the like
void read_blocks(const Reading &reading, Contents *contents); // .vtm
void read_legacy_grid(const Reading &reading, Contents *contents);
void read_legacy_structured(const Reading &reading, Contents *contents);
void read_pvd(const Reading &reading, Contents *contents);
void read_series(const Reading &reading, Contents *contents);
void read_gmsh(const Reading &reading, Contents *contents);
void read_tetgen(const Reading &reading, Contents *contents); // .node with .ele

} // namespace tcv

#endif
