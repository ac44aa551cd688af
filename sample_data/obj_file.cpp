// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/obj_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {
namespace {

// One corner of a face: indices of position, texture coordinates, normal, material; -1 where not
// given.
using Corner = std::array<int, 4>;

struct CornerHash {
  size_t operator()(const Corner& c) const {
    uint64_t h = 0;
    for (int i : c) h = (h ^ static_cast<uint32_t>(i)) * 0x9e3779b97f4a7c15ull;
    return h ^ (h >> 29);
  }
};

class ObjParser {
 public:
  ObjParser(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  TexturedMesh Parse() {
    while (NextLine()) ParseLine();
    if (corners_.empty()) {
      throw Error(file_ + ": no faces found; is it a mesh in Wavefront OBJ form?");
    }
    return Assemble();
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(file_ + ": line " + std::to_string(line_number_) + ": " + problem);
  }

  // Splits the next line into words; false at the end.
  bool NextLine() {
    words_.clear();
    bool more = at_ < text_.size();
    if (!more) return false;
    while (more) {
      const size_t end = std::min(text_.find('\n', at_), text_.size());
      std::string_view line = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++line_number_;
      if (line.find('\0') != std::string_view::npos) Fail("binary content; this is no OBJ file");
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      line = line.substr(0, line.find('#'));
      more = !line.empty() && line.back() == '\\' && at_ < text_.size();
      if (!line.empty() && line.back() == '\\') line.remove_suffix(1);
      for (size_t start = 0; (start = line.find_first_not_of(" \t", start)) != line.npos;) {
        const size_t stop = std::min(line.find_first_of(" \t", start), line.size());
        words_.push_back(line.substr(start, stop - start));
        start = stop;
      }
    }
    return true;
  }

  void ParseLine() {
    if (words_.empty()) return;
    const std::string_view key = words_[0];
    if (key == "v") {
      positions_.push_back(Numbers<3>("coordinate of vertex " + std::to_string(positions_.size())));
      ReadColor();
    } else if (key == "vt") {
      uv_.push_back(Numbers<2>("texture coordinate").template cast<float>());
      if (!uv_.back().allFinite()) Fail("a texture coordinate is too large");
    } else if (key == "vn") {
      normals_.push_back(Numbers<3>("normal"));
    } else if (key == "f") {
      ParseFace();
    } else if (key == "mtllib") {
      ReadLibraries();
    } else if (key == "usemtl") {
      UseMaterial();
    } else if (key.size() > 24 ||
               key.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_") !=
                   key.npos) {
      Fail("'" + std::string(key.substr(0, 24)) + "' is no statement of an OBJ file");
    }
  }

  // The words after the first as they stand in the line, for names with spaces.
  std::string Rest() const {
    if (words_.size() < 2) return "";
    std::string rest(words_[1]);
    for (size_t i = 2; i < words_.size(); ++i) rest += ' ' + std::string(words_[i]);
    return rest;
  }

  void ReadLibraries() {
    // One name with spaces, or several names.
    std::vector<std::string> names = {Rest()};
    std::error_code ignored;
    const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
    if (!std::filesystem::is_regular_file(folder / names[0], ignored) && words_.size() > 2) {
      names.assign(words_.begin() + 1, words_.end());
    }
    for (const std::string& name : names) {
      if (!libraries_.insert(name).second) continue;
      if (!std::filesystem::is_regular_file(folder / name, ignored)) {
        warnings_.push_back("materials left out: there is no file " + (folder / name).string());
        continue;
      }
      for (const ObjMaterial& material : ReadObjMaterials(folder / name)) {
        material_of_name_.emplace(material.name, static_cast<int>(materials_.size()));
        materials_.push_back(material);
      }
    }
  }

  void UseMaterial() {
    const std::string name = Rest();
    const auto found = material_of_name_.find(name);
    used_ = found == material_of_name_.end() ? -1 : found->second;
    if (used_ < 0 && !materials_.empty() && unknown_.insert(name).second) {
      warnings_.push_back("no library has the material '" + name + "'");
    }
  }

  double Number(size_t word, const std::string& what) const {
    if (word >= words_.size()) Fail("the " + what + " is missing; is the file truncated?");
    std::string_view text = words_[word];
    if (text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (stop != text.data() + text.size() || error == std::errc::invalid_argument) {
      Fail("the " + what + " is '" + std::string(words_[word].substr(0, 24)) + "', not a number");
    }
    // Beyond the range of doubles: next to nothing, or infinite.
    if (error != std::errc()) value = std::strtod(std::string(text).c_str(), nullptr);
    if (!std::isfinite(value)) Fail("the " + what + " is not finite");
    return value;
  }

  template <int N>
  Eigen::Matrix<double, N, 1> Numbers(const std::string& what) const {
    Eigen::Matrix<double, N, 1> numbers;
    for (int i = 0; i < N; ++i) numbers[i] = Number(static_cast<size_t>(i) + 1, what);
    return numbers;
  }

  // Colours behind the coordinates: a widespread extension.
  void ReadColor() {
    if (words_.size() != 7) return;
    colors_.resize(positions_.size() - 1, Eigen::Vector3f::Ones());
    Eigen::Vector3f color;
    for (size_t c = 0; c < 3; ++c) {
      color[static_cast<int>(c)] = static_cast<float>(Number(4 + c, "colour"));
    }
    colors_.push_back(color.cwiseMax(0.0f).cwiseMin(1.0f));
  }

  // One of the indices between slashes; -1 when there is none.
  int Index(std::string_view text, size_t count, const char* what) const {
    if (text.empty()) return -1;
    int64_t index = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (stop != text.data() + text.size() || error != std::errc()) {
      Fail("'" + std::string(text.substr(0, 24)) + "' is not the index of a " + what);
    }
    const int64_t known = static_cast<int64_t>(count);
    if (index == 0 || index > known || index < -known) {
      Fail("the face names " + std::string(what) + " " + std::to_string(index) +
           ", but there are only " + std::to_string(known) + " so far");
    }
    return static_cast<int>(index > 0 ? index - 1 : known + index);
  }

  Corner ParseCorner(std::string_view word) const {
    std::array<std::string_view, 3> parts;
    for (size_t i = 0; i < 3; ++i) {
      const size_t slash = word.find('/');
      parts[i] = word.substr(0, slash);
      if (slash == word.npos) {
        word = {};
        break;
      }
      word.remove_prefix(slash + 1);
    }
    if (!word.empty()) Fail("a corner of a face has more than three indices");
    const Corner corner = {Index(parts[0], positions_.size(), "vertex"),
                           Index(parts[1], uv_.size(), "texture coordinate"),
                           Index(parts[2], normals_.size(), "normal"), used_};
    if (corner[0] < 0) Fail("a corner of a face names no vertex");
    return corner;
  }

  void ParseFace() {
    if (words_.size() < 4) Fail("a face has fewer than three corners; is the file truncated?");
    const Corner first = ParseCorner(words_[1]);
    Corner last = ParseCorner(words_[2]);
    for (size_t i = 3; i < words_.size(); ++i) {
      const Corner next = ParseCorner(words_[i]);
      corners_.insert(corners_.end(), {first, last, next});
      last = next;
    }
    if (corners_.size() / 3 > kMaxTriangles)
      Fail("more than 4 million triangles; decimate it first");
  }

  TexturedMesh Assemble() {
    bool has_uv = true, has_normals = true;
    for (const Corner& c : corners_) {
      has_uv = has_uv && c[1] >= 0;
      has_normals = has_normals && c[2] >= 0;
    }
    if (!colors_.empty()) colors_.resize(positions_.size(), Eigen::Vector3f::Ones());
    TexturedMesh result;
    TriangleMesh& mesh = result.mesh;
    std::unordered_map<Corner, int, CornerHash> known;
    Eigen::Vector3i triangle;
    for (size_t i = 0; i < corners_.size(); ++i) {
      const Corner key = {corners_[i][0], has_uv ? corners_[i][1] : -1,
                          has_normals ? corners_[i][2] : -1, corners_[i][3]};
      const auto [entry, is_new] = known.try_emplace(key, static_cast<int>(mesh.vertices.size()));
      if (is_new) {
        mesh.vertices.push_back(positions_[key[0]]);
        if (has_uv) result.uv.push_back(uv_[key[1]]);
        if (has_normals) mesh.normals.push_back(normals_[key[2]]);
        if (!colors_.empty()) mesh.colors.push_back(colors_[key[0]]);
        if (!materials_.empty()) result.material.push_back(key[3]);
      }
      triangle[static_cast<int>(i % 3)] = entry->second;
      if (i % 3 == 2) mesh.triangles.push_back(triangle);
    }
    result.materials = std::move(materials_);
    result.warnings = std::move(warnings_);
    return result;
  }

  static constexpr size_t kMaxTriangles = 4'000'000;

  std::string_view text_;
  std::string file_;
  size_t at_ = 0;
  int64_t line_number_ = 0;
  std::vector<std::string_view> words_;
  std::vector<Eigen::Vector3d> positions_, normals_;
  std::vector<Eigen::Vector2f> uv_;
  std::vector<Eigen::Vector3f> colors_;
  std::vector<Corner> corners_;
  std::vector<ObjMaterial> materials_;
  std::map<std::string, int> material_of_name_;
  std::set<std::string> libraries_, unknown_;  // that were named
  std::vector<std::string> warnings_;
  int used_ = -1;  // material
};

}  // namespace

TexturedMesh ReadObj(const std::filesystem::path& file) {
  constexpr size_t kMaxBytes = size_t{4} << 30;
  const std::string text = ReadFile(file, kMaxBytes);
  if (text.empty()) throw Error(file.string() + ": the file is empty; expected an OBJ mesh");
  return ObjParser(text, file.string()).Parse();
}

}  // namespace lfm
