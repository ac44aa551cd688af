// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lfm {

/// What a stage run needs to know to decide whether it must run at all.
struct StageJob {
  std::string name;        ///< folder in the workspace
  nlohmann::json options;  ///< as written to the report
  std::vector<std::filesystem::path>
      inputs;  ///< files, hashed by content; a missing one counts too
  /// Does the work and writes every result into the folder it is given. Returns the figures that
  /// the report shows.
  std::function<nlohmann::json(const std::filesystem::path& folder)> run;
};

/// What is known of a finished stage: `STAGE/stage.json`.
struct StageRecord {
  std::string key;  ///< hash of program version, options and inputs
  nlohmann::json figures;
  nlohmann::json options;
  double elapsed_in_seconds = 0;
  double peak_memory_mib = 0;
  bool skipped = false;  ///< unchanged: taken from the workspace
};

/// Runs `job` unless `workspace/NAME/stage.json` says that the same options and inputs have already
/// given exactly the files that lie there (checked by their hashes).
///
/// Results are made in `workspace/.NAME.partial` and renamed when complete: a stage's folder is
/// whole or absent, however the program ends.
StageRecord RunOrSkip(const std::filesystem::path& workspace, const StageJob& job);

/// The record of a finished stage; Error, naming the command that makes it, when there is none.
StageRecord ReadStageRecord(const std::filesystem::path& workspace, const std::string& name);

}  // namespace lfm
