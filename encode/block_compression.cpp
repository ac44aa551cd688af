// SPDX-License-Identifier: BSD-3-Clause
#include "encode/block_compression.h"

#include <squish.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kSide = 4;

using Rgb = std::array<uint8_t, 3>;

Rgb Expand565(int packed) {
  const int r = packed >> 11 & 31, g = packed >> 5 & 63, b = packed & 31;
  return {static_cast<uint8_t>(r << 3 | r >> 2), static_cast<uint8_t>(g << 2 | g >> 4),
          static_cast<uint8_t>(b << 3 | b >> 2)};
}

// The four colours of a block. Mesa takes 85/256 for a third, and rounds down.
std::array<Rgb, 4> Bc1Palette(const Block& block) {
  const int first = block[0] | block[1] << 8, second = block[2] | block[3] << 8;
  std::array<Rgb, 4> palette{Expand565(first), Expand565(second), Rgb{}, Rgb{}};
  for (int c = 0; c < 3; ++c) {
    const int a = palette[0][c], b = palette[1][c];
    if (first > second) {
      palette[2][c] = static_cast<uint8_t>(a + (85 * (b - a) >> 8));
      palette[3][c] = static_cast<uint8_t>(a + (85 * (b - a) >> 7));
    } else {
      palette[2][c] = static_cast<uint8_t>((a + b + 1) / 2);
    }
  }
  return palette;
}

// The eight values of a block. first > second: six between them; else four, 0 and 255. Mesa's
// weights are rounded down to 1/256, and so is what they give.
std::array<uint8_t, 8> Bc4Palette(int first, int second) {
  std::array<uint8_t, 8> palette{static_cast<uint8_t>(first), static_cast<uint8_t>(second)};
  const int parts = first > second ? 7 : 5;
  for (int k = 1; k < parts; ++k) {
    const int weight = 255 * 64 / parts * k >> 6;
    palette[k + 1] = static_cast<uint8_t>(first + ((second - first) * weight >> 8));
  }
  if (parts == 5) {
    palette[6] = 0;
    palette[7] = 255;
  }
  return palette;
}

uint64_t Bc4Indices(const Block& block) {
  uint64_t bits = 0;
  for (int i = 0; i < 6; ++i) bits |= uint64_t{block[2 + i]} << 8 * i;
  return bits;
}

// The error of a block whose texels each take the best of the palette; stops above `most`.
double Bc4Error(const std::array<uint8_t, 16>& texels, const TexelWeights& weights,
                const std::array<uint8_t, 8>& palette, double most) {
  double error = 0;
  for (int i = 0; i < 16 && error < most; ++i) {
    if (!(weights[i] > 0)) continue;
    int least = 255 * 255;
    for (const int value : palette) {
      least = std::min(least, (value - texels[i]) * (value - texels[i]));
    }
    error += static_cast<double>(weights[i]) * least;
  }
  return error;
}

struct Ends {
  int first = 0, second = 0;
  double error = HUGE_VAL;
};

// Tries all end points within `reach` of (low, high), in the order that makes `first` > `second`
// or not.
void SearchEnds(const std::array<uint8_t, 16>& texels, const TexelWeights& weights, int low,
                int high, int reach, bool six_between, Ends& best) {
  for (int a = std::max(0, low - reach); a <= std::min(255, low + reach); ++a) {
    for (int b = std::max(a, high - reach); b <= std::min(255, high + reach); ++b) {
      if (six_between && a == b) continue;
      const int first = six_between ? b : a, second = six_between ? a : b;
      const double error = Bc4Error(texels, weights, Bc4Palette(first, second), best.error);
      if (error < best.error) best = {first, second, error};
    }
  }
}

