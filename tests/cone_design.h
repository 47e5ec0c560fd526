/* A cone as a design file: a round film pulled out by its hub. */
#pragma once

/* material: of the film; hub: more of its body; to be followed by monitors and what is computed. */
#define CONE_DESIGN(material, hub)                                                                 \
  "dea: 1\n"                                                                                       \
  "title: cone\n"                                                                                  \
  "shapes:\n"                                                                                      \
  "  - {name: film, kind: circle, radius: 20 mm}\n"                                                \
  "  - {name: hub, kind: circle, radius: 5 mm}\n"                                                  \
  "  - {name: active, kind: difference, of: [film, hub]}\n"                                        \
  "plies:\n"                                                                                       \
  "  - {name: film, shape: film, material: " material ", thickness: 100 um, pre_stretch: 1.2}\n"   \
  "electrodes:\n"                                                                                  \
  "  - {ply: film, side: bottom, shape: active, channel: ground}\n"                                \
  "  - {ply: film, side: top, shape: active, channel: drive}\n"                                    \
  "supports: [{edge: film}]\n"                                                                     \
  "bodies: [{name: hub, shape: hub, free: [z]" hub "}]\n"
