// SPDX-License-Identifier: BSD-3-Clause
#include "encode/linked_blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kSide = 64;

// Noise: nothing that four colours a block could hold. The right half's first column repeats the
// left half's last one, and linked samples lie there.
struct Scene {
  Image page{kSide, kSide, 3, PixelType::kUint8, ColorEncoding::kSrgb};
  std::vector<PageWeights> weights;
  std::vector<PatchLink> links;
};
Scene MakeScene() {
  Scene scene;
  std::mt19937 random(3);
  constexpr int kLeft = kSide / 2 - 1, kRight = kSide / 2;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (int c = 0; c < 3; ++c) {
        scene.page.At<uint8_t>(x, y, c) = static_cast<uint8_t>(100 + random() % 80);
      }
    }
    for (int c = 0; c < 3; ++c) {
      scene.page.At<uint8_t>(kRight, y, c) = scene.page.At<uint8_t>(kLeft, y, (c + 1) % 3);
    }
    scene.links.push_back({{0, kLeft, y}, {{{0, kRight, y}, {0, kRight, y}}}, 0, {2, 0, 1}, 1});
    scene.links.push_back({{0, kRight, y}, {{{0, kLeft, y}, {0, kLeft, y}}}, 0, {1, 2, 0}, 1});
  }
  scene.weights = {{std::vector<float>(kSide * kSide, 1.f),
                    std::vector<std::array<float, 3>>(kSide * kSide / 16, {1, 1, 1})}};
  return scene;
}

struct Errors {
  double jumps = 0, squared = 0;
};
Errors Measure(const Scene& scene, const BlockPage& coded) {
  const Image shown = DecodePage(coded);
  Errors errors;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (int c = 0; c < 3; ++c) {
        errors.squared += std::pow(shown.At<uint8_t>(x, y, c) - scene.page.At<uint8_t>(x, y, c), 2);
      }
    }
  }
  for (const PatchLink& link : scene.links) {
    for (int c = 0; c < 3; ++c) {
      errors.jumps +=
          std::pow(shown.At<uint8_t>(link.own.x, link.own.y, c) -
                       shown.At<uint8_t>(link.other[0].x, link.other[0].y, link.channels[c]),
                   2);
    }
  }
  return errors;
}

TEST(LinkedBlocks, JumpsFallWithTheirWeightAndTheSumNeverRises) {
  const Scene scene = MakeScene();
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc4}) {
    const Errors plain =
        Measure(scene, EncodePage(scene.page, format, scene.weights[0], BlockQuality::kGood));
    double before = plain.jumps;
    for (const double weight : {1.0, 4.0, 16.0}) {
      const auto pages = EncodeLinkedPages({scene.page}, format, scene.weights, scene.links, weight,
                                           BlockQuality::kGood);
      const Errors linked = Measure(scene, pages[0]);
      EXPECT_LT(linked.jumps, 0.9 * before) << weight;
      EXPECT_LT(linked.squared + weight * linked.jumps, plain.squared + weight * plain.jumps);
      before = linked.jumps;
    }
    EXPECT_LT(before, plain.jumps / 4);
  }
}

TEST(LinkedBlocks, WithoutWeightOrLinksEachBlockIsByItself) {
  const Scene scene = MakeScene();
  const BlockPage plain =
      EncodePage(scene.page, BlockFormat::kBc1, scene.weights[0], BlockQuality::kGood);
  const auto code = [&](std::span<const PatchLink> links, double weight) {
    return EncodeLinkedPages({scene.page}, BlockFormat::kBc1, scene.weights, links, weight,
                             BlockQuality::kGood)[0]
        .blocks;
  };
  EXPECT_EQ(code(scene.links, 0), plain.blocks);
  EXPECT_EQ(code({}, 4), plain.blocks);
  EXPECT_TRUE(EncodeLinkedPages({}, BlockFormat::kBc1, {}, {}, 4, BlockQuality::kGood).empty());
}

// A map that ends on the edge is drawn to where it ends.
TEST(LinkedBlocks, ChannelsThatMeetNothingKeepTheirValue) {
  Scene scene = MakeScene();
  for (PatchLink& link : scene.links) link.channels = {-1, -1, -1};
  const auto error_at_edges = [&](double weight) {
    const Image shown = DecodePage(EncodeLinkedPages({scene.page}, BlockFormat::kBc1, scene.weights,
                                                     scene.links, weight, BlockQuality::kGood)[0]);
    double sum = 0;
    for (const PatchLink& link : scene.links) {
      for (int c = 0; c < 3; ++c) {
        sum += std::abs(shown.At<uint8_t>(link.own.x, link.own.y, c) -
                        scene.page.At<uint8_t>(link.own.x, link.own.y, c));
      }
    }
    return sum;
  };
  EXPECT_LT(error_at_edges(16), 0.85 * error_at_edges(0));
}

TEST(LinkedBlocks, DoesNotDependOnThreads) {
  const Scene scene = MakeScene();
  const auto code = [&] {
    return EncodeLinkedPages({scene.page}, BlockFormat::kBc4, scene.weights, scene.links, 4,
                             BlockQuality::kGood)[0]
        .blocks;
  };
  SetThreadCount(1);
  const auto one = code();
  SetThreadCount(0);
  EXPECT_EQ(code(), one);
}

}  // namespace
}  // namespace lfm
