// SPDX-License-Identifier: BSD-3-Clause
// Corners under distortion, blur and noise: our fit of the rendered print beside the saddle-point
// fit (a quadratic surface, Lucchese and Mitra 2002) and OpenCV's cornerSubPix on the same checker
// corners of the same pictures, all from the same starts; and the adjustment of many photographs.
// Counters: rms_px against the truth, corners found, worst_px. Tag corners are no saddle points:
// only the fit of the print finds them.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "calib/bundle_adjustment.h"
#include "calib/calib.h"
#include "calib/corner_refinement.h"
#include "tests/calib/rendered_board.h"
#include "tests/calib/simulated_views.h"

namespace {

using lfm::CornerPlace;
using lfm::Image;

struct Scene {
  lfm::Board board = lfm::DefaultBoard();
  lfm::Camera camera = lfm::SmallCamera();
  std::vector<CornerPlace> places;
  std::vector<lfm::Pose> poses = lfm::PosesAround(6);
  std::vector<Image> pictures;  ///< linear gray
  double blur_px = 0;
};

// 0: sharp; 1: a lens that distorts five times as much; 2: blur of 1.2 px; 3: both, noise of a
// tenth of the light.
Scene MakeScene(int kind) {
  Scene scene;
  if (kind == 1 || kind == 3) scene.camera.k1 *= 4, scene.camera.k2 *= 4;
  scene.blur_px = kind >= 2 ? 1.2 : 0;
  scene.places = lfm::PlaceCorners(scene.board, {});
  for (const lfm::Pose& pose : scene.poses) {
    lfm::RenderSettings settings;
    settings.full_well = kind == 3 ? 2000 : 20000;
    Image gray = lfm::LinearGray(lfm::RenderBoard(scene.board, scene.camera, pose, settings));
    scene.pictures.push_back(scene.blur_px > 0 ? lfm::BlurGray(gray, scene.blur_px) : gray);
  }
  return scene;
}

const Scene& SceneOf(int kind) {
  static const Scene scenes[] = {MakeScene(0), MakeScene(1), MakeScene(2), MakeScene(3)};
  return scenes[kind];
}

// A pose half a pixel off: where all methods start.
lfm::Pose Start(const lfm::Pose& pose) {
  lfm::Pose moved = pose;
  moved.translation += Eigen::Vector3d(0.25, -0.2, 0);
  return moved;
}

struct Sum {
  double squared = 0, worst = 0;
  int count = 0;
  void Add(const Eigen::Vector2d& error) {
    if (error.norm() > 2) return;  // ran away: counts as not found
    squared += error.squaredNorm();
    worst = std::max(worst, error.norm());
    ++count;
  }
  void Report(benchmark::State& state) const {
    state.counters["rms_px"] = std::sqrt(squared / std::max(1, count));
    state.counters["worst_px"] = worst;
    state.counters["corners"] = count;
  }
};

bool IsChecker(const Scene& scene, size_t corner) { return corner >= 4 * scene.board.tags.size(); }

// The stationary point of a quadratic surface fitted to a window, thrice.
std::optional<Eigen::Vector2d> FitSaddle(const cv::Mat& gray, Eigen::Vector2d at) {
  constexpr int kRadius = 4, kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const int x0 = static_cast<int>(std::lround(at.x())),
              y0 = static_cast<int>(std::lround(at.y()));
    if (x0 < kRadius || y0 < kRadius || x0 >= gray.cols - kRadius || y0 >= gray.rows - kRadius) {
      return std::nullopt;
    }
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (int y = -kRadius; y <= kRadius; ++y) {
      for (int x = -kRadius; x <= kRadius; ++x) {
        Eigen::Matrix<double, 6, 1> row;
        row << x * x, x * y, y * y, x, y, 1;
        normal += row * row.transpose();
        right += row * gray.at<float>(y0 + y, x0 + x);
      }
    }
    const Eigen::Matrix<double, 6, 1> q = normal.ldlt().solve(right);
    Eigen::Matrix2d hessian;
    hessian << 2 * q(0), q(1), q(1), 2 * q(2);
    if (!(hessian.determinant() < 0)) return std::nullopt;
    const Eigen::Vector2d step = -hessian.inverse() * q.segment<2>(3);
    if (step.norm() > 3) return std::nullopt;
    at = Eigen::Vector2d(x0, y0) + step;
  }
  return at;
}

void BM_PrintFit(benchmark::State& state) {
  const Scene& scene = SceneOf(static_cast<int>(state.range(0)));
  const bool tags = state.range(1) != 0;
  const lfm::BoardPrint print(scene.board);
  Sum sum;
  for (auto _ : state) {
    sum = {};
    for (size_t p = 0; p < scene.poses.size(); ++p) {
      for (const auto& found :
           lfm::FindCorners(scene.pictures[p], print, scene.places, scene.camera,
                            Start(scene.poses[p]), {.blur_px = scene.blur_px})) {
        const size_t corner = static_cast<size_t>(found.corner);
        if (IsChecker(scene, corner) == tags) continue;
        sum.Add(found.pixel -
                *Project(scene.camera, scene.poses[p] * scene.places[corner].position));
      }
    }
  }
  sum.Report(state);
}

