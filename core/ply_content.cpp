// SPDX-License-Identifier: BSD-3-Clause
#include "core/ply_content.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>

#include "core/error.h"

namespace lfm {
namespace {

struct ScalarName {
  std::string_view name;
  PlyScalar type;
};
constexpr ScalarName kScalarNames[] = {
    {"char", PlyScalar::kInt8},      {"int8", PlyScalar::kInt8},
    {"uchar", PlyScalar::kUint8},    {"uint8", PlyScalar::kUint8},
    {"short", PlyScalar::kInt16},    {"int16", PlyScalar::kInt16},
    {"ushort", PlyScalar::kUint16},  {"uint16", PlyScalar::kUint16},
    {"int", PlyScalar::kInt32},      {"int32", PlyScalar::kInt32},
    {"uint", PlyScalar::kUint32},    {"uint32", PlyScalar::kUint32},
    {"float", PlyScalar::kFloat32},  {"float32", PlyScalar::kFloat32},
    {"double", PlyScalar::kFloat64}, {"float64", PlyScalar::kFloat64},
};

size_t SizeOf(PlyScalar type) {
  constexpr size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<int>(type)];
}

template <typename T>
double Convert(const char* bytes, bool swap) {
  std::array<char, sizeof(T)> ordered;
  std::memcpy(ordered.data(), bytes, sizeof(T));
  if (swap) std::reverse(ordered.begin(), ordered.end());
  return static_cast<double>(std::bit_cast<T>(ordered));
}

double ConvertScalar(const char* bytes, PlyScalar type, bool swap) {
  switch (type) {
    case PlyScalar::kInt8:
      return Convert<int8_t>(bytes, swap);
    case PlyScalar::kUint8:
      return Convert<uint8_t>(bytes, swap);
    case PlyScalar::kInt16:
      return Convert<int16_t>(bytes, swap);
    case PlyScalar::kUint16:
      return Convert<uint16_t>(bytes, swap);
    case PlyScalar::kInt32:
      return Convert<int32_t>(bytes, swap);
    case PlyScalar::kUint32:
      return Convert<uint32_t>(bytes, swap);
    case PlyScalar::kFloat32:
      return Convert<float>(bytes, swap);
    case PlyScalar::kFloat64:
      return Convert<double>(bytes, swap);
  }
  return 0;
}

std::vector<std::string_view> SplitWords(std::string_view line) {
  std::vector<std::string_view> words;
  size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

class Parser {
 public:
  Parser(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  PlyContent Parse() {
    PlyContent content = ParseHeader();
    format_ = content.format;
    swap_ = (format_ == PlyFormat::kBigEndian) == (std::endian::native == std::endian::little);
    for (PlyElement& element : content.elements) ParseElement(element);
    if (bytes_.find_first_not_of(" \t\r\n", at_) != std::string_view::npos) {
      Fail("there are bytes after the last element; write it again");
    }
    return content;
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const { throw Error(file_ + ": " + problem); }
  [[noreturn]] void FailTruncated() const { Fail("the PLY file is truncated; copy it again"); }

  std::string_view HeaderLine() {
    const size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) FailTruncated();
    std::string_view line = bytes_.substr(at_, end - at_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at_ = end + 1;
    return line;
  }

  PlyScalar ScalarType(std::string_view name) const {
    for (const ScalarName& known : kScalarNames) {
      if (known.name == name) return known.type;
    }
    Fail("unknown PLY type '" + std::string(name.substr(0, 40)) + "'");
  }

  PlyFormat ParseFormat(std::string_view name) const {
    if (name == "ascii") return PlyFormat::kAscii;
    if (name == "binary_little_endian") return PlyFormat::kLittleEndian;
    if (name == "binary_big_endian") return PlyFormat::kBigEndian;
    Fail("unknown PLY format '" + std::string(name.substr(0, 40)) + "'");
  }

  PlyProperty ParseProperty(const std::vector<std::string_view>& words) const {
    PlyProperty property;
    if (words.size() == 5 && words[1] == "list") {
      property.count_type = ScalarType(words[2]);
      if (*property.count_type >= PlyScalar::kFloat32) Fail("a PLY list is counted in floats");
      property.type = ScalarType(words[3]);
    } else if (words.size() == 3) {
      property.type = ScalarType(words[1]);
    } else {
      Fail("malformed PLY header line 'property ...'");
    }
    property.name = words.back();
    return property;
  }

  PlyElement ParseElementLine(const std::vector<std::string_view>& words) const {
    if (words.size() != 3) Fail("malformed PLY header line 'element ...'");
    PlyElement element;
    element.name = words[1];
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc() || stop != end || element.count < 0) {
      Fail("the PLY element '" + element.name + "' has an impossible count");
    }
    return element;
  }

  PlyContent ParseHeader() {
    if (bytes_.empty()) Fail("the file is empty; expected PLY");
    if (bytes_.substr(0, 3) != "ply") Fail("not a PLY file");
    if (HeaderLine() != "ply") Fail("not a PLY file");
    PlyContent content;
    bool format_known = false;
    for (;;) {
      const std::vector<std::string_view> words = SplitWords(HeaderLine());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format" && words.size() == 3) {
        content.format = ParseFormat(words[1]);
        format_known = true;
      } else if (words[0] == "element") {
        content.elements.push_back(ParseElementLine(words));
      } else if (words[0] == "property" && !content.elements.empty()) {
        content.elements.back().properties.push_back(ParseProperty(words));
      } else {
        Fail("unexpected PLY header line '" + std::string(words[0].substr(0, 40)) + " ...'");
      }
    }
    if (!format_known) Fail("the PLY header does not tell the format");
    return content;
  }

  size_t Left() const { return bytes_.size() - at_; }

  double Scalar(PlyScalar type) {
    if (format_ != PlyFormat::kAscii) {
      const size_t size = SizeOf(type);
      if (size > Left()) FailTruncated();
      at_ += size;
      return ConvertScalar(bytes_.data() + at_ - size, type, swap_);
    }
    const size_t begin = bytes_.find_first_not_of(" \t\r\n", at_);
    if (begin == std::string_view::npos) FailTruncated();
    const size_t end = std::min(bytes_.find_first_of(" \t\r\n", begin), bytes_.size());
    const std::string_view word = bytes_.substr(begin, end - begin);
    const size_t digits = word.front() == '+' ? 1 : 0;
    double value = 0;
    const auto [stop, error] =
        std::from_chars(word.data() + digits, word.data() + word.size(), value);
    if (stop != word.data() + word.size() || error != std::errc()) {
      Fail("'" + std::string(word.substr(0, 40)) + "' is not a number of double precision");
    }
    if (end == bytes_.size()) cut_number_ = true;
    at_ = end;
    return value;
  }

  /// Bytes that one element takes at least.
  size_t SmallestElement(const PlyElement& element) const {
    size_t size = 0;
    for (const PlyProperty& property : element.properties) {
      const PlyScalar first = property.count_type.value_or(property.type);
      size += format_ == PlyFormat::kAscii ? 2 : SizeOf(first);  // a digit and a separator
    }
    return size;
  }

  void ParseElement(PlyElement& element) {
    const size_t smallest = SmallestElement(element);
    if (element.count > 0 && smallest == 0) {
      Fail("the PLY element '" + element.name + "' has no properties");
    }
    // The last ASCII number needs no separator.
    if (element.count > 0 && static_cast<uint64_t>(element.count) > (Left() + 1) / smallest) {
      FailTruncated();
    }
    for (PlyProperty& property : element.properties) {
      if (property.count_type) {
        property.ends.reserve(element.count);
      } else {
        property.values.reserve(element.count);
      }
    }
    for (int64_t i = 0; i < element.count; ++i) {
      for (PlyProperty& property : element.properties) {
        if (property.count_type) {
          ParseList(property);
        } else {
          property.values.push_back(Scalar(property.type));
        }
      }
    }
    // An ASCII file that ends within its last number would pass with another value.
    if (cut_number_) Fail("the last line has no end, the PLY file may be truncated; copy it again");
  }

  void ParseList(PlyProperty& property) {
    const double count = Scalar(*property.count_type);
    const size_t smallest = format_ == PlyFormat::kAscii ? 2 : SizeOf(property.type);
    if (!(count >= 0)) Fail("a PLY list has a negative length");
    if (count > static_cast<double>((Left() + 1) / smallest)) FailTruncated();
    for (int64_t i = 0; i < static_cast<int64_t>(count); ++i) {
      property.values.push_back(Scalar(property.type));
    }
    property.ends.push_back(property.values.size());
  }

  std::string_view bytes_;
  std::string file_;
  size_t at_ = 0;
  PlyFormat format_ = PlyFormat::kAscii;
  bool swap_ = false;
  bool cut_number_ = false;
};

}  // namespace

const PlyProperty* PlyElement::Find(std::string_view property_name) const {
  for (const PlyProperty& property : properties) {
    if (property.name == property_name) return &property;
  }
  return nullptr;
}

const PlyElement* PlyContent::Find(std::string_view element_name) const {
  for (const PlyElement& element : elements) {
    if (element.name == element_name) return &element;
  }
  return nullptr;
}

PlyContent ParsePly(std::string_view bytes, const std::string& file) {
  return Parser(bytes, file).Parse();
}

}  // namespace lfm
