// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/field_studio.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "sample_data/scene_file.h"
#include "sample_data/studio.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

constexpr float kAlbedo = 0.5f;

// A floor seen from above, nothing else.
SceneDescription Floor(SceneKind kind) {
  SceneDescription scene;
  scene.name = "floor";
  scene.kind = kind;
  scene.bounces = 0;
  scene.cube_resolution = 8;
  scene.light_count = 16;
  scene.view = {6, 4, 10, {0, -100, 400}, {0, 0, 0}};
  SceneObject floor;
  floor.name = "floor";
  floor.mesh.vertices = {{-500, -500, 0}, {500, -500, 0}, {500, 500, 0}, {-500, 500, 0}};
  floor.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.mesh.normals.assign(4, Eigen::Vector3d::UnitZ());
  floor.material.diffuse = Eigen::Vector3f::Constant(kAlbedo);
  scene.objects.push_back(floor);
  return scene;
}

TEST(FieldStudio, RowsOfALambertianFloorSumToItsAlbedo) {
  const ScratchFolder scratch;
  for (const SceneKind kind : {SceneKind::kTransportImage, SceneKind::kTransportMesh}) {
    const StageReport report =
        MakeFieldCapture(Floor(kind), StudioOptions(), scratch.folder, SilentProgress());
    EXPECT_GT(report.rays.shadow, 0);
    EXPECT_TRUE(std::filesystem::exists(scratch.folder / "ground_truth/studio.json"));
    // Direct light has no random numbers.
    ASSERT_TRUE(report.noise);
    EXPECT_GT(report.noise->values, 0);
    EXPECT_GT(report.noise->ValueRms(), 0);
    EXPECT_LT(report.noise->MonteCarloRms(), 1e-3 * report.noise->ValueRms());
    const Capture capture = LoadCapture(scratch.folder);
    ASSERT_TRUE(capture.transport);
    const TransportMatrix matrix(scratch.folder / capture.transport->file);
    const bool image = kind == SceneKind::kTransportImage;
    EXPECT_EQ(matrix.shape().points, image ? 24 : 4);
    EXPECT_EQ(matrix.shape().cube_resolution, 8);
    const std::vector<float> values = matrix.ReadRows(0, matrix.shape().rows());
    for (int64_t r = 0; r < matrix.shape().rows(); ++r) {
      double sum = 0, below = 0;
      for (int64_t t = 0; t < matrix.shape().columns(); ++t) {
        const float value = values[static_cast<size_t>(r * matrix.shape().row_values() + t)];
        sum += value;
        if (t >= matrix.shape().columns() * 5 / 6) below += value;  // the face of -z
      }
      EXPECT_NEAR(sum, kAlbedo, 0.01) << r;
      EXPECT_EQ(below, 0) << r;
    }
    const Image preview = ReadImage(scratch.folder / "preview.png");
    EXPECT_EQ(preview.width(), FixedCamera(Floor(kind).view).width);
  }
}

TEST(FieldStudio, PicturesShowAlbedoTimesCosine) {
  const ScratchFolder scratch;
  StudioOptions options;
  options.trouble.photo.format = PhotoFormat::kExr;
  options.trouble.sensor.full_well_electrons = 1e12;
  options.trouble.sensor.read_noise_electrons = 0;
  MakeFieldCapture(Floor(SceneKind::kReflectanceField), options, scratch.folder, SilentProgress());
  const Capture capture = LoadCapture(scratch.folder);
  ASSERT_TRUE(capture.reflectance_field);
  const ReflectanceField& field = *capture.reflectance_field;
  ASSERT_EQ(field.pictures.size(), 16u);
  EXPECT_EQ(std::count_if(field.pictures.begin(), field.pictures.end(),
                          [](const LitPicture& p) { return p.split == PhotoSplit::kTest; }),
            2);
  for (const LitPicture& picture : field.pictures) {
    const Image image = ReadImage(scratch.folder / picture.file);
    EXPECT_GT(picture.to_light.z(), 0);
    EXPECT_NEAR(image.At<float>(3, 2), 0.8 * kAlbedo * picture.to_light.z(), 2e-4);
  }
  EXPECT_TRUE(std::filesystem::exists(scratch.folder / "ground_truth/exports/rti/lights.lp"));
  EXPECT_EQ(ReadPlyMesh(scratch.folder / "ground_truth/mesh.ply").triangles.size(), 2u);
}