Block PackBc4(const std::array<uint8_t, 16>& texels, const Ends& ends) {
  const std::array<uint8_t, 8> palette = Bc4Palette(ends.first, ends.second);
  uint64_t bits = 0;
  for (int i = 0; i < 16; ++i) {
    uint64_t best = 0;
    for (uint64_t k = 1; k < 8; ++k) {
      if (std::abs(palette[k] - texels[i]) < std::abs(palette[best] - texels[i])) best = k;
    }
    bits |= best << 3 * i;
  }
  Block block{static_cast<uint8_t>(ends.first), static_cast<uint8_t>(ends.second)};
  for (int i = 0; i < 6; ++i) block[2 + i] = static_cast<uint8_t>(bits >> 8 * i);
  return block;
}

int SquishFlags(BlockQuality quality) {
  constexpr int kFits[] = {squish::kColourRangeFit, squish::kColourClusterFit,
                           squish::kColourIterativeClusterFit};
  return squish::kDxt1 | kFits[static_cast<int>(quality)];
}

double Bc1Error(const Rgb& a, const Rgb& b, const std::array<float, 3>& channel_weights) {
  double error = 0;
  for (int c = 0; c < 3; ++c) error += channel_weights[c] * (a[c] - b[c]) * (a[c] - b[c]);
  return error;
}

// Takes the best of the block's colours for each texel; returns the weighted error.
double ChooseIndices(const std::array<Rgb, 16>& texels, const TexelWeights& weights,
                     const std::array<float, 3>& channel_weights, Block& block) {
  const std::array<Rgb, 4> palette = Bc1Palette(block);
  uint32_t bits = 0;
  double total = 0;
  for (int i = 0; i < 16; ++i) {
    double least = HUGE_VAL;
    uint32_t best = 0;
    for (uint32_t k = 0; k < 4; ++k) {
      const double error = Bc1Error(texels[i], palette[k], channel_weights);
      if (error < least) {
        least = error;
        best = k;
      }
    }
    bits |= best << 2 * i;
    total += weights[i] * least;
  }
  for (int i = 0; i < 4; ++i) block[4 + i] = static_cast<uint8_t>(bits >> 8 * i);
  return total;
}

// End points moved by single steps of 5 or 6 bits while that lowers the error: what libsquish's
// palette, which rounds otherwise, left on the table.
void PolishBc1(const std::array<Rgb, 16>& texels, const TexelWeights& weights,
               const std::array<float, 3>& channel_weights, Block& block, double error) {
  constexpr std::array<int, 3> kShift = {11, 5, 0}, kMost = {31, 63, 31};
  bool moved = true;
  for (int round = 0; moved && round < 8; ++round) {
    moved = false;
    for (int move = 0; move < 12; ++move) {
      const int end = move / 6, channel = move / 2 % 3, step = move % 2 == 0 ? 1 : -1;
      int packed = block[2 * end] | block[2 * end + 1] << 8;
      const int level = (packed >> kShift[channel] & kMost[channel]) + step;
      if (level < 0 || level > kMost[channel]) continue;
      packed += step * (1 << kShift[channel]);
      Block candidate = block;
      candidate[2 * end] = static_cast<uint8_t>(packed);
      candidate[2 * end + 1] = static_cast<uint8_t>(packed >> 8);
      const double candidate_error = ChooseIndices(texels, weights, channel_weights, candidate);
      if (!(candidate_error < error)) continue;
      block = candidate;
      error = candidate_error;
      moved = true;
    }
  }
}

void CheckPage(const Image& page, const PageWeights& weights) {
  const auto require = [](bool condition, const char* problem) {
    if (!condition) throw Error(std::string("block compression: ") + problem);
  };
  require(page.type() == PixelType::kUint8 && page.channels() == 3, "a page is not 8-bit RGB");
  require(page.width() % kSide == 0 && page.height() % kSide == 0 && page.width() > 0,
          "a page's sides are not multiples of 4");
  const size_t texels = size_t{1} * page.width() * page.height();
  require(weights.texels.empty() || weights.texels.size() == texels, "weights do not fit the page");
  require(weights.channels.empty() || weights.channels.size() == texels / 16,
          "weights of channels do not fit the page");
}

}  // namespace

