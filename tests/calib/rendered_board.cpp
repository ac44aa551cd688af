// SPDX-License-Identifier: BSD-3-Clause
#include "rendered_board.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "area_canvas.h"
#include "calib/corner_refinement.h"
#include "calib/tag_family.h"
#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr double kInk = 0.05, kPaper = 0.8, kBackground = 0.25, kObject = 0.1;

// Longer edges are drawn in pieces: lens and bend curve them.
constexpr double kPieceMm = 0.25, kTileMm = 10;

// A picture of one plate: what share of each pixel it covers, and what light that share sends.
struct PlatePicture {
  AreaCanvas covered;
  std::vector<AreaCanvas> light;  // red, green, blue
  Pose plate_from_camera;
};

// Draws onto the picture of one plate.
class PlatePainter {
 public:
  PlatePainter(const Camera& camera, const Pose& camera_from_plate, const Eigen::Vector3d& bend)
      : camera_(camera), camera_from_plate_(camera_from_plate), bend_(bend) {}

  /// The outline in the picture; empty when a part of it is not in front of the lens.
  std::vector<Eigen::Vector2d> Outline(const std::vector<Eigen::Vector2d>& corners) const {
    std::vector<Eigen::Vector2d> outline;
    for (size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
      const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / kPieceMm)));
      for (int k = 0; k < pieces; ++k) {
        const Eigen::Vector2d p = a + k * (b - a) / pieces;
        const double height =
            bend_.dot(Eigen::Vector3d(p.x() * p.x(), p.x() * p.y(), p.y() * p.y()));
        const auto pixel =
            Project(camera_, camera_from_plate_ * Eigen::Vector3d(p.x(), p.y(), height));
        if (!pixel) return {};
        outline.push_back(*pixel);
      }
    }
    return outline;
  }

 private:
  const Camera& camera_;
  const Pose camera_from_plate_;
  const Eigen::Vector3d bend_;
};

std::vector<Eigen::Vector2d> Rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

// Everything black that is printed on a plate, in squares.
std::vector<std::vector<Eigen::Vector2d>> InkSquares(const Board& board) {
  std::vector<std::vector<Eigen::Vector2d>> squares;
  const TagFamily family(board.family, board.border_cells, board.name);
  const double cell = board.tag_size_mm / family.cells_per_side();
  const int across = family.cells_across();
  for (const BoardTag& tag : board.tags) {
    const std::vector<uint8_t> cells = family.Cells(tag.id);
    const Eigen::Vector2d right(std::cos(tag.rotation), std::sin(tag.rotation));
    const Eigen::Vector2d up(-right.y(), right.x());
    for (int i = 0; i < across * across; ++i) {
      if (cells[static_cast<size_t>(i)] != 0) continue;
      std::vector<Eigen::Vector2d> square;
      for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        square.emplace_back(tag.center_mm + cell * ((i % across + x - across / 2.0) * right +
                                                    (across / 2.0 - i / across - y) * up));
      }
      squares.push_back(square);
    }
  }
  for (const BoardSquare& s : board.squares) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(s.size_mm / 2);
    squares.push_back(Rectangle(s.center_mm - half, s.center_mm + half));
  }
  const Eigen::Vector2d first =
      -board.checker_square_mm / 2 * Eigen::Vector2d(board.checker_columns, board.checker_rows);
  for (int y = 0; y < board.checker_rows; ++y) {
    for (int x = y % 2; x < board.checker_columns; x += 2) {
      const Eigen::Vector2d low = first + board.checker_square_mm * Eigen::Vector2d(x, y);
      squares.push_back(Rectangle(low, low + Eigen::Vector2d::Constant(board.checker_square_mm)));
    }
  }
  return squares;
}

