// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/json_reader.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"

namespace lfm {

/// A copy of the small capture that the test run has rendered, to be damaged at will, and a
/// workspace for it.
class SmallCapture {
 public:
  SmallCapture() {
    std::filesystem::copy(LFM_SMALL_CAPTURE, capture(), std::filesystem::copy_options::recursive);
  }

  std::filesystem::path capture() const { return scratch_.folder / "capture"; }
  std::filesystem::path work() const { return scratch_.folder / "work"; }

  /// The workspace is that of a finished run (RunPipeline with two threads, up to evaluate) with
  /// the results of these stages.
  void BeginAfter(const std::vector<std::string>& stages) const {
    std::filesystem::create_directories(work());
    for (const std::string& stage : stages) {
      std::filesystem::copy(std::filesystem::path(LFM_SMALL_WORKSPACE) / stage, work() / stage,
                            std::filesystem::copy_options::recursive);
    }
  }

  nlohmann::json Manifest() const { return ReadJson(capture() / "capture.json"); }
  void SetManifest(const nlohmann::json& manifest) const {
    WriteJson(manifest, capture() / "capture.json");
  }

  /// Makes it a capture that brings cameras, poses and a mesh (those of the truth) and neither
  /// platform nor scans.
  void BringGeometry() const {
    nlohmann::json manifest = ReadJson(capture() / "ground_truth" / "capture.json");
    const nlohmann::json original = Manifest();
    for (size_t i = 0; i < manifest["photos"].size(); ++i) {
      manifest["photos"][i]["file"] = original["photos"][i]["file"];
      manifest["photos"][i]["split"] = original["photos"][i]["split"];
      manifest["photos"][i].erase("mask");
    }
    manifest["mesh"] = "ground_truth/" + manifest["mesh"].get<std::string>();
    manifest.erase("scanner");
    manifest.erase("board");
    SetManifest(manifest);
  }

  /// Path of a command of this build.
  static std::string Command(const std::string& name) {
    return std::string(LFM_BIN_DIR) + "/" + name;
  }

  /// Runs lfm-pipeline with options that suit so small a capture.
  CommandOutcome RunPipeline(const std::vector<std::string>& more = {},
                             const CommandSettings& settings = {}) const {
    std::vector<std::string> arguments = {
        Command("lfm-pipeline"), "run", capture().string(), "--out", work(), "--effort", "fast"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunCommand(arguments, settings);
  }

 private:
  ScratchFolder scratch_;
};

}  // namespace lfm
