// SPDX-License-Identifier: BSD-3-Clause
#include "encode/reflection_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr int kViews = 60;

Eigen::Vector3d Light(const Eigen::Vector3d& r) {
  const double lobe = std::exp(6 * (r.dot(Eigen::Vector3d(0.6, 0, 0.8)) - 1));
  return lobe * Eigen::Vector3d(0.5, 0.4, 0.3);
}

// Shows lights from where the mirror direction points, more of them on one side than on the other.
Eigen::Vector3d Mirroring(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) {
  const Eigen::Vector3d normal = p.normalized();
  return Eigen::Vector3d(0.2, 0.25, 0.3) +
         (1 + 0.5 * normal.x()) * Light(2 * normal.dot(to_eye) * normal - to_eye);
}

Eigen::Vector3d Diffuse(const Eigen::Vector3d& p, const Eigen::Vector3d&) {
  return Eigen::Vector3d(0.4, 0.4, 0.4) + 0.004 * p;
}

struct Scene {
  SyntheticLightField field;
  LightFieldSource source;

  explicit Scene(const Appearance& appearance, double distance_mm = 1e6)
      : field(MakeLightField(
            MakeSphere(3), 10, kViews, [](int) { return 4; }, appearance)),
        source(field.Source()) {
    for (const Eigen::Vector3d& d : SpreadDirections(kViews)) {
      source.eyes.push_back(distance_mm * d);
    }
  }
};

// RMS of blended views against what the surface shows, over the means of patches.
double BlendError(const Scene& scene, const LightFieldSource& source,
                  const Appearance& appearance) {
  double squared = 0;
  int64_t count = 0;
  LightField::WeightBuffer buffer;
  for (int t = 0; t < static_cast<int>(source.mesh.triangles.size()); ++t) {
    const TrianglePatch patch = source.patch(t);
    const int samples = PatchSampleCount(patch.edge_samples);
    for (int corner = 0; corner < 3; ++corner) {
      const ViewWeights weights = source.weights(t, corner, buffer);
      const std::vector<float> change =
          source.change ? source.change(t, corner, weights) : std::vector<float>(900, 0.f);
      const int vertex = source.mesh.triangles[t][corner];
      for (int q = 0; q < 100; ++q) {
        const Eigen::Vector3d to_eye =
            source.vertex_frames[vertex] * GridDirection(source.direction_map, 10, q);
        if (to_eye.dot(TriangleNormal(source.mesh, t)) < 0.3) continue;
        for (int c = 0; c < 3; ++c) {
          double blended = 0, truth = 0;
          for (int at = 0; at < 3; ++at) blended += change[(3 * at + c) * 100 + q] / 3;
          for (int j = 0; j < 4; ++j) {
            for (int i = 0; i + j < 4; ++i) {
              const Eigen::Vector3d w = PatchSampleWeights(4, i, j);
              Eigen::Vector3d p = Eigen::Vector3d::Zero();
              for (int k = 0; k < 3; ++k) {
                p += w[k] * source.mesh.vertices[source.mesh.triangles[t][k]];
              }
              truth += appearance(p, to_eye)[c] / samples;
              blended +=
                  ResampledValue(scene.field, t, corner, PatchSampleIndex(4, i, j), c, q) / samples;
            }
          }
          squared += (blended - truth) * (blended - truth);
          ++count;
        }
      }
    }
  }
  return std::sqrt(squared / static_cast<double>(count));
}

TEST(ReflectionModel, KnowsTheLightBetweenThePhotographs) {
  const Scene scene(Mirroring);
  const LightFieldSource filled = WithReflections(scene.source, FitReflections(scene.source));
  const double blended = BlendError(scene, scene.source, Mirroring);
  EXPECT_GT(blended, 0.01);
  EXPECT_LT(BlendError(scene, filled, Mirroring), 0.6 * blended);
}

// Rough and yellow on one side, polished and blue on the other.
Eigen::Vector3d OfTwoKinds(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) {
  const Eigen::Vector3d normal = p.normalized();
  const double cosine =
      (2 * normal.dot(to_eye) * normal - to_eye).dot(Eigen::Vector3d(0.6, 0, 0.8));
  return normal.y() > 0
             ? Eigen::Vector3d(0.2 * Eigen::Vector3d::Ones() +
                               std::exp(12 * (cosine - 1)) * Eigen::Vector3d(0.2, 0.4, 0.7))
             : Eigen::Vector3d(0.2 * Eigen::Vector3d::Ones() +
                               std::exp(2 * (cosine - 1)) * Eigen::Vector3d(0.5, 0.4, 0.1));
}