template <typename Refine>
void RefineChecker(benchmark::State& state, const Refine& refine) {
  const Scene& scene = SceneOf(static_cast<int>(state.range(0)));
  Sum sum;
  for (auto _ : state) {
    sum = {};
    for (size_t p = 0; p < scene.poses.size(); ++p) {
      const Image& picture = scene.pictures[p];
      const cv::Mat gray(picture.height(), picture.width(), CV_32FC1,
                         const_cast<float*>(picture.Data<float>()));
      for (size_t i = 0; i < scene.places.size(); ++i) {
        if (!IsChecker(scene, i)) continue;
        const auto truth = Project(scene.camera, scene.poses[p] * scene.places[i].position);
        const auto start = Project(scene.camera, Start(scene.poses[p]) * scene.places[i].position);
        const auto found = refine(gray, *start);
        if (found) sum.Add(*found - *truth);
      }
    }
  }
  sum.Report(state);
}

void BM_SaddleFit(benchmark::State& state) { RefineChecker(state, FitSaddle); }

void BM_CornerSubPix(benchmark::State& state) {
  RefineChecker(
      state,
      [](const cv::Mat& gray, const Eigen::Vector2d& start) -> std::optional<Eigen::Vector2d> {
        std::vector<cv::Point2f> corner = {
            cv::Point2f(static_cast<float>(start.x()), static_cast<float>(start.y()))};
        cv::cornerSubPix(gray, corner, cv::Size(5, 5), cv::Size(-1, -1),
                         cv::TermCriteria(3, 40, 1e-3));
        return Eigen::Vector2d(corner[0].x, corner[0].y);
      });
}

// What limits the figures: 0 the usual; 1 no noise; 2 twice the pixels; 3 no lens distortion; 4
// tags 0.25 mm off, plate bent by 1.2 mm; 5 noise of a fifth of the light. Median errors over
// photographs.
void BM_Calibrate(benchmark::State& state) {
  const int64_t kind = state.range(0);
  lfm::Camera camera = lfm::SmallCamera();
  lfm::RenderSettings settings{.hidden_share = 0.25};
  lfm::Board printed = lfm::DefaultBoard();
  if (kind == 1) settings.full_well = 0;
  if (kind == 2) camera = lfm::ScaleCamera(camera, 2);
  if (kind == 3) camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
  if (kind == 4) {
    settings.bend_per_mm = {-1e-4, 0, 0};
    for (size_t t = 0; t < printed.tags.size(); ++t) {
      const double angle = 2.4 * static_cast<double>(t);
      printed.tags[t].center_mm += 0.25 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  if (kind == 5) settings.full_well = 800;
  const lfm::RenderedCapture rendered = lfm::RenderCapture(printed, 20, 0, 9, settings, camera);
  lfm::CalibResult result;
  for (auto _ : state) {
    result = lfm::Calibrate(rendered.capture, lfm::DefaultBoard(), rendered.Loader(), {},
                            lfm::SilentProgress());
  }
  std::vector<double> mm, deg;
  for (size_t i = 0; i < result.photos.size(); ++i) {
    const lfm::Pose& found = result.photos[i].camera_from_world;
    mm.push_back((found.Center() - rendered.poses[i].Center()).norm());
    deg.push_back(lfm::RotationAngle(found.rotation, rendered.poses[i].rotation) * 57.29578);
  }
  std::nth_element(mm.begin(), mm.begin() + mm.size() / 2, mm.end());
  std::nth_element(deg.begin(), deg.begin() + deg.size() / 2, deg.end());
  const lfm::Camera& found = result.cameras.at("photo");
  state.counters["mm"] = mm[mm.size() / 2];
  state.counters["deg"] = deg[deg.size() / 2];
  state.counters["rms_px"] = result.reprojection_rms_px;
  state.counters["focal_%"] = 100 * std::abs(found.fx / camera.fx - 1);
  state.counters["centre_px"] = std::hypot(found.cx - camera.cx, found.cy - camera.cy);
  state.counters["terms"] = result.lens_terms.at("photo");
}

void BM_Adjust(benchmark::State& state) {
  const int photos = static_cast<int>(state.range(0));
  const lfm::Camera camera = lfm::SmallCamera();
  std::vector<lfm::BundleView> views =
      lfm::SimulatedViews(camera, lfm::PosesAround(photos), lfm::DefaultBoard(), 0.1, 1);
  for (lfm::BundleView& view : views) view.camera_from_world.translation.z() += 2;
  for (auto _ : state) {
    benchmark::DoNotOptimize(lfm::AdjustBundle(camera, views, {.lens_terms = 4}));
  }
  state.counters["corners"] = photos * 177.0;
}

}  // namespace

BENCHMARK(BM_PrintFit)->ArgsProduct({{0, 1, 2, 3}, {0, 1}})->ArgNames({"scene", "tags"});
BENCHMARK(BM_SaddleFit)->DenseRange(0, 3)->ArgName("scene");
BENCHMARK(BM_CornerSubPix)->DenseRange(0, 3)->ArgName("scene");
BENCHMARK(BM_Calibrate)->DenseRange(0, 5)->ArgName("kind")->Iterations(1);
BENCHMARK(BM_Adjust)->Arg(120)->Arg(1000)->ArgName("photos")->Unit(benchmark::kMillisecond);