std::array<std::array<uint8_t, 3>, 16> DecodeBc1(const Block& block) {
  const std::array<Rgb, 4> palette = Bc1Palette(block);
  std::array<Rgb, 16> texels;
  for (int i = 0; i < 16; ++i) texels[i] = palette[block[4 + i / 4] >> 2 * (i % 4) & 3];
  return texels;
}

std::array<uint8_t, 16> DecodeBc4(const Block& block) {
  const std::array<uint8_t, 8> palette = Bc4Palette(block[0], block[1]);
  const uint64_t bits = Bc4Indices(block);
  std::array<uint8_t, 16> texels;
  for (int i = 0; i < 16; ++i) texels[i] = palette[bits >> 3 * i & 7];
  return texels;
}

Block EncodeBc1(const std::array<Rgb, 16>& texels, const TexelWeights& weights,
                const std::array<float, 3>& channel_weights, BlockQuality quality) {
  std::array<uint8_t, 64> rgba;
  int mask = 0;
  for (int i = 0; i < 16; ++i) {
    std::copy_n(texels[i].data(), 3, rgba.data() + 4 * i);
    rgba[4 * i + 3] = 255;
    if (weights[i] > 0) mask |= 1 << i;
  }
  Block block{};
  if (mask == 0) return block;
  // libsquish needs weights of about one.
  const float most = std::max({channel_weights[0], channel_weights[1], channel_weights[2]});
  std::array<float, 3> metric = {1, 1, 1};
  for (int c = 0; c < 3 && most > 0; ++c) metric[c] = std::max(channel_weights[c] / most, 1e-3f);
  squish::CompressMasked(rgba.data(), mask, block.data(), SquishFlags(quality), metric.data());
  const double error = ChooseIndices(texels, weights, metric, block);
  if (quality == BlockQuality::kFast || error == 0) return block;
  PolishBc1(texels, weights, metric, block, error);
  return block;
}

Block EncodeBc4(const std::array<uint8_t, 16>& texels, const TexelWeights& weights,
                BlockQuality quality) {
  int low = 255, high = 0, inner_low = 255, inner_high = 0;
  for (int i = 0; i < 16; ++i) {
    if (!(weights[i] > 0)) continue;
    low = std::min<int>(low, texels[i]);
    high = std::max<int>(high, texels[i]);
    if (texels[i] > 0) inner_low = std::min<int>(inner_low, texels[i]);
    if (texels[i] < 255) inner_high = std::max<int>(inner_high, texels[i]);
  }
  if (low > high) return Block{};  // nothing counts
  constexpr int kReach[] = {0, 3, 8};
  const int reach = low == high ? 0 : kReach[static_cast<int>(quality)];
  Ends best;
  SearchEnds(texels, weights, low, high, 0, false, best);
  SearchEnds(texels, weights, low, high, reach, true, best);
  // The mode with 0 and 255 of its own pays where a block has them.
  if ((low == 0 || high == 255) && inner_low <= inner_high) {
    SearchEnds(texels, weights, inner_low, inner_high, reach, false, best);
  } else if (quality == BlockQuality::kBest) {
    SearchEnds(texels, weights, low, high, reach, false, best);
  }
  return PackBc4(texels, best);
}

BlockTexels TexelsOfBlock(const Image& page, const PageWeights& weights, int column, int row) {
  BlockTexels block;
  for (int i = 0; i < 16; ++i) {
    const int x = column * kSide + i % kSide, y = row * kSide + i / kSide;
    std::copy_n(&page.At<uint8_t>(x, y), 3, block.texels[i].data());
    block.weights[i] =
        weights.texels.empty() ? 1.f : weights.texels[size_t{1} * y * page.width() + x];
  }
  if (!weights.channels.empty()) {
    block.channel_weights = weights.channels[size_t{1} * row * (page.width() / kSide) + column];
  }
  return block;
}

