// SPDX-License-Identifier: BSD-3-Clause
#include "bench/lumigraph.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/pixel_directions.h"
#include "core/ray_scene.h"
#include "resample/patch_sampling.h"
#include "resample/photo_depth.h"
#include "resample/used_photos.h"
#include "resample/visibility.h"

namespace lfm {
namespace {

const double kLeastCosine = std::cos(85 * std::numbers::pi / 180);
constexpr double kResolutionWeight = 0.05;
constexpr double kLeastPenalty =
    1e-6;  // a photograph from the wanted view itself: no division by 0

struct SourcePhoto {
  Camera camera;
  Pose camera_from_world;
  Eigen::Vector3d eye;
  PhotoPixels pixels;
  DepthMap depth;
};

// The wanted point and the triangle's properties that decide who sees it.
struct SurfacePoint {
  Eigen::Vector3d position, normal, to_eye;
  double footprint = 1;
  double deviation_mm = 0;
};

struct Candidate {
  double penalty = 0;
  int photo = 0;
};

// Cheap to know for all photographs: what faces the point.
std::vector<Candidate> RankPhotos(const std::vector<SourcePhoto>& photos,
                                  const SurfacePoint& point) {
  std::vector<Candidate> candidates;
  for (size_t p = 0; p < photos.size(); ++p) {
    const Eigen::Vector3d to_photo = photos[p].eye - point.position;
    const double distance = to_photo.norm();
    const double cosine = point.normal.dot(to_photo) / distance;
    if (!(cosine > kLeastCosine)) continue;
    const double angle =
        std::atan2(point.to_eye.cross(to_photo).norm(), point.to_eye.dot(to_photo));
    const double footprint = distance / (photos[p].camera.fx * cosine);
    const double coarser = std::max(0.0, footprint / point.footprint - 1);
    candidates.push_back(
        {std::max(angle + kResolutionWeight * coarser, kLeastPenalty), static_cast<int>(p)});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.penalty != b.penalty ? a.penalty < b.penalty : a.photo < b.photo;
  });
  return candidates;
}

// The photograph's colour there, when it is not hidden and its pixels are at least `use`.
std::optional<Eigen::Vector3f> SeenColor(const SourcePhoto& photo, const SurfacePoint& point,
                                         PixelUse use) {
  const Eigen::Vector3d in_camera = photo.camera_from_world * point.position;
  const auto pixel = Project(photo.camera, in_camera);
  if (!pixel) return std::nullopt;
  const auto tap = TapAt(photo.pixels.width, photo.pixels.height, *pixel);
  if (!tap) return std::nullopt;
  const double cosine = point.normal.dot(photo.eye - point.position) / in_camera.norm();
  const double slope = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
  const double tolerance =
      in_camera.z() / photo.camera.fx * (1 + slope) + 2 * point.deviation_mm / cosine;
  const std::array<float, 4> weight = {(1 - tap->fx) * (1 - tap->fy), tap->fx * (1 - tap->fy),
                                       (1 - tap->fx) * tap->fy, tap->fx * tap->fy};
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  double nearest = HUGE_VAL;
  for (int k = 0; k < 4; ++k) {
    const int x = tap->x + k % 2, y = tap->y + k / 2;
    const uint8_t* rgbu = photo.pixels.At(x, y);
    if (static_cast<PixelUse>(rgbu[3]) < use) return std::nullopt;
    color += weight[k] * Eigen::Vector3f(rgbu[0], rgbu[1], rgbu[2]);
    nearest = std::min(nearest, static_cast<double>(photo.depth.At(x, y)));
  }
  if (in_camera.z() > nearest + tolerance) return std::nullopt;
  return color / 255;
}

struct SeenPhotograph {
  double penalty = 0;
  Eigen::Vector3f color;
};

// The nearest `count` photographs that see the point; those beside depth edges only where no other
// does.
std::vector<SeenPhotograph> FindSeen(const std::vector<SourcePhoto>& photos,
                                     const SurfacePoint& point, size_t count) {
  const std::vector<Candidate> ranked = RankPhotos(photos, point);
  std::vector<SeenPhotograph> seen;
  for (const PixelUse use : {PixelUse::kData, PixelUse::kNearEdge}) {
    for (const Candidate& candidate : ranked) {
      if (seen.size() == count) break;
      const auto color = SeenColor(photos[candidate.photo], point, use);
      if (color) seen.push_back({candidate.penalty, *color});
    }
    if (!seen.empty()) break;
  }
  return seen;
}

Eigen::Vector3f Blend(const std::vector<SeenPhotograph>& seen, int neighbors) {
  if (seen.empty()) return Eigen::Vector3f::Zero();
  if (neighbors == 1) return seen.front().color;
  const auto wanted = static_cast<size_t>(neighbors);
  const size_t used = neighbors == 0 ? seen.size() : std::min(seen.size(), wanted);
  // With fewer than k every one keeps some weight.
  const double limit = seen[used - 1].penalty * (used == wanted ? 1 : 1.5);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float total = 0;
  for (size_t i = 0; i < used; ++i) {
    const double penalty = seen[i].penalty;
    const auto weight = static_cast<float>(neighbors == 0 ? 1 : (1 - penalty / limit) / penalty);
    sum += weight * seen[i].color;
    total += weight;
  }
  return total > 0 ? sum / total : seen.front().color;
}

}  // namespace