TEST(ReflectionModel, SeveralLightsServeSurfacesOfSeveralKinds) {
  const Scene scene(OfTwoKinds);
  const auto error = [&](int lights) {
    return BlendError(scene, WithReflections(scene.source, FitReflections(scene.source, lights)),
                      OfTwoKinds);
  };
  const double one = error(1);
  EXPECT_LT(error(2), 0.9 * one);
  EXPECT_LT(error(3), 0.9 * one);
}

// Between the corners of a triangle the light is that of the normal between theirs: what is
// predicted follows the curved surface, not the flat triangle.
TEST(ReflectionModel, CornersSeeTheirOwnMirrorDirections) {
  const Scene scene(Mirroring);
  const LightFieldSource filled = WithReflections(scene.source, FitReflections(scene.source));
  LightField::WeightBuffer buffer;
  double largest = 0;
  for (int t = 0; t < static_cast<int>(scene.source.mesh.triangles.size()); t += 11) {
    const std::vector<float> change = filled.change(t, 0, scene.source.weights(t, 0, buffer));
    ASSERT_EQ(change.size(), 900u);
    for (int i = 0; i < 300; ++i) {
      largest = std::max<double>(largest, std::abs(change[i] - change[300 + i]));
    }
  }
  EXPECT_GT(largest, 0.005);
}

TEST(ReflectionModel, RefusesNumbersOfLights) {
  const Scene scene(Mirroring);
  EXPECT_THROW(FitReflections(scene.source, 0), Error);
  EXPECT_THROW(FitReflections(scene.source, 5), Error);
}

TEST(ReflectionModel, EyesWithoutADirectionAreNoTrouble) {
  const Scene scene(Mirroring);
  LightFieldSource source = scene.source;
  source.eyes[0] = Eigen::Vector3d::Constant(1e300);
  source.eyes[1] = source.mesh.vertices[0];
  source.eyes[2] = Eigen::Vector3d::Constant(-1e160);
  const ReflectionModel model = FitReflections(source);
  for (const float gain : model.gain) EXPECT_TRUE(std::isfinite(gain));
  EXPECT_TRUE(LookUp(model.lights[0], model.side, Eigen::Vector3d::Zero()).allFinite());
}

TEST(ReflectionModel, FindsTheBrightestDirectionAndWhoShowsMore) {
  const Scene scene(Mirroring);
  const ReflectionModel model = FitReflections(scene.source, 1);
  const auto red = [&](const Eigen::Vector3d& d) {
    return LookUp(model.lights[0], model.side, d)[0];
  };
  EXPECT_GT(red({0.6, 0, 0.8}), 3 * std::abs(red({-0.6, 0, 0.8})));
  double front = 0, back = 0;
  for (size_t t = 0; t < model.gain.size(); ++t) {
    const double x = TriangleNormal(scene.source.mesh, static_cast<int>(t)).x();
    const double z = TriangleNormal(scene.source.mesh, static_cast<int>(t)).z();
    if (z > 0.5 && x > 0.3) front += model.gain[t];
    if (z > 0.5 && x < -0.3) back += model.gain[t];
  }
  EXPECT_GT(front, 1.1 * back);
}

// Exactly a photograph's direction: it is shown as it is.
TEST(ReflectionModel, LeavesThePhotographsAlone) {
  const Scene scene(Mirroring);
  const LightFieldSource filled = WithReflections(scene.source, FitReflections(scene.source));
  const int triangle = 40, corner = 1, q = 44;
  const int vertex = scene.source.mesh.triangles[triangle][corner];
  Scene moved(Mirroring);  // one photograph is taken from a direction of the grid
  const TrianglePatch patch = scene.source.patch(triangle);
  const Eigen::Vector3d to_eye =
      scene.source.vertex_frames[vertex] * GridDirection(scene.source.direction_map, 10, q);
  moved.source.eyes[patch.photos[0]] = 1e9 * to_eye;
  std::vector<uint16_t> view(300, 0);
  std::vector<float> weight(300, 0.f);
  for (int i = 0; i < 100; ++i) weight[3 * i] = 1;
  const std::vector<uint8_t> seen(100, 1);
  const std::vector<float> change = WithReflections(moved.source, FitReflections(scene.source))
                                        .change(triangle, corner, {view, weight, seen});
  double largest = 0;
  for (int c = 0; c < 9; ++c) {
    EXPECT_NEAR(change[c * 100 + q], 0, 1e-5);
    for (int i = 0; i < 100; ++i)
      largest = std::max<double>(largest, std::abs(change[c * 100 + i]));
  }
  EXPECT_GT(largest, 0.02);
}

