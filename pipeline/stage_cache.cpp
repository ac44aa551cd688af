// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/stage_cache.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <system_error>

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

std::string JobKey(const StageJob& job) {
  Hasher hasher;
  hasher.Add("lfm " LFM_VERSION).Add(job.name).Add(job.options.dump());
  for (const fs::path& input : job.inputs) hasher.Add(HashInput(input));
  return hasher.HexDigest();
}

std::map<std::string, std::string> HashOutputs(const fs::path& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name != kRecordName) hashes[name] = HashFile(entry.path());
  }
  return hashes;
}

StageRecord ParseRecord(const nlohmann::json& json) {
  StageRecord record;
  record.key = json.at("key").get<std::string>();
  record.figures = json.at("figures");
  record.options = json.at("options");
  record.elapsed_in_seconds = json.at("elapsed_in_seconds").get<double>();
  record.peak_memory_mib = json.at("peak_memory_mib").get<double>();
  return record;
}

// No answer when the stage never finished, or when its record or any result was touched since.
std::optional<StageRecord> FindFinished(const fs::path& folder, const std::string& key) {
  try {
    if (!fs::exists(folder / kRecordName)) return std::nullopt;
    const nlohmann::json json = ReadJson(folder / kRecordName);
    StageRecord record = ParseRecord(json);
    const auto outputs = json.at("outputs").get<std::map<std::string, std::string>>();
    if (record.key != key || outputs != HashOutputs(folder)) return std::nullopt;
    record.skipped = true;
    return record;
  } catch (const Error&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
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
  if (error) {
    throw Error(folder.string() + ": cannot be made (" + error.message() +
                    "); choose another --out folder, or free some space",
                ErrorKind::kSystem);
  }
}

void ReplaceFolder(const fs::path& from, const fs::path& to) {
  RemoveFolder(to);
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw Error(to.string() + ": cannot be written (" + error.message() + ")", ErrorKind::kSystem);
  }
}

}  // namespace

StageRecord RunOrSkip(const fs::path& workspace, const StageJob& job) {
  const fs::path folder = workspace / job.name;
  const std::string key = JobKey(job);
  if (std::optional<StageRecord> finished = FindFinished(folder, key)) return *finished;

  const fs::path partial = workspace / ("." + job.name + ".partial");
  RemoveFolder(partial);
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
    WriteJson({{"key", record.key},
               {"options", record.options},
               {"figures", record.figures},
               {"elapsed_in_seconds", record.elapsed_in_seconds},
               {"peak_memory_mib", record.peak_memory_mib},
               {"outputs", HashOutputs(partial)}},
              partial / kRecordName);
    ReplaceFolder(partial, folder);
    return record;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
}

StageRecord ReadStageRecord(const fs::path& workspace, const std::string& name) {
  const fs::path file = workspace / name / kRecordName;
  if (!fs::exists(file)) {
    throw Error(file.string() + ": no such file; run 'lfm-pipeline run' up to the stage '" + name +
                "' first");
  }
  try {
    return ParseRecord(ReadJson(file));
  } catch (const nlohmann::json::exception&) {
    throw Error(file.string() + ": is damaged; delete the folder and run 'lfm-pipeline run' again");
  }
}

}  // namespace lfm
