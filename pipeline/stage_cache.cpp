// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/stage_cache.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/json_reader.h"
#include "core/process_memory.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecordName = "stage.json";

std::string HashFile(const fs::path& file) {
  Hasher hasher;
  return hasher.AddFile(file).HexDigest();
}

// A missing or unreadable input is a state like any other: the stage says what it makes of it.
std::string HashInput(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) ? HashFile(file) : "missing";
}

std::vector<std::string> HashInputs(const StageJob& job) {
  std::vector<std::string> hashes;
  for (const fs::path& input : job.inputs) hashes.push_back(HashInput(input));
  return hashes;
}

std::string JobKey(const StageJob& job, const std::vector<std::string>& inputs) {
  Hasher hasher;
  hasher.Add("lfm " LFM_VERSION).Add(job.name).Add(job.options.dump());
  for (const std::string& input : inputs) hasher.Add(input);
  return hasher.HexDigest();
}

using OutputHashes = std::map<std::string, std::string>;

OutputHashes HashOutputs(const fs::path& folder) {
  OutputHashes hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name != kRecordName) hashes[name] = HashFile(entry.path());
  }
  return hashes;
}

// The first result that is not what the record says; empty when all are.
std::string ChangedOutput(const fs::path& folder, const nlohmann::json& record) {
  for (const auto& [name, hash] : record.at("outputs").get<OutputHashes>()) {
    if (HashInput(folder / name) != hash) return name;
  }
  return "";
}

StageRecord ParseRecord(const nlohmann::json& json) {
  StageRecord record;
  for (const auto& [name, hash] : json.at("outputs").get<OutputHashes>()) {
    record.outputs.push_back(name);
  }
  record.key = json.at("key").get<std::string>();
  record.figures = json.at("figures");
  record.options = json.at("options");
  record.elapsed_in_seconds = json.at("elapsed_in_seconds").get<double>();
  record.peak_memory_mib = json.at("peak_memory_mib").get<double>();
  return record;
}

// Which option or input makes `job` another one than that of `record`, for people.
std::string DescribeChange(const nlohmann::json& record, const StageJob& job,
                           const std::vector<std::string>& inputs) {
  const nlohmann::json& options = record.at("options");
  for (const auto& [name, value] : job.options.items()) {
    if (!options.contains(name) || options.at(name) != value) {
      return "option " + name + " is now " + value.dump();
    }
  }
  const auto earlier = record.at("inputs").get<std::vector<std::string>>();
  if (earlier.size() != inputs.size()) return "it has other inputs";
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i] != earlier[i]) return job.inputs[i].string() + " has changed";
  }
  return "another version of lfm made it";
}

// The finished stage, or why there is none: it never finished, its job is another one now, or its
// record or a result was touched since.
struct Finding {
  std::optional<StageRecord> record;
  std::string why;
};

Finding FindFinished(const fs::path& folder, const StageJob& job,
                     const std::vector<std::string>& inputs, const std::string& key) {
  try {
    if (!fs::exists(folder / kRecordName)) return {std::nullopt, "it has not run yet"};
    const nlohmann::json json = ReadJson(folder / kRecordName);
    StageRecord record = ParseRecord(json);
    if (record.key != key) return {std::nullopt, DescribeChange(json, job, inputs)};
    const std::string changed = ChangedOutput(folder, json);
    if (!changed.empty()) {
      return {std::nullopt, (folder / changed).string() + " is not what the stage wrote"};
    }
    record.skipped = true;
    return {record, "options, inputs and results are unchanged"};
  } catch (const Error&) {
  } catch (const nlohmann::json::exception&) {
  }
  return {std::nullopt, (folder / kRecordName).string() + " is damaged"};
}

void RemoveFolder(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  if (error) {
    throw Error(folder.string() + ": cannot be removed (" + error.message() + ")",
                ErrorKind::kSystem);
  }
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) FailWriting(folder, error.value());
}

void RenameFolder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) FailWriting(to, error.value());
}

fs::path PartialFolder(const fs::path& workspace, const std::string& name) {
  return workspace / ("." + name + ".partial");
}

fs::path OldFolder(const fs::path& workspace, const std::string& name) {
  return workspace / ("." + name + ".old");
}

}  // namespace

void RecoverStage(const fs::path& workspace, const std::string& name) {
  RemoveFolder(PartialFolder(workspace, name));
  const fs::path folder = workspace / name, old = OldFolder(workspace, name);
  if (fs::exists(old) && !fs::exists(folder)) RenameFolder(old, folder);
  RemoveFolder(old);
}

StageRecord RunOrSkip(const fs::path& workspace, const StageJob& job, Progress& progress) {
  RecoverStage(workspace, job.name);
  const fs::path folder = workspace / job.name;
  const std::vector<std::string> inputs = HashInputs(job);
  const std::string key = JobKey(job, inputs);
  const Finding finding = FindFinished(folder, job, inputs, key);
  progress.Detail(job.name + ": " + (finding.record ? "skipped" : "runs") + ": " + finding.why);
  if (finding.record) return *finding.record;

  const fs::path partial = PartialFolder(workspace, job.name);
  MakeFolder(partial);
  try {
    const auto start = std::chrono::steady_clock::now();
    StageRecord record;
    record.key = key;
    record.options = job.options;
    record.figures = job.run(partial);
    record.elapsed_in_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    record.peak_memory_mib = PeakMemoryMib();
    const OutputHashes outputs = HashOutputs(partial);
    for (const auto& [name, hash] : outputs) record.outputs.push_back(name);
    WriteJson({{"key", record.key},
               {"options", record.options},
               {"inputs", inputs},
               {"figures", record.figures},
               {"elapsed_in_seconds", record.elapsed_in_seconds},
               {"peak_memory_mib", record.peak_memory_mib},
               {"outputs", outputs}},
              partial / kRecordName);
    if (fs::exists(folder)) RenameFolder(folder, OldFolder(workspace, job.name));
    RenameFolder(partial, folder);
    RemoveFolder(OldFolder(workspace, job.name));
    return record;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    if (!fs::exists(folder, ignored)) {
      fs::rename(OldFolder(workspace, job.name), folder, ignored);
    }
    throw;
  }
}

namespace {

// Reads a stage's record; `parse` may meet a damaged one.
template <typename Parse>
auto ReadRecord(const fs::path& workspace, const std::string& name, const Parse& parse) {
  const fs::path file = workspace / name / kRecordName;
  if (!fs::exists(file)) {
    throw Error(file.string() + ": no such file; run 'lfm-pipeline run' up to the stage '" + name +
                "' first");
  }
  try {
    return parse(ReadJson(file));
  } catch (const nlohmann::json::exception&) {
    throw Error(file.string() + ": is damaged; delete the folder and run 'lfm-pipeline run' again");
  }
}

}  // namespace

StageRecord ReadStageRecord(const fs::path& workspace, const std::string& name) {
  return ReadRecord(workspace, name, ParseRecord);
}

bool ResultsAreAsRecorded(const fs::path& workspace, const std::string& name) {
  return ReadRecord(workspace, name, [&](const nlohmann::json& json) {
    return ChangedOutput(workspace / name, json).empty();
  });
}

}  // namespace lfm
