// SPDX-License-Identifier: BSD-3-Clause
#include "fields/lit_pictures.h"

#include <utility>

#include "core/error.h"
#include "core/image.h"
#include "fields/text_lines.h"

namespace lfm {

PhotoSplit SplitOfLight(int64_t light, int every) {
  return every > 0 && light % every == every - 1 ? PhotoSplit::kTest : PhotoSplit::kTrain;
}

Capture CaptureOfLitPictures(const std::filesystem::path& folder, const std::string& name,
                             const std::string& list, std::vector<LitPicture> pictures,
                             ColorEncoding encoding, const FieldCaptureOptions& options) {
  constexpr const char* kView = "view";
  if (pictures.empty()) throw Error(list + ": names no picture; write one a line");
  if (options.held_out_lights == 1) {
    throw Error(list +
                ": held-out-lights 1 holds every light out; take 0 for none, or 2 and above");
  }
  for (size_t i = 0; i < pictures.size(); ++i) {
    pictures[i].split = SplitOfLight(static_cast<int64_t>(i), options.held_out_lights);
  }
  Capture capture;
  capture.folder = folder;
  capture.name = name;
  ReflectanceField field;
  field.camera = kView;
  field.encoding = encoding;
  field.pictures = std::move(pictures);
  const std::string first = field.pictures.front().file;
  capture.reflectance_field = std::move(field);
  const Image image = MakeImageLoader(capture)(first);
  capture.cameras[kView] = {image.width(), image.height(), std::nullopt, encoding};
  return capture;
}

std::string SomeNames(const std::vector<std::string>& names) {
  constexpr size_t kMost = 3;
  std::string text;
  for (size_t i = 0; i < std::min(kMost, names.size()); ++i) {
    text += (i == 0 ? "" : ", ") + Quoted(names[i]);
  }
  if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
  return text;
}

}  // namespace lfm
