// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/web_page.h"

#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/markup_text.h"
#include "viewer/page_marks.h"
#include "viewer/web_bundle.h"

namespace lfm {
namespace {

constexpr std::string_view kModelElement = R"(<template id="model">@LFM_MODEL_BASE64@</template>)";
constexpr std::string_view kModelName = R"(<meta name="model" content="model.glb">)";
constexpr std::string_view kSceneName = R"(<meta name="model" content="scene.json">)";

/// What the pages show.
struct WebScene {
  struct File {
    std::string name;
    std::string_view glb;
  };
  std::vector<File> files;  ///< all different
  std::string json;         ///< empty for one model where it is
};

void RequirePlace(const Placement& placement) {
  const Pose& pose = placement.world_from_model;
  const bool readable = pose.rotation.allFinite() && pose.translation.allFinite() &&
                        pose.translation.cwiseAbs().maxCoeff() <= Placement::kFarthestMm &&
                        placement.scale >= Placement::kLeastScale &&
                        placement.scale <= Placement::kMostScale;
  if (!readable) {
    throw Error("a model stands more than 1e9 mm away, or its scale is not in [1e-6, 1e6]");
  }
}

bool IsWhereItIs(const Placement& placement) {
  return placement.scale == 1 && placement.world_from_model.rotation.isIdentity(0) &&
         placement.world_from_model.translation.isZero(0);
}

WebScene MakeScene(std::span<const WebModel> models) {
  if (models.empty() || models.size() > kMostModels) {
    throw Error("pages for browsers hold 1 to 1000 models; divide the scene");
  }
  WebScene scene;
  std::map<std::string_view, std::string> names;
  nlohmann::json entries = nlohmann::json::array();
  for (const WebModel& model : models) {
    RequirePlace(model.placement);
    const auto [file, is_new] = names.try_emplace(
        model.glb,
        names.empty() ? "model.glb" : "model-" + std::to_string(names.size() + 1) + ".glb");
    if (is_new) scene.files.push_back({file->second, model.glb});
    nlohmann::json entry = PoseToJson(model.placement.world_from_model);
    entry["file"] = file->second;
    entry["scale"] = model.placement.scale;
    entries.push_back(std::move(entry));
  }
  if (models.size() > 1 || !IsWhereItIs(models[0].placement)) {
    scene.json = nlohmann::json{{"models", std::move(entries)}}.dump(2);
  }
  return scene;
}

std::string SinglePage(const WebScene& scene, const std::string& title) {
  // The models first: a title may be anything, base 64 holds no mark.
  std::string page;
  if (scene.json.empty()) {
    page = FillMark(web_bundle::SingleHtml(), kModelMark, Base64(scene.files[0].glb));
  } else {
    std::string elements = "<template id=\"scene\">" + scene.json + "</template>";
    for (const WebScene::File& file : scene.files) {
      elements += "\n<template data-file=\"" + file.name + "\">" + Base64(file.glb) + "</template>";
    }
    page = FillMark(web_bundle::SingleHtml(), kModelElement, elements);
  }
  return FillMark(page, kTitleMark, EscapeMarkup(title));
}

// Earlier pages of more models leave some behind, which these pages do not show.
void RemoveEarlierModels(const WebScene& scene, const std::filesystem::path& folder) {
  if (scene.json.empty()) std::filesystem::remove(folder / "scene.json");
  for (size_t i = std::max<size_t>(scene.files.size() + 1, 2);; ++i) {
    if (!std::filesystem::remove(folder / ("model-" + std::to_string(i) + ".glb"))) return;
  }
}

std::string ServedPage(const WebScene& scene, const std::string& title) {
  std::string page(web_bundle::IndexHtml());
  if (!scene.json.empty()) page = FillMark(page, kModelName, kSceneName);
  return FillMark(page, kTitleMark, EscapeMarkup(title));
}

}  // namespace

void WriteWebFolder(std::span<const WebModel> models, const std::string& title,
                    const std::filesystem::path& folder) {
  const WebScene scene = MakeScene(models);
  const bool had_pages = std::filesystem::exists(folder / "app.js");
  WriteFilesTogether(folder, [&](const std::filesystem::path& files) {
    for (const WebScene::File& file : scene.files) {
      WriteFileAtomically(files / file.name, file.glb);
    }
    if (!scene.json.empty()) WriteFileAtomically(files / "scene.json", scene.json + "\n");
    WriteFileAtomically(files / "app.js", web_bundle::AppJs());
    WriteFileAtomically(files / "index.html", ServedPage(scene, title));
    WriteFileAtomically(files / "model.html", SinglePage(scene, title));
  });
  if (had_pages) RemoveEarlierModels(scene, folder);
}

void WriteWebFolder(std::string_view glb, const std::string& title,
                    const std::filesystem::path& folder) {
  const WebModel model{glb, {}};
  WriteWebFolder(std::span(&model, 1), title, folder);
}

}  // namespace lfm
