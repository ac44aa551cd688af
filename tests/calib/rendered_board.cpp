// SPDX-License-Identifier: BSD-3-Clause
#include "rendered_board.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "calib/corner_refinement.h"
#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr double kInk = 0.05, kPaper = 0.8, kBackground = 0.25, kObject = 0.1;

// Where the rays through the pixel corners meet a plate, and how far away; interpolated inside a
// pixel.
struct PlateView {
  const BoardPrint* print = nullptr;
  bool from_behind = false;
  std::vector<Eigen::Vector3d> at_corners;  // x, y on the plate, distance
};

// Where a ray from `eye` through a flat plate's point `p` meets the bent one: its slope is small,
// each round gains a digit or more.
Eigen::Vector2d OntoBend(Eigen::Vector2d p, const Eigen::Vector3d& eye, const Eigen::Vector3d& ray,
                         const Eigen::Vector3d& bend) {
  for (int round = 0; round < 12 && p.norm() <= 500; ++round) {
    const double height = bend.dot(Eigen::Vector3d(p.x() * p.x(), p.x() * p.y(), p.y() * p.y()));
    p = (eye + (height - eye.z()) / ray.z() * ray).head<2>();
  }
  return p;
}

PlateView ViewPlate(const BoardPrint::Plate& plate, const Camera& camera,
                    const Pose& camera_from_world, const Eigen::Vector3d& bend) {
  const Pose plate_from_camera = (camera_from_world * plate.world_from_plate).Inverse();
  const Eigen::Vector3d& eye = plate_from_camera.translation;
  PlateView view{plate.print, eye.z() <= 0, {}};
  view.at_corners.resize(static_cast<size_t>(camera.width + 1) * (camera.height + 1));
  ParallelFor(0, camera.height + 1, [&](int64_t y) {
    for (int x = 0; x <= camera.width; ++x) {
      const Eigen::Vector3d ray =
          plate_from_camera.rotation * Unproject(camera, {x - 0.5, static_cast<double>(y) - 0.5});
      // Rays that miss the plane look far beyond the plate.
      const double t = ray.z() * eye.z() < -1e-6 * std::abs(eye.z()) ? -eye.z() / ray.z() : 1e9;
      Eigen::Vector2d p = (eye + t * ray).head<2>();
      if (t < 1e9 && !bend.isZero(0)) p = OntoBend(p, eye, ray, bend);
      view.at_corners[static_cast<size_t>(y) * (camera.width + 1) + x] = {p.x(), p.y(), t};
    }
  });
  return view;
}

Eigen::Vector3d Reflected(const std::vector<PlateView>& views, const Camera& camera, int x, int y,
                          double u, double v) {
  const size_t i = static_cast<size_t>(y) * (camera.width + 1) + x;
  Eigen::Vector3d color = Eigen::Vector3d::Constant(kBackground);
  double nearest = 1e8;
  for (const PlateView& view : views) {
    const std::vector<Eigen::Vector3d>& c = view.at_corners;
    const Eigen::Vector3d p = (1 - v) * ((1 - u) * c[i] + u * c[i + 1]) +
                              v * ((1 - u) * c[i + camera.width + 1] + u * c[i + camera.width + 2]);
    if (!(p.z() < nearest)) continue;
    const auto print = view.print->Color(p.head<2>());
    if (!print) continue;
    nearest = p.z();
    color = Eigen::Vector3d::Constant(view.from_behind ? kBackground : kInk);
    if (!view.from_behind) color += (kPaper - kInk) * print->cast<double>();
  }
  return color;
}

// Whether all of a pixel shows one paper or ink, as far as it is easily seen.
bool IsUniform(const std::vector<PlateView>& views, const Camera& camera, int x, int y) {
  if (views.size() != 1) return false;
  const std::vector<Eigen::Vector3d>& c = views[0].at_corners;
  const size_t i = static_cast<size_t>(y) * (camera.width + 1) + x;
  const size_t below = i + camera.width + 1;
  const Eigen::Vector2d middle = (c[i] + c[i + 1] + c[below] + c[below + 1]).head<2>() / 4;
  double reach = 0;
  for (const size_t corner : {i, i + 1, below, below + 1}) {
    reach = std::max(reach, (c[corner].head<2>() - middle).norm());
  }
  return views[0].print->UniformRadius(middle) > reach;
}

std::vector<Eigen::Vector3d> RenderLinear(const BoardPrint& print, const Camera& camera,
                                          const Pose& camera_from_world,
                                          const RenderSettings& settings) {
  std::vector<PlateView> views;
  for (int plate = 0; plate < print.Plates(); ++plate) {
    // Attached boards are stiff.
    const Eigen::Vector3d bend = plate == 0 ? settings.bend_per_mm : Eigen::Vector3d::Zero();
    views.push_back(ViewPlate(print.PlateAt(plate), camera, camera_from_world, bend));
  }
  const int n = settings.subsamples;
  std::vector<Eigen::Vector3d> linear(static_cast<size_t>(camera.width) * camera.height);
  ParallelFor(0, camera.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      Eigen::Vector3d value = Reflected(views, camera, x, y, 0.5, 0.5);
      if (!IsUniform(views, camera, x, y)) {
        value.setZero();
        // Every place has a column and a row of its own: edges along either lose nothing.
        for (int i = 0; i < n; ++i) {
          for (int j = 0; j < n; ++j) {
            const double u = (i + (j + 0.5) / n) / n, v = (j + (i + 0.5) / n) / n;
            value += Reflected(views, camera, x, y, u, v) / (n * n);
          }
        }
      }
      value *= 1 + settings.light_gradient * (static_cast<double>(x) / camera.width - 0.5);
      const double ex = (x - camera.width / 2.0) / (camera.width / 2.0);
      const double ey = (y - camera.height / 2.0) / (camera.height / 2.0);
      if (std::hypot(ex, ey) < settings.hidden_share) value.setConstant(kObject);
      linear[static_cast<size_t>(y) * camera.width + x] = value.cwiseProduct(settings.gains);
    }
  });
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

Image RenderBoard(const BoardPrint& print, const Camera& camera, const Pose& camera_from_world,
                  const RenderSettings& settings) {
  std::vector<Eigen::Vector3d> linear = RenderLinear(print, camera, camera_from_world, settings);
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
  const BoardPrint print(board);
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    RenderSettings settings = all_settings;
    settings.seed += static_cast<uint32_t>(i);
    rendered.pictures.push_back(RenderBoard(print, camera, poses[i], settings));
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
