// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/obj_material.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr size_t kMaxBytes = size_t{64} << 20;
constexpr const char* kBlank = " \t";

std::string_view TakeWord(std::string_view& text) {
  const size_t start = std::min(text.find_first_not_of(kBlank), text.size());
  text.remove_prefix(start);
  const size_t stop = std::min(text.find_first_of(kBlank), text.size());
  const std::string_view word = text.substr(0, stop);
  text.remove_prefix(stop);
  return word;
}

std::string_view Trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) {
    text.remove_suffix(1);
  }
  return text;
}

bool IsNumber(std::string_view word, float* value = nullptr) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  float number = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (value != nullptr) *value = number;
  return !word.empty() && error == std::errc() && stop == word.data() + word.size();
}

// What is left when options, each a word with a dash, and their values are gone. Offsets and scales
// have one to three numbers, -mm two values, all others one.
std::string_view SkipOptions(std::string_view text) {
  while (true) {
    const std::string_view rest = text;
    const std::string_view option = TakeWord(text);
    if (option.size() < 2 || option.front() != '-' || IsNumber(option)) return Trimmed(rest);
    if (option == "-o" || option == "-s" || option == "-t") {
      for (int i = 0; i < 3; ++i) {
        std::string_view ahead = text;
        if (!IsNumber(TakeWord(ahead))) break;
        text = ahead;
      }
      continue;
    }
    TakeWord(text);
    if (option == "-mm") TakeWord(text);
  }
}

}  // namespace

std::vector<ObjMaterial> ReadObjMaterials(const std::filesystem::path& file) {
  const std::string content = ReadFile(file, kMaxBytes);
  std::vector<ObjMaterial> materials;
  int line_number = 0;
  const auto fail = [&](const std::string& problem) {
    throw Error(file.string() + ": line " + std::to_string(line_number) + ": " + problem);
  };
  for (size_t at = 0; at < content.size();) {
    const size_t end = std::min(content.find('\n', at), content.size());
    std::string_view line(content.data() + at, end - at);
    at = end + 1;
    ++line_number;
    if (line.find('\0') != line.npos) fail("binary content; this is no material library");
    line = Trimmed(line.substr(0, line.find('#')));
    const std::string_view key = TakeWord(line);
    if (key == "newmtl") {
      materials.emplace_back().name = Trimmed(line);
      continue;
    }
    if (key != "Kd" && key != "map_Kd") continue;
    if (materials.empty()) fail("'" + std::string(key) + "' stands before the first newmtl");
    ObjMaterial& material = materials.back();
    if (key == "map_Kd") {
      std::string name(SkipOptions(line));
      std::replace(name.begin(), name.end(), '\\', '/');
      if (name.empty()) fail("map_Kd names no file");
      material.picture = file.parent_path() / name;
      continue;
    }
    std::vector<float> numbers;
    for (float value = 0; !line.empty();) {
      if (!IsNumber(TakeWord(line), &value)) fail("the colour Kd needs three numbers");
      if (!std::isfinite(value)) fail("the colour Kd is not finite");
      numbers.push_back(std::clamp(value, 0.0f, 1.0f));
    }
    if (numbers.size() == 1) numbers.resize(3, numbers[0]);
    if (numbers.size() != 3) fail("the colour Kd needs three numbers");
    material.diffuse = {numbers[0], numbers[1], numbers[2]};
  }
  return materials;
}

}  // namespace lfm
