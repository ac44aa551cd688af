// SPDX-License-Identifier: BSD-3-Clause
#include "encode/linked_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/parallel.h"
#include "encode/tiling.h"

namespace lfm {
namespace {

constexpr int kSide = 4;
constexpr int kRounds = 3;

// Blocks of all pages, numbered.
struct BlockNumbers {
  std::vector<int> first, columns;  // of each page
  explicit BlockNumbers(const std::vector<Image>& pages) {
    int next = 0;
    for (const Image& page : pages) {
      first.push_back(next);
      columns.push_back(page.width() / kSide);
      next += columns.back() * (page.height() / kSide);
    }
    first.push_back(next);
  }
  int count() const { return first.back(); }
  int Of(const PatchLink::Texel& at) const {
    return first[at.page] + at.y / kSide * columns[at.page] + at.x / kSide;
  }
};

struct BlockPlace {
  int page = 0, column = 0, row = 0;
};
BlockPlace PlaceOf(const BlockNumbers& numbers, int block) {
  const auto next = std::upper_bound(numbers.first.begin(), numbers.first.end(), block);
  const int page = static_cast<int>(next - numbers.first.begin()) - 1;
  const int within = block - numbers.first[page];
  return {page, within % numbers.columns[page], within / numbers.columns[page]};
}

// What a block's texels are to become, beside their neighbours.
struct Target {
  std::array<std::array<double, 3>, 16> values;
  BlockTexels rounded;
};

class LinkedBlocks {
 public:
  LinkedBlocks(const std::vector<Image>& pages, BlockFormat format,
               std::vector<PageWeights> weights, std::span<const PatchLink> links,
               double edge_weight, BlockQuality quality)
      : pages_(pages),
        format_(format),
        given_(std::move(weights)),
        links_(links),
        numbers_(pages),
        quality_(quality) {
    for (size_t p = 0; p < pages.size(); ++p) {
      if (given_[p].texels.empty()) {
        given_[p].texels.assign(size_t{1} * pages[p].width() * pages[p].height(), 1.f);
      }
    }
    boosted_ = given_;
    links_of_.resize(numbers_.count());
    for (size_t i = 0; i < links.size(); ++i) {
      link_weights_.push_back(static_cast<float>(edge_weight) * links[i].weight);
      const PatchLink::Texel& own = links[i].own;
      boosted_[own.page].texels[size_t{1} * own.y * pages[own.page].width() + own.x] +=
          link_weights_[i];
      links_of_[numbers_.Of(own)].push_back(static_cast<int>(i));
    }
    ColorBlocks();
  }

  std::vector<BlockPage> Encode() {
    for (size_t p = 0; p < pages_.size(); ++p) {
      coded_.push_back(EncodePage(pages_[p], format_, boosted_[p], quality_));
      shown_.push_back(DecodePage(coded_[p]));
    }
    for (int round = 0; round < kRounds; ++round) {
      for (const std::vector<int>& blocks : colors_) {
        ParallelFor(
            0, static_cast<int64_t>(blocks.size()), [&](int64_t i) { Improve(blocks[i]); }, 16);
      }
    }
    return std::move(coded_);
  }

 private:
  // Blocks of one colour have no links to each other: they may be coded at once.
  void ColorBlocks() {
    std::vector<std::vector<int>> near(numbers_.count());
    for (const PatchLink& link : links_) {
      const int own = numbers_.Of(link.own);
      for (const PatchLink::Texel& sample : link.other) {
        const int other = numbers_.Of(sample);
        if (other == own) continue;
        near[own].push_back(other);
        near[other].push_back(own);
      }
    }
    std::vector<int> colors(near.size(), -1);
    std::vector<uint8_t> taken;
    for (size_t block = 0; block < near.size(); ++block) {
      if (links_of_[block].empty()) continue;
      taken.assign(colors_.size() + 1, 0);
      for (const int other : near[block]) {
        if (colors[other] >= 0) taken[colors[other]] = 1;
      }
      const auto color = std::find(taken.begin(), taken.end(), 0) - taken.begin();
      colors[block] = static_cast<int>(color);
      colors_.resize(std::max<size_t>(colors_.size(), color + 1));
      colors_[color].push_back(static_cast<int>(block));
    }
  }

