// SPDX-License-Identifier: BSD-3-Clause
// relight_samples OUT: models for relighting of every form, and what they show under light, as
// relight_browser_test.mjs wants them; in OUT/pages what the program writes for browsers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/image.h"
#include "fields/light_sampling.h"
#include "fields/relightable_file.h"
#include "fields/relighting.h"
#include "tests/fields/random_relightable.h"
#include "viewer/relight_page.h"

namespace lfm {
namespace {

constexpr int kWidth = 64, kHeight = 48;

RelightableModel Random(RandomRelightableShape shape) {
  shape.width = kWidth;
  shape.height = kHeight;
  return RandomRelightable(shape);
}

// Pairs of directions: their sum and their difference, both orthonormal.
RelightableModel WithPairs(RelightableModel r) {
  ColumnBasis& basis = r.column_basis;
  basis.first = {0};
  for (int j = 0; j < r.model.columns; ++j) {
    const auto pair = static_cast<uint32_t>(j / 2 * 2);
    basis.direction.insert(basis.direction.end(), {pair, pair + 1});
    basis.value.insert(basis.value.end(), {std::sqrt(0.5f), (j % 2 ? -1 : 1) * std::sqrt(0.5f)});
    basis.first.push_back(static_cast<int64_t>(basis.value.size()));
  }
  return r;
}

RelightableModel Scaled(RelightableModel r, float scale) {
  for (float& weight : r.model.weights) weight *= scale;
  for (float& value : r.model.residual_value) value *= scale;
  return r;
}

RelightableModel WithoutResidual(RelightableModel r) {
  r.model.first_residual.clear();
  r.model.residual_column.clear();
  r.model.residual_value.clear();
  return r;
}

RelightableModel OfCube(int n) {
  RandomRelightableShape shape;
  shape.columns = 6 * n * n;
  RelightableModel r = Random(shape);
  r.kind = FieldColumns::kCubeTexels;
  for (int i = 0; i < shape.columns; ++i) {
    const int face = i / (n * n), axis = face / 2;
    Eigen::Vector3d& direction = r.directions[i];
    direction[axis] = face % 2 ? -1 : 1;
    direction[(axis + 1) % 3] = (2 * (i % n) + 1.0) / n - 1;
    direction[(axis + 2) % 3] = (2 * (i / n % n) + 1.0) / n - 1;
    direction.normalize();
  }
  return r;
}

std::map<std::string, RelightableModel> Models() {
  RandomRelightableShape gray, wide, many;
  gray.channels = 1;
  wide.columns = 300;
  wide.clusters = 300;
  wide.most_terms = 9;
  many.columns = 2000;
  many.most_residuals = 300;
  many.channels = 1;
  return {{"color", Random({})},
          {"gray", Random(gray)},
          {"wide", Random(wide)},
          {"many_residuals", Random(many)},
          {"pairs", WithPairs(Random({}))},
          {"cube", OfCube(4)},
          {"faint", Scaled(Random({}), 1e-25f)},
          {"bright", Scaled(Random({}), 1e25f)},
          {"no_residual", WithoutResidual(Random({}))}};
}

struct Shot {
  const char* name;
  int residuals;  // -1: all
  double lit;     // share of the directions
};

LightVector RandomLight(const RelightableModel& r, double lit, std::mt19937& random) {
  LightVector light = MakeLightVector(static_cast<int>(r.directions.size()), r.channels);
  const auto share = [&random] { return static_cast<double>(random() % 1000) / 1000; };
  for (int i = 0; i < light.directions; ++i) {
    if (share() >= lit) continue;
    for (int c = 0; c < light.channels; ++c) light.Channel(c)[i] = static_cast<float>(share());
  }
  return light;
}

/// What is to be seen as STEM.png; what a picture's 95th of 100 values is to be multiplied with to
/// be 0.8 is returned.
double WritePicture(const RelightableModel& r, const LightVector& light, int residuals,
                    const std::filesystem::path& stem) {
  const Relighter relighter(r);
  Image image = relighter.RelightPicture(relighter.Prepare(light), residuals);
  auto* values = image.Data<float>();
  std::vector<float> sorted(values, values + image.size());
  std::sort(sorted.begin(), sorted.end());
  const double gain = 0.8 / std::max(1e-30, double{sorted[sorted.size() * 95 / 100]});
  for (size_t i = 0; i < image.size(); ++i) values[i] = static_cast<float>(values[i] * gain);
  WriteImage(ToRgb8(image), stem.string() + ".png");
  return gain;
}

/// OUT/NAME,SHOT.json says how the model is lit, OUT/NAME,SHOT.png is what there is to be seen.
void WriteShot(const RelightableModel& r, const std::filesystem::path& stem, const Shot& shot) {
  std::mt19937 random(7);
  const LightVector light = RandomLight(r, shot.lit, random);
  nlohmann::json json = {{"gain", WritePicture(r, light, shot.residuals, stem)},
                         {"residuals", shot.residuals < 0 ? 65535 : shot.residuals}};
  for (int c = 0; c < light.channels; ++c) {
    json["light"].push_back(
        std::vector<float>(light.Channel(c), light.Channel(c) + light.directions));
  }
  WriteFileAtomically(stem.string() + ".json", json.dump());
}

// Soft light of two colours from two sides, and a dim floor.
Image MakeSurroundings() {
  Image image(256, 128, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Eigen::Vector3d d =
          ProbeDirection((x + 0.5) / image.width(), (y + 0.5) / image.height());
      const double warm = std::pow(std::max(0.0, d.dot(Eigen::Vector3d(0.6, 0, 0.8))), 6);
      const double cold = std::pow(std::max(0.0, d.dot(Eigen::Vector3d(0, -0.8, 0.6))), 3);
      const double floor = d.z() < 0 ? 0.05 : 0.1;
      image.At<float>(x, y, 0) = static_cast<float>(floor + 4 * warm);
      image.At<float>(x, y, 1) = static_cast<float>(floor + 2 * warm + cold);
      image.At<float>(x, y, 2) = static_cast<float>(floor + 2 * cold);
    }
  }
  return image;
}

/// The pages of a model that is seen from the side, z up, the viewer at negative y; one light and
/// surroundings as fields/light_sampling.h has them.
void WritePages(const std::filesystem::path& folder) {
  RandomRelightableShape shape;
  shape.columns = 200;
  const RelightableModel r = AsStored(Random(shape));
  Eigen::Matrix3d camera_from_world;
  camera_from_world << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  WriteRelightPages(EncodeRelightable(r), "A <sample>", folder, camera_from_world);
  const LightCells cells = MakeLightCells(r.kind, r.directions);
  const LightVector light = SampleDirection(cells, TriangulateLights(r.directions), {0.3, -0.4, 1});
  WriteImage(MakeSurroundings(), folder / "surroundings.hdr");
  const LightProbe probe = ReadLightProbe(folder / "surroundings.hdr");
  const nlohmann::json json = {
      {"light", WritePicture(r, WithChannels(light, 3), -1, folder / "light")},
      {"surroundings",
       WritePicture(r, SampleProbe(cells, probe, 40), -1, folder / "surroundings")}};
  WriteFileAtomically(folder / "gains.json", json.dump());
}

void WriteSamples(const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);  // every file in it is tested
  for (const auto& [name, model] : Models()) {
    WriteRelightable(model, folder / (name + ".lfr"));
    for (const Shot& shot :
         {Shot{"all", -1, 1}, Shot{"few lights", 2, 0.2}, Shot{"no residual", 0, 1}}) {
      WriteShot(AsStored(model), folder / (name + "," + shot.name), shot);
    }
  }
  RelightableModel vertices = Random({});
  vertices.width = vertices.height = 0;
  WriteRelightable(vertices, folder / "other" / "vertices.lfr");
  RelightableModel views = Random({});
  views.kind = FieldColumns::kViews;
  WriteRelightable(views, folder / "other" / "views.lfr");
  WritePages(folder / "pages");
}

}  // namespace
}  // namespace lfm

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    lfm::WriteSamples(argv[1]);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
