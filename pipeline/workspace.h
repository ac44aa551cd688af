// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <string>

namespace lfm {

/// The stages in the order of flow; each has a folder of its name in the workspace.
inline constexpr std::array<const char*, 7> kStages = {"calib",  "scan",     "mesh",  "resample",
                                                       "encode", "evaluate", "report"};

/// Position of a stage in kStages; Error that lists the names when there is no such stage.
int StageIndex(const std::string& name);

/// Where a workspace keeps what the stages make.
struct Workspace {
  std::filesystem::path folder;

  std::filesystem::path Stage(const char* name) const { return folder / name; }
  std::filesystem::path LightFieldFile() const { return folder / "resample" / "light_field.lfs"; }
  std::filesystem::path ModelFile() const { return folder / "encode" / "model.glb"; }
  /// Of a capture that varies in light, in place of ModelFile.
  std::filesystem::path RelightableFile() const { return folder / "encode" / "model.lfr"; }
  std::filesystem::path TruthFile() const { return folder / "truth" / "truth.json"; }
};

}  // namespace lfm