TEST(FieldStudio, ThreadsDoNotChangeTheBytes) {
  const SceneDescription scene = ShrinkField(FindScene("concave", SceneDetail::kTiny));
  std::string first;
  for (const int threads : {1, 3}) {
    const ScratchFolder scratch;
    SetThreadCount(threads);
    MakeFieldCapture(scene, StudioOptions(), scratch.folder, SilentProgress());
    const std::string bytes = ReadFile(scratch.folder / "transport.ltm", size_t{1} << 26);
    if (threads == 1) {
      first = bytes;
    } else {
      EXPECT_TRUE(bytes == first);
    }
  }
  SetThreadCount(0);
}

TEST(FieldStudio, LightsAndEyesAreSpreadEvenly) {
  const auto lights = LightStageDirections(253);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& l : lights) {
    EXPECT_NEAR(l.norm(), 1, 1e-6);
    EXPECT_GT(l.z(), 0);
    sum += l;
  }
  EXPECT_LT((sum / 253 - Eigen::Vector3f(0, 0, 0.5f)).norm(), 0.01);
  EXPECT_THROW(LightStageDirections(0), Error);
  const FixedView view{10, 10, 30, {0, -300, 50}, {0, 0, 50}};
  const auto eyes = ViewSphere(view, 64);
  EXPECT_EQ(eyes.front(), view.eye);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& eye : eyes) {
    EXPECT_NEAR((eye - view.target).norm(), 300, 1e-9);
    center += eye / 64;
  }
  EXPECT_LT((center - view.target).norm(), 10);
}

TEST(FieldStudio, RefusesViewsThatShowNothing) {
  FixedView view;
  view.eye = view.target;
  EXPECT_THROW(FixedPose(view), Error);
  EXPECT_THROW(ViewSphere(view, 2), Error);
  view = FixedView();
  view.fov_deg = 180;
  EXPECT_THROW(FixedCamera(view), Error);
  view = FixedView();
  view.width = 0;
  EXPECT_THROW(FixedCamera(view), Error);
  const ScratchFolder scratch;
  EXPECT_THROW(MakeFieldCapture(Floor(SceneKind::kLightField), StudioOptions(), scratch.folder,
                                SilentProgress()),
               Error);
}

// Every built-in scene, small, through the whole studio.
class RecordedScene : public testing::TestWithParam<std::string> {};

TEST_P(RecordedScene, MakesACaptureThatLoads) {
  const ScratchFolder scratch;
  StudioOptions options;
  options.scene = GetParam();
  options.tiny = true;
  options.quality = RenderQuality::kDraft;
  options.photos = 1;
  options.test_photos = 1;
  options.photo_width = 120;
  options.photo_height = 90;
  options.scans = 0;
  options.placements = 1;
  MakeCapture(options, scratch.folder, SilentProgress());
  const Capture capture = LoadCapture(scratch.folder);
  std::string picture;
  if (!capture.photos.empty()) {
    picture = "ground_truth/" + LoadCapture(scratch.folder / "ground_truth").photos[0].file;
  } else if (capture.reflectance_field) {
    picture = capture.reflectance_field->pictures.front().file;
  } else if (capture.transport->kind == TransportKind::kImage) {
    picture = "preview.png";
  } else {
    EXPECT_EQ(ReadPlyMesh(scratch.folder / capture.transport->mesh).vertices.size(),
              static_cast<size_t>(
                  TransportMatrix(scratch.folder / capture.transport->file).shape().points));
    return;
  }
  const Image image = ReadImage(scratch.folder / picture);
  int64_t sum = 0, black = 0;
  for (size_t i = 0; i < image.size(); ++i) {
    sum += image.Data<uint8_t>()[i];
    black += image.Data<uint8_t>()[i] == 0;
  }
  EXPECT_GT(sum / static_cast<int64_t>(image.size()), 10) << "a dark picture";
  EXPECT_LT(black, static_cast<int64_t>(image.size()) * 9 / 10) << "a black picture";
}

INSTANTIATE_TEST_SUITE_P(Scenes, RecordedScene, testing::ValuesIn(SceneNames()),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace lfm