BlockPlanes EncodeBlock(const BlockTexels& texels, BlockFormat format, BlockQuality quality) {
  BlockPlanes planes{};
  if (format == BlockFormat::kBc1) {
    planes[0] = EncodeBc1(texels.texels, texels.weights, texels.channel_weights, quality);
    return planes;
  }
  for (int c = 0; c < 3; ++c) {
    std::array<uint8_t, 16> channel;
    for (int i = 0; i < 16; ++i) channel[i] = texels.texels[i][c];
    planes[c] = EncodeBc4(channel, texels.weights, quality);
  }
  return planes;
}

std::array<Rgb, 16> DecodeBlock(const BlockPlanes& planes, BlockFormat format) {
  if (format == BlockFormat::kBc1) return DecodeBc1(planes[0]);
  std::array<Rgb, 16> texels;
  for (int c = 0; c < 3; ++c) {
    const std::array<uint8_t, 16> channel = DecodeBc4(planes[c]);
    for (int i = 0; i < 16; ++i) texels[i][c] = channel[i];
  }
  return texels;
}

BlockPage EncodePage(const Image& page, BlockFormat format, const PageWeights& weights,
                     BlockQuality quality) {
  CheckPage(page, weights);
  const int columns = page.width() / kSide, rows = page.height() / kSide;
  BlockPage result{page.width(), page.height(), format == BlockFormat::kBc1 ? 1 : 3, {}};
  result.blocks.resize(size_t{1} * result.planes * columns * rows * sizeof(Block));
  ParallelFor(0, rows, [&](int64_t row) {
    for (int column = 0; column < columns; ++column) {
      const auto y = static_cast<int>(row);
      WriteBlock(EncodeBlock(TexelsOfBlock(page, weights, column, y), format, quality), column, y,
                 result);
    }
  });
  return result;
}

BlockPlanes ReadBlock(const BlockPage& page, int column, int row) {
  const size_t plane = page.blocks.size() / page.planes;
  BlockPlanes planes{};
  for (int c = 0; c < page.planes; ++c) {
    std::copy_n(page.blocks.data() + c * plane +
                    (size_t{1} * row * (page.width / kSide) + column) * sizeof(Block),
                sizeof(Block), planes[c].begin());
  }
  return planes;
}

void WriteBlock(const BlockPlanes& planes, int column, int row, BlockPage& page) {
  const size_t plane = page.blocks.size() / page.planes;
  for (int c = 0; c < page.planes; ++c) {
    std::copy(planes[c].begin(), planes[c].end(),
              page.blocks.data() + c * plane +
                  (size_t{1} * row * (page.width / kSide) + column) * sizeof(Block));
  }
}

Image DecodePage(const BlockPage& page) {
  const int columns = page.width / kSide, rows = page.height / kSide;
  const size_t plane = size_t{1} * columns * rows * sizeof(Block);
  if (page.width < kSide || page.height < kSide || page.width % kSide != 0 ||
      page.height % kSide != 0 || (page.planes != 1 && page.planes != 3) ||
      page.blocks.size() != page.planes * plane) {
    throw Error("block compression: the blocks do not fill their page; run lfm-encode again");
  }
  const BlockFormat format = FormatOf(page);
  Image image(page.width, page.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  ParallelFor(0, rows, [&](int64_t row) {
    for (int column = 0; column < columns; ++column) {
      const std::array<Rgb, 16> texels =
          DecodeBlock(ReadBlock(page, column, static_cast<int>(row)), format);
      for (int i = 0; i < 16; ++i) {
        std::copy_n(texels[i].data(), 3,
                    &image.At<uint8_t>(column * kSide + i % kSide,
                                       static_cast<int>(row) * kSide + i / kSide));
      }
    }
  });
  return image;
}

}  // namespace lfm