std::vector<Eigen::Vector2d> Disc(const BoardCircle& circle) {
  constexpr int kCorners = 256;
  std::vector<Eigen::Vector2d> disc;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    disc.emplace_back(circle.center_mm +
                      circle.diameter_mm / 2 * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return disc;
}

PlatePicture PaintPlate(const BoardPlate& plate, const Camera& camera,
                        const Pose& camera_from_world, const Eigen::Vector3d& bend) {
  const AreaCanvas empty(camera.width, camera.height);
  const Pose camera_from_plate = camera_from_world * plate.world_from_plate;
  PlatePicture picture{empty, {3, empty}, camera_from_plate.Inverse()};
  const PlatePainter painter(camera, camera_from_plate, bend);
  const Board& board = *plate.board;
  const bool from_behind = picture.plate_from_camera.translation.z() <= 0;
  const double paper = from_behind ? kBackground : kPaper;
  const int columns = static_cast<int>(std::ceil(board.width_mm / kTileMm));
  const int rows = static_cast<int>(std::ceil(board.height_mm / kTileMm));
  const Eigen::Vector2d tile(board.width_mm / columns, board.height_mm / rows);
  for (int i = 0; i < columns * rows; ++i) {
    const Eigen::Vector2d low = Eigen::Vector2d(i % columns, i / columns).cwiseProduct(tile) -
                                Eigen::Vector2d(board.width_mm, board.height_mm) / 2;
    const auto outline = painter.Outline(Rectangle(low, low + tile));
    picture.covered.Add(outline, 1);
    for (AreaCanvas& channel : picture.light) channel.Add(outline, paper);
  }
  if (from_behind) return picture;
  for (const auto& square : InkSquares(board)) {
    const auto outline = painter.Outline(square);
    for (AreaCanvas& channel : picture.light) channel.Add(outline, kInk - kPaper);
  }
  for (const BoardCircle& circle : board.circles) {
    const auto outline = painter.Outline(Disc(circle));
    const Eigen::Vector3f color = CircleReflectance(circle.color);
    for (int c = 0; c < 3; ++c) {
      picture.light[c].Add(outline, (kPaper - kInk) * (color[c] - 1.0));
    }
  }
  return picture;
}

// How far away the plate is where a pixel looks.
double DistanceAlong(const PlatePicture& picture, const Eigen::Vector3d& ray) {
  const double along = (picture.plate_from_camera.rotation * ray).z();
  const double distance = -picture.plate_from_camera.translation.z() / along;
  return distance > 0 ? distance : 1e9;
}

Eigen::Vector3d Reflected(const std::vector<PlatePicture>& pictures, const Camera& camera, int x,
                          int y) {
  std::vector<std::pair<double, const PlatePicture*>> order;
  for (const PlatePicture& picture : pictures) {
    if (picture.covered.At(x, y) <= 0) continue;
    const double distance =
        pictures.size() == 1 ? 0 : DistanceAlong(picture, Unproject(camera, Eigen::Vector2d(x, y)));
    order.emplace_back(-distance, &picture);
  }
  std::ranges::sort(order);
  Eigen::Vector3d color = Eigen::Vector3d::Constant(kBackground);
  for (const auto& [distance, picture] : order) {
    color *= 1 - picture->covered.At(x, y);
    for (int c = 0; c < 3; ++c) color[c] += picture->light[c].At(x, y);
  }
  return color;
}

std::vector<Eigen::Vector3d> RenderLinear(const Board& board, const Camera& camera,
                                          const Pose& camera_from_world,
                                          const RenderSettings& settings) {
  const std::vector<BoardPlate> plates = PlatesOf(board);
  std::vector<std::optional<PlatePicture>> painted(plates.size());
  ParallelFor(0, static_cast<int64_t>(plates.size()), [&](int64_t i) {
    // Attached boards are stiff.
    const Eigen::Vector3d bend = i == 0 ? settings.bend_per_mm : Eigen::Vector3d::Zero();
    painted[i] = PaintPlate(plates[i], camera, camera_from_world, bend);
  });
  std::vector<PlatePicture> pictures;
  for (auto& picture : painted) pictures.push_back(std::move(*picture));
  std::vector<Eigen::Vector3d> linear(static_cast<size_t>(camera.width) * camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      Eigen::Vector3d value = Reflected(pictures, camera, x, y);
      value *= 1 + settings.light_gradient * (static_cast<double>(x) / camera.width - 0.5);
      const double ex = (x - camera.width / 2.0) / (camera.width / 2.0);
      const double ey = (y - camera.height / 2.0) / (camera.height / 2.0);
      if (std::hypot(ex, ey) < settings.hidden_share) value.setConstant(kObject);
      linear[static_cast<size_t>(y) * camera.width + x] = value.cwiseProduct(settings.gains);
    }
  }
  return linear;
}

void Blur(std::vector<Eigen::Vector3d>& linear, const Camera& camera, double blur_px) {
  for (int c = 0; c < 3; ++c) {
    Image channel(camera.width, camera.height, 1, PixelType::kFloat32, ColorEncoding::kLinear);
    for (size_t i = 0; i < linear.size(); ++i) {
      channel.Data<float>()[i] = static_cast<float>(linear[i][c]);
    }
    channel = BlurGray(channel, blur_px);
    for (size_t i = 0; i < linear.size(); ++i) linear[i][c] = channel.Data<float>()[i];
  }
}

}  // namespace

