// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

struct CircleInk {
  const char* name;
  std::array<uint8_t, 3> srgb;
};

// Far apart in hue, by CircleColor, within the reach of printers.
constexpr std::array<CircleInk, kCircleColors> kCircleInks = {{
    {"red", {226, 35, 26}},
    {"yellow", {255, 220, 0}},
    {"green", {0, 150, 60}},
    {"cyan", {0, 174, 200}},
    {"blue", {40, 60, 170}},
    {"magenta", {190, 0, 150}},
}};

}  // namespace

const std::vector<std::string>& CircleColorNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const CircleInk& ink : kCircleInks) all.emplace_back(ink.name);
    return all;
  }();
  return names;
}

Eigen::Vector3f CircleReflectance(CircleColor color) {
  const std::array<uint8_t, 3>& srgb = kCircleInks.at(static_cast<size_t>(color)).srgb;
  Eigen::Vector3f linear;
  for (int c = 0; c < 3; ++c) linear[c] = LinearFromSrgb(static_cast<float>(srgb[c]) / 255.0f);
  return linear;
}

std::vector<BoardPlate> PlatesOf(const Board& board) {
  std::vector<BoardPlate> plates = {{&board, Pose()}};
  for (const AttachedBoard& attached : board.attached) {
    plates.push_back({&attached.board, attached.world_from_board});
  }
  return plates;
}

std::array<Eigen::Vector3d, 4> Board::TagCorners(const BoardTag& tag) const {
  const double h = tag_size_mm / 2;
  const double c = std::cos(tag.rotation), s = std::sin(tag.rotation);
  const std::array<Eigen::Vector2d, 4> upright = {Eigen::Vector2d(-h, h), Eigen::Vector2d(h, h),
                                                  Eigen::Vector2d(h, -h), Eigen::Vector2d(-h, -h)};
  std::array<Eigen::Vector3d, 4> corners;
  for (int i = 0; i < 4; ++i) {
    corners[i] = {tag.center_mm.x() + c * upright[i].x() - s * upright[i].y(),
                  tag.center_mm.y() + s * upright[i].x() + c * upright[i].y(), 0.0};
  }
  return corners;
}

std::vector<Eigen::Vector3d> Board::CheckerCorners() const {
  std::vector<Eigen::Vector3d> corners;
  for (int row = 1; row < checker_rows; ++row) {
    for (int column = 1; column < checker_columns; ++column) {
      corners.emplace_back((column - checker_columns / 2.0) * checker_square_mm,
                           (row - checker_rows / 2.0) * checker_square_mm, 0.0);
    }
  }
  return corners;
}

Image DrawBoard(const Board& board, double pixels_per_mm) {
  if (!(pixels_per_mm >= 0.1 && pixels_per_mm <= 100)) {
    throw Error("drawing a board: " + std::to_string(pixels_per_mm) +
                " pixels per mm; use 0.1 to 100");
  }
  constexpr int kSubsamples = 8;
  constexpr double kMaxPixels = 5e8;
  if (board.width_mm * pixels_per_mm * (board.height_mm * pixels_per_mm) > kMaxPixels) {
    throw Error((board.name.empty() ? "board" : board.name) +
                ": its picture would have more than 500 million pixels; use fewer pixels-per-mm");
  }
  const double pixel_diagonal_mm = 1.5 / pixels_per_mm;
  const BoardPrint print(board);
  const int width = std::max(1, static_cast<int>(std::lround(board.width_mm * pixels_per_mm)));
  const int height = std::max(1, static_cast<int>(std::lround(board.height_mm * pixels_per_mm)));
  const int channels = board.circles.empty() ? 1 : 3;
  Image picture(width, height, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  uint8_t* pixels = picture.Data<uint8_t>();
  ParallelFor(0, height, [&](int64_t row) {
    for (int column = 0; column < width; ++column) {
      const Eigen::Vector2d middle_mm(
          (column + 0.5 - width / 2.0) / pixels_per_mm,
          (height / 2.0 - static_cast<double>(row) - 0.5) / pixels_per_mm);
      const int subsamples =
          print.UniformRadius(middle_mm) > pixel_diagonal_mm / 2 ? 1 : kSubsamples;
      Eigen::Array3d paper(0, 0, 0);
      for (int s = 0; s < subsamples * subsamples; ++s) {
        const Eigen::Vector2d offset((s % subsamples + 0.5) / subsamples - 0.5,
                                     0.5 - (s / subsamples + 0.5) / subsamples);
        // The picture may be a fraction of a pixel larger than the plate.
        if (const auto color = print.Color(middle_mm + offset / pixels_per_mm)) {
          paper += color->cast<double>().array() / (subsamples * subsamples);
        }
      }
      for (int c = 0; c < channels; ++c) {
        const float coded = SrgbFromLinear(static_cast<float>(paper[c]));
        pixels[(row * width + column) * channels + c] =
            static_cast<uint8_t>(std::lround(std::clamp(coded, 0.0f, 1.0f) * 255));
      }
    }
  });
  return picture;
}

}  // namespace lfm
