// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/image.h"
#include "resample/light_field.h"

namespace lfm {

/// How well the photographs cover the object: for every vertex the mean number of views of its
/// ring's triangles, as values for DrawMesh (mesh/mesh_pictures.h); 0 at a vertex of no triangle.
std::vector<float> CoverageValues(const LightField& light_field);

/// A contact sheet of one triangle: each of its normalised views as a right-angled triangle (corner
/// 0 at the top left, 1 at the top right, 2 at the bottom left), in the order of its photographs,
/// rows from the top, 8-bit sRGB on gray. A sample is drawn as a square of about
/// `view_px / edge_samples` pixels; imputed values above one show as one. Nobody's triangle gives
/// one empty gray tile. Throws Error when there is no such triangle or `view_px` is not in [1,
/// 512].
Image PatchContactSheet(const LightField& light_field, int triangle, int view_px = 64);

}  // namespace lfm
