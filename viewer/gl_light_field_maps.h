// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "encode/model.h"
#include "viewer/gl_objects.h"

namespace lfm {

/// A model's maps and tables as textures of the current OpenGL context.
///
/// Pages are layers of texture arrays: mean page p is layer p; page p of term k is layer
/// first[k] + p. Tables are float textures kTableWidth texels wide, entry i at texel
/// (i % kTableWidth, i / kTableWidth): the axes x, y, z of vertex v's frame at entries 3 v + 0, 1,
/// 2, with the tile (LightFieldModel::view_slots) as the fourth number of x, and the
/// number of terms of y and z; (surface scale,
/// surface bias, view scale, view bias) of vertex v and term k at k * V + v, zero where the vertex
/// has no such term; the patch of triangle t's mean view at t (x, y of sample (0, 0), page, n - 1,
/// negative when flipped). With codebooks that of its term k at (k + 1) * T + t, and the tile of
/// vertex v and term k at k * V + v (x, y, page, own grid).
///
/// Pages in blocks are uploaded as blocks where the driver reads them. Surface pages of three
/// planes have three layers each.
struct GlLightFieldMaps {
  static constexpr int kTableWidth = 1024;  ///< the shaders know it
  static constexpr int kMostTerms = 16;

  GlObject mean, surface, view;  ///< GL_TEXTURE_2D_ARRAY, RGB8, BC1 or BC4, bilinear, clamped
  GlObject frames, ranges;       ///< GL_TEXTURE_2D, RGBA32F
  GlObject patches, tiles;       ///< the same
  /// Layer of each term's first page.
  std::array<int, kMostTerms> surface_first{}, view_first{};
  int surface_planes = 1;  ///< layers of a surface page
};

/// What becomes of pages in blocks.
enum class BlockUse {
  kAutomatic,  ///< decoded on drivers in software, which draw that faster, else as they are
  kAsTheyAre,  ///< an eighth of the memory; decoded where the driver does not read BC1 (S3TC)
  kDecoded,    ///< what they decode to
};

/// Uploads. Throws Error when a page or the number of pages exceeds the driver's limits (encode
/// again with another --max-texture-size), or the memory is not there.
GlLightFieldMaps UploadMaps(const LightFieldModel& model,
                            BlockUse block_use = BlockUse::kAsTheyAre);

}  // namespace lfm
