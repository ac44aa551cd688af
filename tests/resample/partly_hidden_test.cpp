// SPDX-License-Identifier: BSD-3-Clause
// Triangles of which something hides a part in some photographs: what is taken from those.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/ray_scene.h"
#include "resample/patch_sampling.h"
#include "resample/resample.h"
#include "resample/view_weights.h"
#include "test_scenes.h"

namespace lfm {
namespace {

constexpr int kPhotos = 24, kObjectTriangles = 1280;
constexpr double kRadius = 40;

/// Small spheres that float above a large one, which they cut into.
TriangleMesh WithOccluders(const TriangleMesh& object, int subdivisions) {
  TriangleMesh mesh = object;
  for (const Eigen::Vector3d& center :
       {Eigen::Vector3d(0, 0, 62), Eigen::Vector3d(45, 0, 40), Eigen::Vector3d(-30, 40, 35)}) {
    mesh = test::Join(mesh, test::Sphere(center, 6, subdivisions));
  }
  return mesh;
}

/// What the object shows in green alone, and in each photograph as bright as it likes: neighbours
/// do not tell.
double Green(const Eigen::Vector3d& p, size_t photo) {
  const double texture = 0.6 + 0.3 * std::sin(p.x() / 6) * std::cos(p.y() / 7);
  return texture * (0.7 + 0.3 * std::sin(12.9898 * static_cast<double>(photo)));
}

class PartlyHidden : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto poses = test::PosesAround(kPhotos, 260);
    const Camera camera = test::TestCamera(320, 240, 560);
    made_ = new test::MemoryCapture(test::MakeCapture(
        test::Sphere({0, 0, 0}, 1, 0), camera, poses,
        [](const Eigen::Vector3d&) { return Eigen::Vector3d::Zero(); }, {}, 1));
    const TriangleMesh surface = WithOccluders(test::Sphere({0, 0, 0}, kRadius, 5), 4);
    for (size_t i = 0; i < poses.size(); ++i) {
      made_->pictures["photo" + std::to_string(i) + ".png"] = test::RenderPhoto(
          surface, camera, poses[i],
          [i](const Eigen::Vector3d& p) -> Eigen::Vector3d {
            if (p.norm() > kRadius + 1) return {1, 0, 1};
            return {0, Green(p, i), 0};
          },
          {0, 0, 0}, 3);
    }
  }
  static void TearDownTestSuite() { delete made_; }

  ResampleResult Run(const ResampleOptions& options, const std::filesystem::path& file) const {
    return Resample(made_->capture, made_->calib, surface_, mesh_, made_->Loader(), options, file,
                    SilentProgress());
  }
  static ResampleOptions Share(double max_hidden_share) {
    ResampleOptions options;
    options.view_grid = 4;
    options.photo_gains = PhotoGainUse::kOff;
    options.max_hidden_share = max_hidden_share;
    options.min_data_share = 0.1;
    return options;
  }
  std::vector<Eigen::Vector3d> Points(const LightField& field, int triangle) const {
    return PatchPoints(field.mesh(), triangle, field.Patch(triangle).edge_samples, SampleOn::kMesh,
                       scene_, 0);
  }
  /// Whether a photograph shows something else, 2 mm before a point of the object.
  bool IsHidden(const Eigen::Vector3d& point, size_t photo) const {
    const Eigen::Vector3d ray = point - made_->calib.photos[photo].camera_from_world.Center();
    const auto hit = scene_.Intersect(point - ray, ray.normalized());
    return hit && hit->distance < ray.norm() - 2;
  }
  int64_t CountHidden(const LightField& field) const {
    int64_t hidden = 0;
    for (int t = 0; t < kObjectTriangles; ++t) {
      for (const Eigen::Vector3d& point : Points(field, t)) {
        for (const uint16_t photo : field.Patch(t).photos) hidden += IsHidden(point, photo) ? 1 : 0;
      }
    }
    return hidden;
  }

  static test::MemoryCapture* made_;
  const TriangleMesh surface_ = WithOccluders(test::Sphere({0, 0, 0}, kRadius, 5), 4);
  const TriangleMesh mesh_ = WithOccluders(test::Sphere({0, 0, 0}, kRadius, 3), 2);
  const RayScene scene_ = RayScene(surface_);
};
test::MemoryCapture* PartlyHidden::made_ = nullptr;

TEST_F(PartlyHidden, CountsOnlyWhereAskedFor) {
  const auto folder = test::TestFolder("hidden_share");
  const ResampleResult without = Run(Share(0), folder / "without.lfs");
  const ResampleResult with = Run(Share(0.85), folder / "with.lfs");
  EXPECT_EQ(without.hidden_share, 0);
  EXPECT_GT(with.hidden_share, 0.002);
  EXPECT_GT(with.mean_visible_views, without.mean_visible_views + 0.1);
  // Edges between two pixels are known to half a pixel.
  EXPECT_LT(CountHidden(LightField::Open(folder / "without.lfs")), 50);
  EXPECT_GT(CountHidden(LightField::Open(folder / "with.lfs")), 1000);
}

TEST_F(PartlyHidden, LetsNoColourOfTheOccluderIn) {
  const auto file = test::TestFolder("hidden_leak") / "light_field.lfs";
  Run(Share(0.85), file);
  const LightField field = LightField::Open(file);
  for (int t = 0; t < kObjectTriangles; ++t) {
    const TrianglePatch patch = field.Patch(t);
    for (size_t i = 0; i < patch.values.size(); ++i) {
      if (i / patch.photos.size() % 3 == 1) continue;
      ASSERT_LT(double(patch.values[i]) / LightField::kOne, 0.002) << "triangle " << t;
    }
  }
}

