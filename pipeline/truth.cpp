// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/truth.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nanoflann.hpp>

#include "calib/board.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/ray_scene.h"
#include "mesh/surface_comparison.h"
#include "mesh/surface_distance.h"

namespace lfm {
namespace {

constexpr int64_t kSurfaceSamples = 200000;
constexpr uint64_t kSampleSeed = 7;
constexpr double kCompletenessReach_mm = 0.5;
constexpr double kOutlier_mm = 1.0;

// The two eyes of one scan in the world.
struct ScanEyes {
  Camera camera, projector;
  Pose camera_from_world, projector_from_world;
};

std::vector<ScanEyes> TrueScans(const Capture& truth) {
  std::vector<ScanEyes> eyes;
  if (!truth.scanner || !truth.scanner->projector || !truth.scanner->projector_from_camera) {
    return eyes;
  }
  const auto camera = truth.cameras.find(truth.scanner->camera);
  if (camera == truth.cameras.end() || !camera->second.intrinsics) return eyes;
  for (const ScanSet& scan : truth.scanner->scans) {
    if (!scan.camera_from_world) continue;
    eyes.push_back({*camera->second.intrinsics, *truth.scanner->projector, *scan.camera_from_world,
                    *truth.scanner->projector_from_camera * *scan.camera_from_world});
  }
  return eyes;
}

bool Sees(const RayScene& scene, const Camera& camera, const Pose& eye_from_world,
          const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  const std::optional<Eigen::Vector2d> pixel = Project(camera, eye_from_world * point);
  if (!pixel || !camera.Contains(*pixel)) return false;
  const Eigen::Vector3d to_eye = eye_from_world.Center() - point;
  if (to_eye.dot(normal) <= 0) return false;
  constexpr double kLift_mm = 0.02;
  return !scene.Occluded(point + kLift_mm * normal, to_eye, 0, 1);
}

struct CloudAdaptor {
  const std::vector<Eigen::Vector3d>& points;
  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t i, size_t dim) const {
    return points[i][static_cast<Eigen::Index>(dim)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using CloudTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, CloudAdaptor>,
                                        CloudAdaptor, 3>;

}  // namespace

GroundTruth LoadGroundTruth(const std::filesystem::path& capture_folder) {
  const std::filesystem::path folder = capture_folder / "ground_truth";
  if (!std::filesystem::exists(folder / "capture.json")) {
    throw Error((folder / "capture.json").string() +
                ": no such file; only synthetic captures carry their truth: leave out "
                "--ground-truth");
  }
  GroundTruth truth{LoadCapture(folder), {}, {0, 0}};
  if (truth.capture.mesh.empty()) {
    throw Error((folder / "capture.json").string() + ": names no mesh; make the capture again");
  }
  truth.mesh = ReadPlyMesh(folder / truth.capture.mesh);
  ValidateMesh(truth.mesh, (folder / truth.capture.mesh).c_str());
  const Capture capture = LoadCapture(capture_folder);
  if (!capture.board.empty()) {
    const Board board = ReadBoard(capture_folder / capture.board);
    truth.plate_half_mm = {board.width_mm / 2, board.height_mm / 2};
  }
  return truth;
}

struct GeometryJudge::State {
  explicit State(const GroundTruth& truth)
      : mesh(truth.mesh),
        plate_half_mm(truth.plate_half_mm),
        scene(truth.mesh),
        scans(TrueScans(truth.capture)) {
    samples = SampleSurface(mesh, kSurfaceSamples, kSampleSeed);
    seen.resize(samples.points.size());
    ParallelFor(
        0, static_cast<int64_t>(seen.size()),
        [this](int64_t i) { seen[i] = SeenByScanner(samples.points[i], samples.normals[i]); }, 256);
  }

  bool SeenByScanner(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
    // A capture without scans has no unseen side: all of its surface counts.
    if (scans.empty()) return true;
    return std::any_of(scans.begin(), scans.end(), [&](const ScanEyes& eyes) {
      return Sees(scene, eyes.camera, eyes.camera_from_world, point, normal) &&
             Sees(scene, eyes.projector, eyes.projector_from_world, point, normal);
    });
  }

  TriangleMesh mesh;
  Eigen::Vector2d plate_half_mm;
  RayScene scene;
  std::vector<ScanEyes> scans;
  SurfaceSamples samples;
  std::vector<uint8_t> seen;
};

GeometryJudge::GeometryJudge(const GroundTruth& truth) : state_(std::make_unique<State>(truth)) {}
GeometryJudge::~GeometryJudge() = default;

PointErrors GeometryJudge::MeasurePoints(const PointCloud& cloud) const {
  if (cloud.points.empty()) throw Error("ground truth: there is no scanned point to measure");
  std::vector<double> distances = DistancesToMesh(cloud.points, state_->mesh);
  for (size_t i = 0; i < distances.size(); ++i) {
    // The platform was scanned too, and is as true as the object.
    const Eigen::Vector3d& p = cloud.points[i];
    if (std::abs(p.x()) <= state_->plate_half_mm.x() &&
        std::abs(p.y()) <= state_->plate_half_mm.y()) {
      distances[i] = std::min(distances[i], std::abs(p.z()));
    }
  }
  PointErrors errors;
  errors.over_1_mm_share =
      static_cast<double>(std::count_if(distances.begin(), distances.end(),
                                        [](double d) { return d > kOutlier_mm; })) /
      static_cast<double>(distances.size());
  const DistanceStatistics statistics = SummarizeDistances(std::move(distances));
  errors.median_mm = statistics.median;
  errors.p95_mm = statistics.p95;

  const CloudAdaptor adaptor{cloud.points};
  const CloudTree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<uint8_t> reached(state_->seen.size());
  ParallelFor(
      0, static_cast<int64_t>(reached.size()),
      [&](int64_t i) {
        if (!state_->seen[i]) return;
        uint32_t index = 0;
        double squared = 0;
        tree.knnSearch(state_->samples.points[i].data(), 1, &index, &squared);
        reached[i] = squared <= kCompletenessReach_mm * kCompletenessReach_mm;
      },
      256);
  const auto count = [](const std::vector<uint8_t>& flags) {
    return static_cast<double>(std::count(flags.begin(), flags.end(), uint8_t{1}));
  };
  const double seen = count(state_->seen);
  if (seen == 0) throw Error("ground truth: no scan sees the object");
  errors.completeness = count(reached) / seen;
  errors.seen_share = seen / static_cast<double>(state_->seen.size());
  return errors;
}

SurfaceErrors GeometryJudge::MeasureSurface(const TriangleMesh& mesh) const {
  std::vector<Eigen::Vector3d> seen_truth;
  for (size_t i = 0; i < state_->seen.size(); ++i) {
    if (state_->seen[i]) seen_truth.push_back(state_->samples.points[i]);
  }
  std::vector<double> distances = DistancesToMesh(seen_truth, mesh);

  const SurfaceSamples own = SampleSurface(mesh, kSurfaceSamples, kSampleSeed);
  std::vector<double> to_truth(own.points.size(), -1);
  ParallelFor(
      0, static_cast<int64_t>(own.points.size()),
      [&](int64_t i) {
        const auto closest = state_->scene.Closest(own.points[i]);
        if (!closest) return;
        const Eigen::Vector3d normal = TriangleNormal(state_->mesh, closest->triangle);
        if (state_->SeenByScanner(closest->point, normal)) to_truth[i] = closest->distance;
      },
      64);
  std::erase_if(to_truth, [](double d) { return d < 0; });
  if (distances.empty()) throw Error("ground truth: no scan sees the object");
  const SurfaceComparison c =
      CompareDistances(std::move(to_truth), std::move(distances), kSurfaceThreshold_mm);
  return {c.both.mean, c.both.rms, c.both.p95, c.both.max, c.accuracy, c.completeness, c.f_score};
}

}  // namespace lfm
