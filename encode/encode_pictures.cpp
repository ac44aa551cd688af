// SPDX-License-Identifier: BSD-3-Clause
#include "encode/encode_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lfm {
namespace {

constexpr int kChartHeight = 240, kBarWidth = 40, kGap = 16;

using Color = std::array<uint8_t, 3>;
constexpr Color kPaper = {255, 255, 255}, kFrame = {120, 120, 120}, kEarlier = {205, 210, 215},
                kOwn = {46, 110, 180};

void Fill(Image& image, int x0, int y0, int x1, int y1, const Color& color) {
  for (int y = std::max(0, y0); y < std::min(image.height(), y1); ++y) {
    for (int x = std::max(0, x0); x < std::min(image.width(), x1); ++x) {
      std::copy(color.begin(), color.end(), &image.At<uint8_t>(x, y));
    }
  }
}

Image Crop(const Image& image, int max_side) {
  const int width = std::min(image.width(), max_side), height = std::min(image.height(), max_side);
  Image out(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < height; ++y) {
    std::copy_n(&image.At<uint8_t>(0, y), 3 * width, &out.At<uint8_t>(0, y));
  }
  return out;
}

}  // namespace

Image DrawSingularValues(const std::vector<double>& shares) {
  const int count = std::max<int>(1, static_cast<int>(shares.size()));
  const int width = kGap + count * (kBarWidth + kGap);
  Image chart(width, kChartHeight, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  Fill(chart, 0, 0, width, kChartHeight, kFrame);
  Fill(chart, 1, 1, width - 1, kChartHeight - 1, kPaper);
  const auto level = [](double share) {
    return kChartHeight - 1 -
           static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * (kChartHeight - 2)));
  };
  double before = 0;
  for (size_t k = 0; k < shares.size(); ++k) {
    const int x = kGap + static_cast<int>(k) * (kBarWidth + kGap);
    Fill(chart, x, level(before), x + kBarWidth, kChartHeight - 1, kEarlier);
    Fill(chart, x, level(before + shares[k]), x + kBarWidth, level(before), kOwn);
    before += shares[k];
  }
  return chart;
}

std::vector<EncodePicture> DrawEncodePictures(const LightFieldModel& model,
                                              const std::vector<double>& singular_value_share,
                                              int max_side) {
  std::vector<EncodePicture> pictures;
  pictures.push_back({"mean-view", "The mean view of every triangle, tiled",
                      Crop(model.mean_pages.front(), max_side)});
  for (int k = 0; k < model.terms; ++k) {
    const std::string term = std::to_string(k + 1);
    pictures.push_back({"surface-maps-" + term,
                        "Surface maps of term " + term + "; a colour channel a corner",
                        Crop(model.surface_pages[k].front(), max_side)});
    pictures.push_back({"view-maps-" + term, "View maps of term " + term + ", one a vertex",
                        Crop(model.view_pages[k].front(), max_side)});
  }
  pictures.push_back({"singular-values",
                      "Share of the view-dependent energy that each term captures (blue)",
                      DrawSingularValues(singular_value_share)});
  return pictures;
}

void RemoveEncodePictures(const std::filesystem::path& folder) {
  constexpr int kMostTerms = 16;
  std::vector<std::string> names = {"mean-view", "singular-values"};
  for (int k = 1; k <= kMostTerms; ++k) {
    names.push_back("surface-maps-" + std::to_string(k));
    names.push_back("view-maps-" + std::to_string(k));
  }
  std::error_code ignored;
  for (const std::string& name : names) std::filesystem::remove(folder / (name + ".png"), ignored);
  std::filesystem::remove(folder, ignored);  // when it is empty
}

}  // namespace lfm
