// SPDX-License-Identifier: Apache-2.0
// The nodes of Gmsh's elements of any order.
#ifndef TETCAST_VTK_GMSH_ORDER_HPP
#define TETCAST_VTK_GMSH_ORDER_HPP

#include <vector>

namespace tcv {

// Where in an element's list each node of VTK's Lagrange tetrahedron or hexahedron of this order is.
std::vector<short> gmsh_tetrahedron(int order);
std::vector<short> gmsh_hexahedron(int order);

} // namespace tcv

#endif