  double Shown(const PatchLink& link, int channel) const {
    double value = 0;
    for (int i = 0; i < 2; ++i) {
      const PatchLink::Texel& at = link.other[i];
      value += (i == 0 ? 1 - link.share : link.share) *
               static_cast<double>(shown_[at.page].At<uint8_t>(at.x, at.y, channel));
    }
    return value;
  }

  Target TargetOf(int block, const BlockPlace& place) const {
    Target target{{},
                  TexelsOfBlock(pages_[place.page], boosted_[place.page], place.column, place.row)};
    const BlockTexels given =
        TexelsOfBlock(pages_[place.page], given_[place.page], place.column, place.row);
    for (int i = 0; i < 16; ++i) {
      for (int c = 0; c < 3; ++c) target.values[i][c] = given.weights[i] * given.texels[i][c];
    }
    for (const int l : links_of_[block]) {
      const PatchLink& link = links_[l];
      const int i = link.own.y % kSide * kSide + link.own.x % kSide;
      for (int c = 0; c < 3; ++c) {
        const double wanted =
            link.channels[c] < 0 ? given.texels[i][c] : Shown(link, link.channels[c]);
        target.values[i][c] += link_weights_[l] * wanted;
      }
    }
    for (int i = 0; i < 16; ++i) {
      for (int c = 0; c < 3; ++c) {
        const double weight = target.rounded.weights[i];
        target.values[i][c] = weight > 0 ? target.values[i][c] / weight : given.texels[i][c];
        target.rounded.texels[i][c] =
            static_cast<uint8_t>(std::lround(std::clamp(target.values[i][c], 0.0, 255.0)));
      }
    }
    return target;
  }

  double Error(const Target& target, const BlockPlanes& planes) const {
    const auto texels = DecodeBlock(planes, format_);
    double error = 0;
    for (int i = 0; i < 16; ++i) {
      for (int c = 0; c < 3; ++c) {
        const double difference = texels[i][c] - target.values[i][c];
        error += static_cast<double>(target.rounded.weights[i]) *
                 target.rounded.channel_weights[c] * difference * difference;
      }
    }
    return error;
  }

  void Improve(int block) {
    const BlockPlace place = PlaceOf(numbers_, block);
    const Target target = TargetOf(block, place);
    const BlockPlanes before = ReadBlock(coded_[place.page], place.column, place.row);
    const BlockPlanes after = EncodeBlock(target.rounded, format_, quality_);
    if (!(Error(target, after) < Error(target, before))) return;
    WriteBlock(after, place.column, place.row, coded_[place.page]);
    const auto texels = DecodeBlock(after, format_);
    for (int i = 0; i < 16; ++i) {
      std::copy_n(texels[i].data(), 3,
                  &shown_[place.page].At<uint8_t>(place.column * kSide + i % kSide,
                                                  place.row * kSide + i / kSide));
    }
  }

  const std::vector<Image>& pages_;
  const BlockFormat format_;
  std::vector<PageWeights> given_, boosted_;
  std::span<const PatchLink> links_;
  std::vector<float> link_weights_;  // times the edge weight
  BlockNumbers numbers_;
  const BlockQuality quality_;
  std::vector<std::vector<int>> links_of_;  // a block
  std::vector<std::vector<int>> colors_;    // blocks
  std::vector<BlockPage> coded_;
  std::vector<Image> shown_;
};

}  // namespace

PatchLink InPages(const EdgeLink& link, const std::vector<PatchPlacement>& placements,
                  float weight) {
  const auto texel = [&](int triangle, const Eigen::Vector2i& sample) {
    const PatchPlacement& placement = placements[triangle];
    const Eigen::Vector2i at = TexelOfSample(placement, sample.x(), sample.y());
    return PatchLink::Texel{placement.page, at.x(), at.y()};
  };
  return {texel(link.triangle, link.own),
          {texel(link.neighbor, link.other[0]), texel(link.neighbor, link.other[1])},
          link.share,
          link.channels,
          weight};
}

std::vector<BlockPage> EncodeLinkedPages(const std::vector<Image>& pages, BlockFormat format,
                                         std::vector<PageWeights> weights,
                                         std::span<const PatchLink> links, double edge_weight,
                                         BlockQuality quality) {
  if (!(edge_weight > 0)) links = {};
  return LinkedBlocks(pages, format, std::move(weights), links, edge_weight, quality).Encode();
}

}  // namespace lfm
