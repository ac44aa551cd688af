// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/image.h"

namespace lfm {

/// Textures that a graphics card decodes while it samples, in blocks of 4 x 4 texels.
enum class BlockFormat {
  kBc1,  ///< S3TC, DXT1: RGB in 8 bytes a block, colours on a line in RGB space
  kBc4,  ///< RGTC1: one channel in 8 bytes a block
};

/// How long the encoder searches.
enum class BlockQuality { kFast, kGood, kBest };

using Block = std::array<uint8_t, 8>;

/// Decoders, bit by bit as Mesa's software rasteriser (llvmpipe) samples. The specifications
/// (EXT_texture_compression_s3tc, ARB_texture_compression_rgtc) give real numbers and leave the
/// rounding open: Mesa's values lie up to two levels of 255 from them (docs/formats.md). Any 8
/// bytes are a block.
std::array<std::array<uint8_t, 3>, 16> DecodeBc1(const Block& block);
std::array<uint8_t, 16> DecodeBc4(const Block& block);

/// One texel's weight in the error that the encoder makes least; 0: any value will do.
using TexelWeights = std::array<float, 16>;

/// The block nearest to `texels` (row by row) in sum of weight * sum_c channel_weight_c *
/// difference^2. BC1 by libsquish (range fit, cluster fit, iterated cluster fit), then each texel
/// takes the best of the block's four colours as our decoder sees them. BC4 by exhaustive search
/// of end points round those of the least squares fit (the farther, the better the quality), in
/// both of its modes. A block of one value it can hold is exact.
Block EncodeBc1(const std::array<std::array<uint8_t, 3>, 16>& texels, const TexelWeights& weights,
                const std::array<float, 3>& channel_weights, BlockQuality quality);
Block EncodeBc4(const std::array<uint8_t, 16>& texels, const TexelWeights& weights,
                BlockQuality quality);

/// A page in blocks, row of blocks by row of blocks.
struct BlockPage {
  int width = 0, height = 0;    ///< texels, multiples of 4
  int planes = 1;               ///< kBc1: 1 (RGB); kBc4: 3, one a channel, one after the other
  std::vector<uint8_t> blocks;  ///< planes x (height / 4) x (width / 4) x 8 bytes
};

inline BlockFormat FormatOf(const BlockPage& page) {
  return page.planes == 1 ? BlockFormat::kBc1 : BlockFormat::kBc4;
}

/// What of a page counts: one weight a texel (width x height) and one triple a block of how its
/// channels count. Empty: all alike.
struct PageWeights {
  std::vector<float> texels;
  std::vector<std::array<float, 3>> channels;
};

/// 4 x 4 texels of an RGB page, and how they count: texel weight x channel weight.
struct BlockTexels {
  std::array<std::array<uint8_t, 3>, 16> texels;
  TexelWeights weights;
  std::array<float, 3> channel_weights{1, 1, 1};
};
/// Those of a page's block. Nothing is checked.
BlockTexels TexelsOfBlock(const Image& page, const PageWeights& weights, int column, int row);

/// The blocks of 4 x 4 texels: one for kBc1, else one a channel.
using BlockPlanes = std::array<Block, 3>;
BlockPlanes EncodeBlock(const BlockTexels& texels, BlockFormat format, BlockQuality quality);
std::array<std::array<uint8_t, 3>, 16> DecodeBlock(const BlockPlanes& planes, BlockFormat format);
/// From and to their place in a page that holds it.
BlockPlanes ReadBlock(const BlockPage& page, int column, int row);
void WriteBlock(const BlockPlanes& planes, int column, int row, BlockPage& page);

/// Encodes an 8-bit RGB page in kBc1 or kBc4. Throws Error when its sides are no multiples of 4,
/// it is not 8-bit RGB, or weights do not fit.
BlockPage EncodePage(const Image& page, BlockFormat format, const PageWeights& weights,
                     BlockQuality quality);
/// Back to 8-bit RGB. Throws Error when the blocks do not fit the page's size.
Image DecodePage(const BlockPage& page);

}  // namespace lfm