struct Lumigraph::State {
  explicit State(const TriangleMesh& m) : mesh(m), rays(m) {}
  const TriangleMesh mesh;
  RayScene rays;
  std::vector<double> deviations_mm;
  std::vector<SourcePhoto> photos;
  int64_t photo_bytes = 0;

  SurfacePoint PointAt(const RayHit& hit, const Eigen::Vector3d& eye,
                       const Eigen::Vector3d& direction, const Camera& camera) const {
    const Eigen::Vector3i& corners = mesh.triangles[hit.triangle];
    const Eigen::Vector3d& a = mesh.vertices[corners[0]];
    SurfacePoint point;
    point.position = eye + hit.distance * direction;
    point.normal =
        (mesh.vertices[corners[1]] - a).cross(mesh.vertices[corners[2]] - a).normalized();
    point.to_eye = -direction;
    const double cosine = std::max(std::abs(point.normal.dot(direction)), kLeastCosine);
    point.footprint = hit.distance / (camera.fx * cosine);
    point.deviation_mm = deviations_mm[hit.triangle];
    return point;
  }
};

Lumigraph::Lumigraph(const Capture& capture, const CalibResult& calib, const TriangleMesh& surface,
                     const TriangleMesh& mesh)
    : state_(std::make_unique<State>(mesh)) {
  const RayScene surface_rays(surface);
  state_->deviations_mm = TriangleDeviations(mesh, surface_rays);
  const std::vector<UsedPhoto> used = FindUsedPhotos(capture, calib);
  const ImageLoader load = MakeImageLoader(capture);
  state_->photos.resize(used.size());
  ParallelFor(0, static_cast<int64_t>(used.size()), [&](int64_t p) {
    SourcePhoto& photo = state_->photos[p];
    photo.camera = used[p].camera;
    photo.camera_from_world = used[p].camera_from_world;
    photo.eye = photo.camera_from_world.Center();
    photo.depth = RenderDepth(surface, surface_rays, photo.camera, PixelDirections(photo.camera),
                              photo.camera_from_world);
    photo.pixels = MakePhotoPixels(
        load(used[p].file),
        FindUsablePixels(photo.depth, photo.camera, ResampleOptions{}.depth_margin_px),
        photo.camera, used[p].file);
  });
  for (const UsedPhoto& photo : used) {
    state_->photo_bytes +=
        static_cast<int64_t>(std::filesystem::file_size(capture.folder / photo.file));
  }
}

Lumigraph::~Lumigraph() = default;

int64_t Lumigraph::PhotoBytes() const { return state_->photo_bytes; }

std::vector<Image> Lumigraph::Render(const Camera& camera, const Pose& camera_from_world,
                                     const std::vector<int>& neighbors) const {
  std::vector<Image> pictures;
  for (size_t i = 0; i < neighbors.size(); ++i) {
    pictures.emplace_back(camera.width, camera.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  const size_t most = std::count(neighbors.begin(), neighbors.end(), 0) > 0
                          ? state_->photos.size()
                          : *std::max_element(neighbors.begin(), neighbors.end());
  const Eigen::Matrix3d world_from_camera = camera_from_world.rotation.transpose();
  const Eigen::Vector3d eye = camera_from_world.Center();
  const auto seen_at = [&](const Eigen::Vector2d& pixel) {
    const auto in_camera = TryUnproject(camera, pixel);
    std::optional<std::vector<SeenPhotograph>> none;
    if (!in_camera) return none;
    const Eigen::Vector3d direction = (world_from_camera * *in_camera).normalized();
    const auto hit = state_->rays.Intersect(eye, direction);
    if (!hit) return none;
    const SurfacePoint point = state_->PointAt(*hit, eye, direction, camera);
    return std::optional(FindSeen(state_->photos, point, most));
  };
  ParallelFor(0, camera.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      std::vector<Eigen::Vector3f> linear(neighbors.size(), Eigen::Vector3f::Zero());
      int hits = 0;
      for (int k = 0; k < 4; ++k) {
        const auto seen = seen_at({x - 0.25 + 0.5 * (k % 2), y - 0.25 + 0.5 * (k / 2)});
        if (!seen) continue;
        ++hits;
        for (size_t i = 0; i < neighbors.size(); ++i) {
          linear[i] += Blend(*seen, neighbors[i]).unaryExpr([](float value) {
            return LinearFromSrgb(value);
          });
        }
      }
      for (size_t i = 0; i < neighbors.size() && hits > 0; ++i) {
        for (int c = 0; c < 3; ++c) {
          const float value = SrgbFromLinear(linear[i][c] / static_cast<float>(hits));
          pictures[i].At<uint8_t>(x, y, c) =
              static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.f, 1.f)));
        }
      }
    }
  });
  return pictures;
}

}  // namespace lfm
