// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/progress.h"

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

/// What is known of a finished stage: `STAGE/stage.json` (docs/formats.md).
struct StageRecord {
  std::string key;  ///< hash of program version, options and inputs
  nlohmann::json figures;
  nlohmann::json options;
  std::vector<std::string> outputs;  ///< results, relative to the stage's folder
  double elapsed_in_seconds = 0;
  double peak_memory_mib = 0;
  bool skipped = false;  ///< unchanged: taken from the workspace
};

/// Runs `job` unless `workspace/NAME/stage.json` says that the same options and inputs have already
/// given the results that lie there (checked by their hashes; other files that lie there are
/// nobody's results and do not matter). Tells `progress` in detail why.
///
/// Results are made in `workspace/.NAME.partial`. When they are complete, the stage's folder is
/// renamed to `.NAME.old`, the new one takes its name, and the old one is removed: however the
/// program ends, a stage's folder is whole or absent, and where it is absent after a kill, the next
/// run brings the old one back first (RecoverStage). A run that fails leaves the earlier folder.
StageRecord RunOrSkip(const std::filesystem::path& workspace, const StageJob& job,
                      Progress& progress);

/// Puts right what a killed run of the stage left: removes its partial results, and brings back
/// its former folder when the new one had not yet taken its name.
void RecoverStage(const std::filesystem::path& workspace, const std::string& name);

/// The record of a finished stage; Error, naming the command that makes it, when there is none.
StageRecord ReadStageRecord(const std::filesystem::path& workspace, const std::string& name);

/// True when every result that the stage's record names is what it was when the record was
/// written: false after the stage's own command has written into the folder. Throws Error as
/// ReadStageRecord does.
bool ResultsAreAsRecorded(const std::filesystem::path& workspace, const std::string& name);

}  // namespace lfm
