// SPDX-License-Identifier: BSD-3-Clause
// What an AFX file means, step by step from its text and its pictures as Smirnov's Section 2 says,
// against what our reader makes of it. Shares the parser with the reader and nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/error.h"
#include "core/image.h"
#include "encode/afx.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "encode/vrml_scene.h"
#include "tests/encode/afx_light_maps.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

using vrml::Node;

class AfxMeaning {
 public:
  explicit AfxMeaning(const AfxFiles& files)
      : files_(files), scene_(vrml::ParseScene(files.wrl, "model.wrl")) {
    const Node& shape = OfType("Shape");
    appearance_ = &At(shape, "appearance");
    for (const int tile : appearance_->Find("tileList")->nodes) {
      const std::string& url = scene_.nodes[tile].Find("url")->strings.front();
      for (const AfxFiles::Picture& picture : files_.pictures) {
        if (picture.name != url) continue;
        tiles_.push_back(DecodeImage(picture.png.data(), picture.png.size(), url));
      }
    }
  }

  Eigen::Vector3d Color(int triangle, const Eigen::Vector3d& weights,
                        const Eigen::Vector3d& to_eye) const {
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    for (const int map : appearance_->Find("lightMapList")->nodes) {
      const Node& light_map = scene_.nodes[map];
      const Node& surfaces = At(light_map, "surfaceMapList");
      const auto& entries = surfaces.Find("triangleIndex")->numbers;
      const auto& corners = At(surfaces, "triangleCoordinate").Find("point")->numbers;
      for (size_t e = 0; e < entries.size(); ++e) {
        if (entries[e] != triangle) continue;
        Eigen::Vector2d at(0, 0);
        for (int c = 0; c < 3; ++c) {
          at += weights[c] * Eigen::Vector2d(corners[6 * e + 2 * c], corners[6 * e + 2 * c + 1]);
        }
        const auto tile = static_cast<int>(surfaces.Find("tileIndex")->numbers[e]);
        const auto view = static_cast<int>(surfaces.Find("viewMapIndex")->numbers[e]);
        const Eigen::Vector3d surface = Range(light_map, Texture(tile, at));
        color += view < 0 ? surface
                          : surface.cwiseProduct(Range(light_map, View(light_map, view, to_eye)));
      }
    }
    return color.cwiseMax(0).cwiseMin(1);
  }

 private:
  const Node& OfType(const std::string& type) const {
    for (const Node& node : scene_.nodes) {
      if (node.type == type) return node;
    }
    throw Error("no " + type);
  }
  const Node& At(const Node& node, const char* field) const {
    return scene_.nodes[node.Find(field)->nodes.at(0)];
  }
  Eigen::Vector3d View(const Node& light_map, int view, const Eigen::Vector3d& to_eye) const {
    const Node& views = At(light_map, "viewMapList");
    const auto vertex = static_cast<size_t>(views.Find("vertexIndex")->numbers[view]);
    const auto& axes = At(*appearance_, "vertexFrameList").Find("frame")->numbers;
    const Eigen::Vector3d x(&axes[9 * vertex]), y(&axes[9 * vertex + 3]), z(&axes[9 * vertex + 6]);
    EXPECT_GT(to_eye.dot(z), 0);
    const Eigen::Vector2d map((to_eye.dot(x) + 1) / 2, (to_eye.dot(y) + 1) / 2);
    const Eigen::Vector2d origin(&At(views, "textureOrigin").Find("point")->numbers[2 * view]);
    const Eigen::Vector2d size(&At(views, "textureSize").Find("point")->numbers[2 * view]);
    return Texture(static_cast<int>(views.Find("tileIndex")->numbers[view]),
                   origin + map.cwiseProduct(size));
  }
  static Eigen::Vector3d Range(const Node& light_map, const Eigen::Vector3d& color) {
    const auto* scale = light_map.Find("scaleRGB");
    if (scale == nullptr) return color;
    return color.cwiseProduct(Eigen::Vector3d(scale->numbers.data())) +
           Eigen::Vector3d(light_map.Find("biasRGB")->numbers.data());
  }
  // Bilinear, (0, 0) at the lower left corner of the picture, as VRML97 has textures.
  Eigen::Vector3d Texture(int tile, const Eigen::Vector2d& at) const {
    const Image& image = tiles_[tile];
    const double x = at.x() * image.width() - 0.5, y = (1 - at.y()) * image.height() - 0.5;
    Eigen::Vector3d sum(0, 0, 0);
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx) {
        const double i = std::floor(x) + dx, j = std::floor(y) + dy;
        const double weight = (1 - std::abs(x - i)) * (1 - std::abs(y - j));
        const int column = std::clamp(static_cast<int>(i), 0, image.width() - 1);
        const int row = std::clamp(static_cast<int>(j), 0, image.height() - 1);
        for (int c = 0; c < 3; ++c) {
          sum[c] +=
              weight / 255 * image.At<uint8_t>(column, row, std::min(c, image.channels() - 1));
        }
      }
    }
    return sum;
  }

  const AfxFiles& files_;
  vrml::Scene scene_;
  const Node* appearance_ = nullptr;
  std::vector<Image> tiles_;
};

TEST(AfxMeaning, IsWhatThePaperSays) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 60, [](int t) { return t % 2 == 0 ? 5 : 9; }, GlossyAppearance);
  const LightFieldModel one_light_map =
      AfxForm(Encode(field.Source(), {.terms = 2, .transport_db = 0}, SilentProgress()).model, {});
  for (const LightFieldModel& form : {one_light_map, WithThreeLightMaps(one_light_map)}) {
    const AfxFiles files = WriteAfxForm(form);
    const AfxMeaning meaning(files);
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(0, 1), small(-0.3, 0.3);
    for (int s = 0; s < 300; ++s) {
      const int t = static_cast<int>(random() % form.placements.size());
      Eigen::Vector3d weights(unit(random), unit(random), unit(random));
      weights /= weights.sum();
      const Eigen::Vector3d tilt(small(random), small(random), small(random));
      const Eigen::Vector3d to_eye = (TriangleNormal(form.mesh, t) + tilt).normalized();
      // Texture coordinates are float32; codes of completions may be clamped.
      constexpr double kTolerance_abs = 0.3 / 255;
      EXPECT_LT((EvaluateModel(form, t, weights, to_eye).cast<double>() -
                 meaning.Color(t, weights, to_eye))
                    .cwiseAbs()
                    .maxCoeff(),
                kTolerance_abs)
          << "triangle " << t;
    }
  }
}

}  // namespace
}  // namespace lfm::testing
