// SPDX-License-Identifier: BSD-3-Clause
#include "fields/diligent_capture.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "fields/lit_pictures.h"
#include "fields/text_lines.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNames = "filenames.txt";
constexpr const char* kDirections = "light_directions.txt";
constexpr const char* kIntensities = "light_intensities.txt";
constexpr const char* kMask = "mask.png";
constexpr size_t kMostBytes = size_t{1} << 26;

bool HasFile(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

struct NumberRow {
  int line = 0;
  Eigen::Vector3d numbers;
};

// Rows of three numbers; where `one_is_gray`, a single number stands for three.
std::vector<NumberRow> ReadRows(const fs::path& file, bool one_is_gray) {
  const std::string text = ReadFile(file, kMostBytes);
  std::vector<NumberRow> rows;
  for (const TextLine& line : LinesOfText(text, file.string())) {
    std::vector<std::string_view> words = WordsOfLine(line.text);
    if (one_is_gray && words.size() == 1) words.resize(3, words.front());
    if (words.size() != 3) {
      throw Error(LinePlace(file.string(), line.number) + "expected three numbers, not " +
                  Quoted(line.text));
    }
    NumberRow row{line.number, {}};
    for (int k = 0; k < 3; ++k) {
      const std::optional<double> number = NumberOfWord(words[static_cast<size_t>(k)]);
      if (!number) {
        throw Error(LinePlace(file.string(), line.number) + Quoted(words[static_cast<size_t>(k)]) +
                    " is not a finite number");
      }
      row.numbers[k] = *number;
    }
    rows.push_back(row);
  }
  return rows;
}

void RequireAsMany(size_t count, size_t pictures, const fs::path& file) {
  if (count == pictures) return;
  throw Error(file.string() + ": holds " + std::to_string(count) + " lines, but " + kNames +
              " beside it names " + std::to_string(pictures) + " pictures; one line a picture");
}

std::vector<LitPicture> ReadNames(const fs::path& folder) {
  const std::string list = (folder / kNames).string();
  const std::string text = ReadFile(folder / kNames, kMostBytes);
  std::vector<LitPicture> pictures;
  std::vector<std::string> missing;
  std::map<std::string, int> line_of;
  for (const TextLine& line : LinesOfText(text, list)) {
    LitPicture picture;
    picture.file = std::string(line.text);
    const std::string problem = CapturePathProblem(folder, picture.file);
    if (!problem.empty()) throw Error(LinePlace(list, line.number) + problem);
    const auto [first, is_new] = line_of.emplace(picture.file, line.number);
    if (!is_new) {
      throw Error(LinePlace(list, line.number) + Quoted(picture.file) + " is named in line " +
                  std::to_string(first->second) + " already; every light has a picture of its own");
    }
    if (!HasFile(folder / picture.file)) missing.push_back(picture.file);
    pictures.push_back(std::move(picture));
  }
  if (pictures.empty()) throw Error(list + ": names no picture; write one a line");
  if (!missing.empty()) {
    throw Error(list + ": pictures are missing: " + SomeNames(missing) + "; put them beside it");
  }
  return pictures;
}

Eigen::Vector3d DirectionOf(const NumberRow& row, const fs::path& file) {
  const double length = row.numbers.stableNorm();
  if (!(length >= 1e-30 && length <= 1e30)) {
    throw Error(LinePlace(file.string(), row.line) +
                "gives no direction; write the unit vector towards the light");
  }
  return (row.numbers / length).normalized();
}

}  // namespace

bool IsDiligentFolder(const fs::path& folder) {
  return HasFile(folder / kNames) && HasFile(folder / kDirections);
}

Capture OpenDiligentCapture(const fs::path& folder, const FieldCaptureOptions& options,
                            Progress& progress) {
  std::vector<LitPicture> pictures = ReadNames(folder);
  const std::vector<NumberRow> directions = ReadRows(folder / kDirections, false);
  RequireAsMany(directions.size(), pictures.size(), folder / kDirections);
  for (size_t i = 0; i < pictures.size(); ++i) {
    pictures[i].to_light = DirectionOf(directions[i], folder / kDirections);
  }
  if (HasFile(folder / kIntensities)) {
    const std::vector<NumberRow> intensities = ReadRows(folder / kIntensities, true);
    RequireAsMany(intensities.size(), pictures.size(), folder / kIntensities);
    for (size_t i = 0; i < pictures.size(); ++i) {
      if (!(intensities[i].numbers.minCoeff() > 0)) {
        throw Error(LinePlace((folder / kIntensities).string(), intensities[i].line) +
                    "an intensity is not positive; leave out the lights that were off");
      }
      pictures[i].intensity = intensities[i].numbers;
    }
  } else {
    progress.Note(folder.string() + ": has no " + kIntensities +
                  "; all lights are taken to be equally strong");
  }
  const std::string name = fs::absolute(folder / "").lexically_normal().parent_path().filename();
  Capture capture = CaptureOfLitPictures(folder, name, (folder / kNames).string(),
                                         std::move(pictures), ColorEncoding::kLinear, options);
  if (HasFile(folder / kMask)) capture.reflectance_field->mask = kMask;
  return capture;
}

}  // namespace lfm
