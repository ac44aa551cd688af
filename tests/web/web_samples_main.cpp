// SPDX-License-Identifier: BSD-3-Clause
// web_samples OUT: models of every form, and what the reference renderer shows of each, named as
// browser_test.mjs wants them; in OUT/scene the pages of a scene, and what is to be seen of it.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"
#include "encode/glb.h"
#include "tests/viewer/compressed_models.h"
#include "tests/viewer/synthetic_model.h"
#include "viewer/reference_renderer.h"
#include "viewer/scene.h"
#include "viewer/view_options.h"
#include "viewer/web_page.h"

namespace lfm {
namespace {

LightFieldModel WithTerms(LightFieldModel model, int terms) {
  const size_t ranges = model.mesh.vertices.size() * terms;
  model.terms = terms;
  model.surface_pages.resize(terms);
  model.view_pages.resize(terms);
  model.surface_ranges.resize(ranges);
  model.view_ranges.resize(ranges);
  for (int& own : model.vertex_terms) own = std::min(own, terms);
  model.view_slots = RankByTerms(model.vertex_terms);
  return model;
}

std::map<std::string, LightFieldModel> Models() {
  const auto smooth = [](uint32_t seed, DirectionMap map) {
    return MakeSmoothRandomModel(seed, map);
  };
  const DirectionMap map = DirectionMap::kHemiOctahedral;
  LightFieldModel nonnegative = smooth(7, map);
  nonnegative.mean_in_terms = true;
  return {{"default", Coarser(smooth(1, map))},
          {"one_layout", smooth(2, map)},
          {"codebooks", Sharing(smooth(3, map))},
          {"bc1", InBlocks(smooth(4, map), BlockFormat::kBc1)},
          {"bc4_codebooks", InBlocks(Sharing(smooth(5, map)), BlockFormat::kBc4)},
          {"disc", smooth(6, DirectionMap::kOrthographic)},
          {"skirt", smooth(6, DirectionMap::kHemiOctahedralSkirt)},
          {"mean_in_terms", nonnegative},
          {"no_terms", WithTerms(smooth(8, map), 0)}};
}

struct Shot {
  std::string settings;  // as in the page's address; empty: 640x480 from where the page begins
  ViewOptions view;
};

std::vector<Shot> Shots() {
  std::vector<Shot> shots(3);
  shots[0].view.size = "640x480";
  shots[1] = {",azimuth=75,elevation=-30,width=640,height=480,terms=2", {}};
  shots[1].view.azimuth = 75;
  shots[1].view.elevation = -30;
  shots[1].view.size = "640x480";
  shots[1].view.terms = 2;
  shots[2] = {",azimuth=190,elevation=60,fov=60,distance=190,width=300,height=400", {}};
  shots[2].view.azimuth = 190;
  shots[2].view.elevation = 60;
  shots[2].view.fov = 60;
  shots[2].view.distance = 190;
  shots[2].view.size = "300x400";
  return shots;
}

/// `folder`/NAME, and the rest of the name as the page's address has it, of each shot.
void WriteReferences(const ReferenceRenderer& renderer, const TriangleMesh& mesh,
                     const std::filesystem::path& folder, const std::string& name) {
  for (const Shot& shot : Shots()) {
    RenderOptions options;
    options.evaluation = MakeEvaluationOptions(shot.view);
    options.background = ParseColor(shot.view.background);
    const PictureSize size = ParsePictureSize(shot.view.size);
    const OrbitCamera orbit = MakeOrbitCamera(mesh, shot.view);
    WriteImage(renderer
                   .Render(PinholeCamera(orbit, size.width, size.height), CameraFromWorld(orbit),
                           options, SilentProgress())
                   .color,
               folder / (name + shot.settings + ".png"));
  }
}

/// Where a model turns and is scaled round the middle of its sphere (synthetic_model.h), which then
/// lies at `middle`.
Placement RoundItsMiddle(const Eigen::Quaterniond& rotation, double scale,
                         const Eigen::Vector3d& middle) {
  Placement placement{Pose::FromQuaternion(rotation, {0, 0, 0}), scale};
  placement.world_from_model.translation = middle - placement * Eigen::Vector3d(10, -20, 80);
  return placement;
}

/// Four spheres of 30 to 102 mm that hide parts of each other: models of 3, 1 and 0 terms, one of
/// them twice.
Scene MakeScene() {
  const auto share = [](LightFieldModel model) {
    return std::make_shared<const LightFieldModel>(std::move(model));
  };
  const auto smooth = [](uint32_t seed) {
    return MakeSmoothRandomModel(seed, DirectionMap::kHemiOctahedral);
  };
  const auto three = share(Coarser(smooth(1)));
  const auto one = share(WithTerms(smooth(2), 1)), none = share(WithTerms(smooth(8), 0));
  return {{"three terms", three, {}},
          {"one term", one, RoundItsMiddle({0.5, -0.1, 0.7, 0.5}, 0.5, {130, 30, 40})},
          {"no terms", none, RoundItsMiddle({0.2, 0.9, 0.3, -0.2}, 1.7, {-60, 170, 100})},
          {"three terms, turned", three, RoundItsMiddle({0, 1, 0.2, 0}, 0.75, {20, -150, 60})}};
}

void WriteScene(const std::filesystem::path& folder) {
  const Scene scene = MakeScene();
  std::vector<std::string> glbs;
  for (const PlacedModel& placed : scene) glbs.push_back(GlbBytes(*placed.model));
  std::vector<WebModel> models;
  for (size_t i = 0; i < scene.size(); ++i) models.push_back({glbs[i], scene[i].placement});
  WriteWebFolder(models, "A scene", folder);
  WriteReferences(ReferenceRenderer(scene), SceneMesh(scene), folder, "scene");
}

void WriteSamples(const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);  // every file in it is tested
  for (const auto& [name, model] : Models()) {
    WriteGlb(model, folder / (name + ".glb"));
    WriteReferences(ReferenceRenderer(model), model.mesh, folder, name);
  }
  WriteScene(folder / "scene");
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
