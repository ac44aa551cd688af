// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/truth_record.h"

#include <filesystem>
#include <system_error>

#include "core/error.h"
#include "core/hash.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

using nlohmann::json;

void AddFile(Hasher& hasher, const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) {
    hasher.AddFile(file);
  } else {
    hasher.Add("missing");
  }
}

}  // namespace

json TruthInputs(const Capture& capture, const Workspace& workspace) {
  json inputs = json::object();
  for (const char* name : {"calib/cameras.json", "calib/poses.json", "scan/points.ply",
                           "mesh/surface.ply", "mesh/mesh.ply", "encode/model.glb"}) {
    Hasher hasher;
    AddFile(hasher, workspace.folder / name);
    inputs[name] = hasher.HexDigest();
  }
  Hasher photographs;
  for (const Photo& photo : capture.photos) {
    if (photo.split == PhotoSplit::kTest) AddFile(photographs, capture.folder / photo.file);
  }
  inputs["test photographs"] = photographs.HexDigest();
  return inputs;
}

void SaveTruth(const Workspace& workspace, const json& inputs, const json& result) {
  json record = result;
  record["inputs"] = inputs;
  WriteJson(record, workspace.TruthFile());
}

std::optional<json> FindTruth(const Capture& capture, const Workspace& workspace) {
  if (!std::filesystem::exists(workspace.TruthFile())) return std::nullopt;
  try {
    const json record = ReadJson(workspace.TruthFile());
    if (!record.is_object() || !record.contains("truth") || !record.contains("evaluate") ||
        record.value("inputs", json()) != TruthInputs(capture, workspace)) {
      return std::nullopt;
    }
    return record;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace lfm