TEST(ReflectionModel, FindsNothingInDiffuseSurfaces) {
  const Scene scene(Diffuse);
  const LightFieldSource filled = WithReflections(scene.source, FitReflections(scene.source));
  LightField::WeightBuffer buffer;
  for (int t = 0; t < static_cast<int>(scene.source.mesh.triangles.size()); t += 7) {
    for (const float value : filled.change(t, 0, scene.source.weights(t, 0, buffer))) {
      ASSERT_NEAR(value, 0, 1e-3);
    }
  }
}

// RMS of what a model shows at the middles of its triangles.
double ShownError(const LightFieldModel& model) {
  double squared = 0;
  int count = 0;
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) p += model.mesh.vertices[model.mesh.triangles[t][c]] / 3;
    for (const Eigen::Vector3d& tilt :
         {Eigen::Vector3d(0.5, 0.2, 0), Eigen::Vector3d(-0.1, 0.6, 0.4),
          Eigen::Vector3d(0.2, -0.5, 0.6), Eigen::Vector3d(-0.5, -0.1, -0.3)}) {
      const Eigen::Vector3d to_eye = (TriangleNormal(model.mesh, t) + tilt).normalized();
      const Eigen::Vector3f shown =
          EvaluateModel(model, t, Eigen::Vector3d::Constant(1.0 / 3), to_eye);
      squared += (shown.cast<double>() - Mirroring(p, to_eye)).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(squared / count);
}

TEST(ReflectionModel, ModelsShowDirectionsBetweenPhotographsBetter) {
  const Scene scene(Mirroring);
  EncodeOptions options;
  options.terms = 6;
  options.transport_db = 0;
  options.fill = DirectionFill::kBlend;
  const double blend = ShownError(Encode(scene.source, options, SilentProgress()).model);
  options.fill = DirectionFill::kMirror;
  const double mirror = ShownError(Encode(scene.source, options, SilentProgress()).model);
  EXPECT_LT(mirror, 0.8 * blend);
}

TEST(ReflectionModel, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene(Mirroring);
  SetThreadCount(1);
  const ReflectionModel one = FitReflections(scene.source);
  SetThreadCount(3);
  const ReflectionModel three = FitReflections(scene.source);
  SetThreadCount(0);
  EXPECT_EQ(one.gain, three.gain);
  EXPECT_EQ(one.lights, three.lights);
}

TEST(ReflectionModel, FindsWherePhotographsWereTaken) {
  CalibResult calib;
  for (const char* id : {"a", "b"}) {
    PosedImage& photo = calib.photos.emplace_back();
    photo.id = id;
    photo.camera_from_world.translation = {0, 0, id[0] == 'a' ? -1.0 : -2.0};
  }
  const std::vector<Eigen::Vector3d> eyes = EyesOfPhotos(calib, {"b", "a"}, "a.lfs");
  ASSERT_EQ(eyes.size(), 2u);
  EXPECT_EQ(eyes[0], Eigen::Vector3d(0, 0, 2));
  EXPECT_EQ(eyes[1], Eigen::Vector3d(0, 0, 1));
  EXPECT_THROW(EyesOfPhotos(calib, {"c"}, "a.lfs"), Error);
}

TEST(ReflectionModel, TakesExtremes) {
  const Appearance black = [](const Eigen::Vector3d&, const Eigen::Vector3d&) {
    return Eigen::Vector3d(0, 0, 0);
  };
  Scene scene(black);
  scene.field.triangles[3].photos.clear();  // nobody sees it
  scene.field.triangles[3].values.clear();
  scene.field.triangles[3].weights = {};
  const ReflectionModel model = FitReflections(scene.source);
  for (const float gain : model.gain) ASSERT_EQ(gain, 0);
  scene.source.eyes.pop_back();
  EXPECT_THROW(FitReflections(scene.source), Error);
}

}  // namespace
}  // namespace lfm::testing
