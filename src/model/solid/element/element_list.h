/* The kinds of elements. A new one is one file that defines dea_element_<name>, and one line here.
 */
#pragma once

#define DEA_ELEMENT_LIST(X)                                                                        \
  X(HEXAHEDRON, hexahedron)                                                                        \
  X(POTENTIAL_HEXAHEDRON, potential_hexahedron)                                                    \
  X(MEMBRANE, membrane)

/* What a mesh says of an element: its kind, a number below DEA_ELEMENT_COUNT. */
enum dea_element_kind {
#define DEA_ELEMENT_KIND(KIND, name) DEA_ELEMENT_##KIND,
  DEA_ELEMENT_LIST(DEA_ELEMENT_KIND)
#undef DEA_ELEMENT_KIND
      DEA_ELEMENT_COUNT
};
