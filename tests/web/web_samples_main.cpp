// SPDX-License-Identifier: BSD-3-Clause
// web_samples OUT: models of every form, and what the reference renderer shows of each, named as
// browser_test.mjs wants them.
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"
#include "encode/glb.h"
#include "tests/viewer/compressed_models.h"
#include "tests/viewer/synthetic_model.h"
#include "viewer/reference_renderer.h"
#include "viewer/view_options.h"

namespace lfm {
namespace {

LightFieldModel WithoutTerms() {
  LightFieldModel model = MakeSmoothRandomModel(8, DirectionMap::kHemiOctahedral);
  model.terms = 0;
  model.surface_pages.clear();
  model.view_pages.clear();
  model.surface_ranges.clear();
  model.view_ranges.clear();
  model.vertex_terms.assign(model.vertex_terms.size(), 0);
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
          {"no_terms", WithoutTerms()}};
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

void WriteSamples(const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);  // every file in it is tested
  for (const auto& [name, model] : Models()) {
    WriteGlb(model, folder / (name + ".glb"));
    const ReferenceRenderer renderer(model);
    for (const Shot& shot : Shots()) {
      RenderOptions options;
      options.evaluation = MakeEvaluationOptions(shot.view);
      options.background = ParseColor(shot.view.background);
      const PictureSize size = ParsePictureSize(shot.view.size);
      const OrbitCamera orbit = MakeOrbitCamera(model.mesh, shot.view);
      WriteImage(renderer
                     .Render(PinholeCamera(orbit, size.width, size.height), CameraFromWorld(orbit),
                             options, SilentProgress())
                     .color,
                 folder / (name + shot.settings + ".png"));
    }
  }
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
