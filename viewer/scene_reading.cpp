// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/scene_reading.h"

#include <map>
#include <utility>

#include "encode/transport_form.h"

namespace lfm {

Scene ReadScene(std::span<const SceneEntry> entries, Progress& progress) {
  std::map<std::filesystem::path, std::shared_ptr<const LightFieldModel>> read;
  Scene scene;
  progress.Start("read the models", static_cast<int64_t>(entries.size()));
  for (const SceneEntry& entry : entries) {
    std::shared_ptr<const LightFieldModel>& model = read[entry.file];
    if (!model) {
      DecodedModel decoded = ReadModel(entry.file);
      if (decoded.parts_missing > 0) progress.Note(CutOffNote(entry.file, decoded));
      model = std::make_shared<const LightFieldModel>(std::move(decoded.model));
    }
    scene.push_back({entry.file.filename().string(), model, entry.placement});
    progress.Advance();
  }
  return scene;
}

}  // namespace lfm
