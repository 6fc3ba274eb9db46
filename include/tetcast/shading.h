/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_SHADING_H
#define TETCAST_SHADING_H

#include <stdint.h>

#include <tetcast/export.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TETCAST_MAX_LIGHTS 16

/* What light falls on. */
typedef enum TetcastShade {
  TETCAST_SHADE_NONE = 0,                                           /* nothing: colours are as given */
  TETCAST_SHADE_SURFACES = 1,                                       /* surfaces */
  TETCAST_SHADE_VOLUME = 2,                                         /* the volume */
  TETCAST_SHADE_ALL = TETCAST_SHADE_SURFACES | TETCAST_SHADE_VOLUME /* both */
} TetcastShade;

/* What is perpendicular to an isosurface. */
typedef enum TetcastNormals {
  TETCAST_NORMALS_SMOOTH = 0, /* the gradient at the vertices, the mean of that in the cells there weighted by their
                                 volumes, interpolated at the point */
  TETCAST_NORMALS_FLAT        /* the gradient in the cell */
} TetcastNormals;

/* A light so far away that it comes from one direction everywhere. */
typedef struct TetcastLight {
  /* From the mesh towards the light, of any length but 0, finite. */
  double direction[3];
  /* Its red, green and blue, each ≥ 0 and finite; 1, 1, 1 is the light for which colours are given. */
  double color[3];
} TetcastLight;

/* How light is reflected, by the model of Blinn (Models of light reflection for computer synthesized pictures, 1977):
 * with n the normal, turned to the side from which it is seen, v the direction to the eye and l that to a light of
 * colour L, and h the direction halfway between v and l, a surface of colour c is seen as
 *
 *     c (ambient + diffuse Σ L max(0, n·l)) + specular Σ L max(0, n·h)^exponent,   the latter where n·l > 0.
 *
 * Where there is no gradient, n·l counts as 1, without a specular part.
 *
 * On surfaces this is computed at each point that is seen. In the volume it is computed at the vertices, with n the
 * gradient there, turned to the eye: what c is multiplied by and what is added to the product are then linear in each
 * cell, and of that the integral is exact. The light between vertices is thereby off by an error of second order in the
 * size of cells; the larger the exponent, the finer the cells that highlights need. */
typedef struct TetcastShadingDesc {
  /* Set by tetcast_shading_desc_default(). */
  uint32_t cookie;
  /* What light falls on; default: TETCAST_SHADE_SURFACES. */
  TetcastShade shade;
  /* What is perpendicular to an isosurface; default: TETCAST_NORMALS_SMOOTH. A field that jumps from cell to cell has
   * flat ones whatever is asked for. */
  TetcastNormals normals;
  /* The share of a colour that is seen without any light, ≥ 0 and finite; default 0.2. */
  double ambient;
  /* The share that a light adds where it falls on the surface at a right angle, ≥ 0 and finite; default 0.8. */
  double diffuse;
  /* The brightness of highlights, ≥ 0 and finite; default 0.2. */
  double specular;
  /* How small highlights are, in [1, 10000]; default 30. */
  double exponent;
  /* [light_count], copied; NULL if there are none. */
  const TetcastLight *lights;
  /* From 0 to TETCAST_MAX_LIGHTS; default 0: a white light at the eye. */
  int light_count;
  /* 1: the volume, not the surfaces in it, casts shadows: of each light a vertex gets the share that the transfer
   * function lets through on the way there, through all of what clips leave of the mesh, and between vertices it is
   * linear in each cell. This holds for lights from a direction; one at the eye casts no shadow that it sees. The
   * shares are computed by the first frame that needs them and kept until the field, the transfer function, the clip
   * or the shading changes. Default 0. */
  int shadows;
  /* The ambient light comes from so many directions, spread evenly over the sphere, and a vertex gets the mean of what
   * arrives from them, found like shadows; from 0, the default: all of it arrives everywhere, to 4096. */
  int occlusion_rays;
} TetcastShadingDesc;

TETCAST_API TetcastShadingDesc tetcast_shading_desc_default(void);

#ifdef __cplusplus
}
#endif

#endif