TEST_F(PartlyHidden, TellsMoreThanTheOtherPhotographs) {
  const auto folder = test::TestFolder("hidden_truth");
  Run(Share(0), folder / "without.lfs");
  Run(Share(0.85), folder / "with.lfs");
  const LightField without = LightField::Open(folder / "without.lfs");
  const LightField with = LightField::Open(folder / "with.lfs");
  double error_with = 0, error_without = 0;
  int views = 0;
  for (int t = 0; t < kObjectTriangles; ++t) {
    const TrianglePatch less = without.Patch(t), more = with.Patch(t);
    if (less.photos.size() < 3 || less.edge_samples != more.edge_samples) continue;
    const auto points = Points(with, t);
    const Eigen::Matrix3d frame =
        with.vertex_frames()[static_cast<size_t>(with.mesh().triangles[t][0])];
    const auto in_plane = [&](uint16_t photo) {
      const Eigen::Vector3d eye = made_->calib.photos[photo].camera_from_world.Center();
      return PlaneFromDirection(with.direction_map(),
                                frame.transpose() * (eye - points[0]).normalized());
    };
    std::vector<Eigen::Vector2d> others;
    for (const uint16_t photo : less.photos) others.push_back(in_plane(photo));
    for (size_t v = 0; v < more.photos.size(); ++v) {
      const uint16_t photo = more.photos[v];
      if (std::find(less.photos.begin(), less.photos.end(), photo) != less.photos.end()) continue;
      const auto blend = ComputeViewWeights(others, std::vector{in_plane(photo)});
      ++views;
      for (size_t s = 0; s < points.size(); ++s) {
        const double truth = Green(points[s], photo);
        const size_t row = 3 * s + 1;
        double blended = 0;
        for (size_t k = 0; k < 3; ++k) {
          blended += blend.weight[k] * less.values[row * less.photos.size() + blend.view[k]];
        }
        const auto kOne = double{LightField::kOne};
        error_with += std::pow(more.values[row * more.photos.size() + v] / kOne - truth, 2);
        error_without += std::pow(blended / kOne - truth, 2);
      }
    }
  }
  EXPECT_GT(views, 100);
  EXPECT_LT(std::sqrt(error_with), 0.2 * std::sqrt(error_without));
}

TEST_F(PartlyHidden, TakesNoPartInTheGainsOfPhotographs) {
  const auto file = test::TestFolder("hidden_gains") / "light_field.lfs";
  ResampleOptions without = Share(0), with = Share(0.85);
  without.photo_gains = with.photo_gains = PhotoGainUse::kOn;
  EXPECT_EQ(Run(with, file).photo_gains, Run(without, file).photo_gains);
}

// Of a triangle that the frame cuts, or a mask, the rest is estimated; what the mask forbids is
// magenta here.
TEST_F(PartlyHidden, EstimatesWhatLiesOutsideTheFrameOrTheMask) {
  auto made = *made_;
  Image mask(320, 240, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) mask.At<uint8_t>(x, y) = x < 163 ? 255 : 0;
  }
  Image& picture = made.pictures.at("photo5.png");
  for (int y = 0; y < 240; ++y) {
    for (int x = 163; x < 320; ++x) {
      picture.At<uint8_t>(x, y, 0) = picture.At<uint8_t>(x, y, 2) = 255;
    }
  }
  made.pictures["mask.png"] = mask;
  made.capture.photos[5].mask = "mask.png";
  // Another photograph looks past the object, which its frame cuts.
  Pose& aside = made.calib.photos[7].camera_from_world;
  aside = LookAt(aside.Center(), {40, 30, 0}, {0, 0, 1});
  made.pictures["photo7.png"] = test::RenderPhoto(
      surface_, made.calib.cameras["camera"], aside,
      [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        return p.norm() > kRadius + 1 ? Eigen::Vector3d(1, 0, 1)
                                      : Eigen::Vector3d(0, Green(p, 7), 0);
      },
      {0, 0, 0}, 3);
  const auto file = test::TestFolder("hidden_mask") / "light_field.lfs";
  Resample(made.capture, made.calib, surface_, mesh_, made.Loader(), Share(0.85), file,
           SilentProgress());
  const LightField field = LightField::Open(file);
  int outside[2] = {0, 0};
  for (int t = 0; t < kObjectTriangles; ++t) {
    const TrianglePatch patch = field.Patch(t);
    for (size_t i = 0; i < patch.values.size(); ++i) {
      if (i / patch.photos.size() % 3 == 1) continue;
      ASSERT_LT(double(patch.values[i]) / LightField::kOne, 0.002) << "triangle " << t;
    }
    for (const uint16_t photo : patch.photos) {
      if (photo != 5 && photo != 7) continue;
      for (const Eigen::Vector3d& point : Points(field, t)) {
        const auto pixel = Project(made.calib.cameras["camera"],
                                   made.calib.photos[photo].camera_from_world * point);
        const double right = photo == 5 ? 162 : 319;
        const bool inside =
            pixel && pixel->x() >= 0 && pixel->x() <= right && pixel->y() >= 0 && pixel->y() <= 239;
        outside[photo == 7 ? 1 : 0] += inside ? 0 : 1;
      }
    }
  }
  EXPECT_GT(outside[0], 20);
  EXPECT_GT(outside[1], 20);
}

}  // namespace
}  // namespace lfm
