// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/camera_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGoldenAngle = 2.399963229728653;
constexpr int kTries = 200;

// The convex hull's vertices would do; every vertex that is extreme in one of many directions is a
// cheap and close stand-in.
std::vector<V3> ExtremePoints(const TriangleMesh& mesh) {
  constexpr int kDirections = 500;
  std::vector<V3> extremes(kDirections);
  ParallelFor(0, kDirections, [&](int64_t i) {
    const double z = 1 - 2 * (i + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const double angle = kGoldenAngle * static_cast<double>(i);
    const V3 direction(r * std::cos(angle), r * std::sin(angle), z);
    double best = -1e300;
    for (const V3& p : mesh.vertices) {
      if (p.dot(direction) > best) {
        best = p.dot(direction);
        extremes[i] = p;
      }
    }
  });
  return extremes;
}

bool IsFramed(const Camera& camera, const Pose& camera_from_world, const std::vector<V3>& points) {
  const double margin = 0.01 * camera.height;
  return std::all_of(points.begin(), points.end(), [&](const V3& p) {
    const auto pixel = Project(camera, camera_from_world * p);
    return pixel && pixel->x() > margin && pixel->y() > margin &&
           pixel->x() < camera.width - margin && pixel->y() < camera.height - margin;
  });
}

struct Aim {
  V3 center;        // of the subject
  double distance;  // mm, before jitter
};

CameraStation TryStation(const CameraPathOptions& options, const Aim& aim, int index,
                         RandomStream& random, double pull_back) {
  // Equal areas of the sphere: z is spread evenly.
  const double low = std::sin(options.min_elevation_deg * kDegree);
  const double high = std::sin(options.max_elevation_deg * kDegree);
  const double z = low + (high - low) * (index + 0.5) / options.photos;
  const double elevation = std::clamp(std::asin(z) / kDegree + random.Uniform(-2.5, 2.5),
                                      options.min_elevation_deg, options.max_elevation_deg);
  const double azimuth = kGoldenAngle * index + random.Uniform(-5, 5) * kDegree;
  const double e = elevation * kDegree;
  const V3 outward(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), std::sin(e));
  const double jitter = random.Uniform(-options.distance_jitter, options.distance_jitter);
  const V3 eye = aim.center + aim.distance * (1 + jitter) * pull_back * outward;
  const double reach = options.max_aim_error_mm / std::sqrt(3.0);
  const V3 target = aim.center + V3(random.Uniform(-reach, reach), random.Uniform(-reach, reach),
                                    random.Uniform(-reach, reach));
  const double roll = random.Uniform(-options.max_roll_deg, options.max_roll_deg) * kDegree;
  const Pose rolled{Eigen::AngleAxisd(roll, V3::UnitZ()).toRotationMatrix(), V3::Zero()};
  CameraStation station;
  station.camera_from_world = rolled * LookAt(eye, target, V3::UnitZ());
  station.elevation_deg = elevation;
  return station;
}

}  // namespace

Camera MakePhotoCamera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  const double scale = height / 720.0;
  camera.fx = 1104.6 * scale;
  camera.fy = 1106.1 * scale;
  camera.cx = (width - 1) / 2.0 + 7.3 * scale;
  camera.cy = (height - 1) / 2.0 - 5.2 * scale;
  camera.k1 = -0.112;
  camera.k2 = 0.081;
  camera.k3 = -0.012;
  camera.p1 = 0.0006;
  camera.p2 = -0.0009;
  return camera;
}

Camera ScaleDistortion(const Camera& camera, double factor) {
  if (factor == 1) return camera;
  Camera scaled = camera;
  for (double Camera::*term : {&Camera::k1, &Camera::k2, &Camera::k3, &Camera::p1, &Camera::p2,
                               &Camera::k4, &Camera::k5, &Camera::k6}) {
    scaled.*term *= factor;
  }
  try {
    for (double x : {-1.0, static_cast<double>(camera.width)}) {
      for (double y : {-1.0, static_cast<double>(camera.height)}) Unproject(scaled, {x, y});
    }
  } catch (const Error&) {
    throw Error("a lens with " + std::to_string(factor) +
                " times the usual distortion folds over inside the picture; choose a distortion "
                "nearer to 1");
  }
  return scaled;
}

Eigen::Vector3d SubjectCenter(const TriangleMesh& subject) {
  double top = 0;
  for (const V3& p : subject.vertices) top = std::max(top, p.z());
  return {0, 0, 0.47 * top};
}

std::vector<CameraStation> MakeCameraPath(const Camera& camera, const TriangleMesh& subject,
                                          const CameraPathOptions& options) {
  if (options.test_photos > options.photos) {
    throw Error("--test-photos (" + std::to_string(options.test_photos) +
                ") is more than --photos (" + std::to_string(options.photos) + ")");
  }
  const std::vector<V3> extremes = ExtremePoints(subject);
  Eigen::AlignedBox3d box;
  for (const V3& p : extremes) box.extend(p);
  const Aim aim{V3(0, 0, 0.47 * box.max().z()), camera.fx * options.mm_per_pixel};
  std::vector<CameraStation> stations;
  for (int i = 0; i < options.photos; ++i) {
    RandomStream random(options.seed, 11, static_cast<uint64_t>(i));
    bool framed = false;
    for (int attempt = 0; attempt < kTries && !framed; ++attempt) {
      const CameraStation station =
          TryStation(options, aim, i, random, 1 + 0.01 * std::max(0, attempt - 10));
      framed = IsFramed(camera, station.camera_from_world, extremes);
      if (framed) stations.push_back(station);
    }
    if (!framed) {
      throw Error(
          "the subject does not fit into the pictures even from far; check the mesh's size");
    }
  }
  for (int k = 0; k < options.test_photos; ++k) {
    // Stations ascend with their index: a twentieth at either end stays out of it.
    const double share = 0.05 + 0.9 * (k + 0.5) / options.test_photos;
    const int index = static_cast<int>(share * options.photos);
    stations[index].split = PhotoSplit::kTest;
  }
  return stations;
}

}  // namespace lfm
