/* SPDX-License-Identifier: Apache-2.0 */
/* All of libtetcast. The adapters have headers of their own: dataset.h, surface.h and tetgen.h, image.h, mpi.h. */
#ifndef TETCAST_TETCAST_H
#define TETCAST_TETCAST_H

#include <tetcast/array.h>
#include <tetcast/blend.h>
#include <tetcast/camera.h>
#include <tetcast/cast.h>
#include <tetcast/cells.h>
#include <tetcast/clip.h>
#include <tetcast/context.h>
#include <tetcast/field.h>
#include <tetcast/fragments.h>
#include <tetcast/frame.h>
#include <tetcast/integrator.h>
#include <tetcast/isosurface.h>
#include <tetcast/mesh.h>
#include <tetcast/scene.h>
#include <tetcast/shading.h>
#include <tetcast/slice.h>
#include <tetcast/statistics.h>
#include <tetcast/status.h>
#include <tetcast/transfer_function.h>
#include <tetcast/version.h>
#include <tetcast/volume.h>

#endif