Image RenderBoard(const Board& board, const Camera& camera, const Pose& camera_from_world,
                  const RenderSettings& settings) {
  std::vector<Eigen::Vector3d> linear = RenderLinear(board, camera, camera_from_world, settings);
  if (settings.blur_px > 0) Blur(linear, camera, settings.blur_px);
  Image picture(camera.width, camera.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  ParallelFor(0, camera.height, [&](int64_t row) {
    std::mt19937 random(settings.seed * 7919u + static_cast<uint32_t>(row));
    std::normal_distribution<double> normal;
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double value = linear[static_cast<size_t>(y) * camera.width + x][c];
        double noisy = value;
        if (settings.full_well > 0) {
          const double electrons = value * settings.full_well;
          noisy += normal(random) *
                   std::sqrt(electrons + settings.read_noise * settings.read_noise) /
                   settings.full_well;
        }
        const float coded = std::clamp(SrgbFromLinear(static_cast<float>(noisy)), 0.0f, 1.0f);
        picture.At<uint8_t>(x, y, c) = static_cast<uint8_t>(std::lround(coded * 255));
      }
    }
  });
  return picture;
}

Camera SmallCamera() {
  Camera camera;
  camera.width = 480;
  camera.height = 360;
  camera.fx = 522, camera.fy = 519;
  camera.cx = 243.3, camera.cy = 176.4;
  camera.k1 = -0.09, camera.k2 = 0.04;
  camera.p1 = 0.0006, camera.p2 = -0.0004;
  return camera;
}

std::vector<Pose> PosesAround(int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2 * std::numbers::pi * i / count + 0.1;
    const double elevation =
        (30 + 45 * ((i * 7) % count) / static_cast<double>(count)) * std::numbers::pi / 180;
    const double distance = 330 + 20 * (i % 3);
    const Eigen::Vector3d eye(distance * std::cos(elevation) * std::cos(azimuth),
                              distance * std::cos(elevation) * std::sin(azimuth),
                              distance * std::sin(elevation));
    const double roll = 0.4 * std::sin(1.7 * i);
    const Eigen::Vector3d up(std::sin(roll) * std::sin(azimuth),
                             -std::sin(roll) * std::cos(azimuth), std::cos(roll));
    poses.push_back(LookAt(eye, {3.0 * (i % 4) - 5, 2.0 * (i % 5) - 4, 0}, up));
  }
  return poses;
}

ImageLoader RenderedCapture::Loader() const {
  return [this](const std::string& file) -> Image {
    for (size_t i = 0; i < pictures.size(); ++i) {
      if (file == capture.photos[i].file) return pictures[i];
    }
    throw Error(file + ": no such file");
  };
}

RenderedCapture RenderPoses(const Board& board, const std::vector<Pose>& poses, int train,
                            const RenderSettings& all_settings, const Camera& camera) {
  RenderedCapture rendered;
  rendered.camera = camera;
  rendered.poses = poses;
  rendered.capture.name = "rendered";
  rendered.capture.board = "board.json";
  rendered.capture.cameras["photo"] = {camera.width, camera.height, {}};
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    RenderSettings settings = all_settings;
    settings.seed += static_cast<uint32_t>(i);
    rendered.pictures.push_back(RenderBoard(board, camera, poses[i], settings));
    Photo photo;
    photo.id = "photo_" + std::to_string(i);
    photo.file = photo.id + ".png";
    photo.camera = "photo";
    photo.split = i < train ? PhotoSplit::kTrain : PhotoSplit::kTest;
    rendered.capture.photos.push_back(photo);
  }
  return rendered;
}

RenderedCapture RenderCapture(const Board& board, int train, int test, uint32_t seed,
                              const RenderSettings& all_settings, const Camera& camera) {
  std::vector<Pose> poses = PosesAround(train + test);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (Pose& pose : poses) {
    if (seed == 0) continue;
    const double turn = 0.3 * normal(random), x = 8 * normal(random), y = 8 * normal(random);
    const Pose moved{Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                     {x, y, 0}};
    pose = pose * moved;
  }
  RenderSettings settings = all_settings;
  settings.seed = 1000 * seed + 1;
  return RenderPoses(board, poses, train, settings, camera);
}

}  // namespace lfm
