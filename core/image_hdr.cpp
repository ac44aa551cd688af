// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/image_codecs.h"

// Radiance pictures (G. Ward, "Real Pixels", Graphics Gems II): three 8-bit mantissas that share an
// exponent e; a value is mantissa * 2^(e - 136).

namespace lfm {
namespace {

constexpr int kExponentBias = 136;
constexpr int kMinRunWidth = 8, kMaxRunWidth = 0x7fff;  // widths that may be run-length coded

/// A cursor over the file; running off its end is an Error.
class ByteCursor {
 public:
  explicit ByteCursor(const EncodedImage& file) : file_(file) {}
  const unsigned char* Take(size_t count) {
    if (count > file_.size - position_) Fail("the file is truncated");
    position_ += count;
    return file_.data + position_ - count;
  }
  unsigned char Byte() { return *Take(1); }
  std::string Line() {
    std::string line;
    for (unsigned char c = Byte(); c != '\n'; c = Byte()) {
      if (line.size() > 4096) Fail("a header line does not end");
      line.push_back(static_cast<char>(c));
    }
    return line;
  }
  bool NextIs(const unsigned char* bytes, size_t count) const {
    return file_.size - position_ >= count &&
           std::memcmp(file_.data + position_, bytes, count) == 0;
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(file_.name + ": not a whole HDR picture (" + problem + "); copy it again");
  }

 private:
  const EncodedImage& file_;
  size_t position_ = 0;
};

struct HdrSize {
  int64_t width = 0, height = 0;
};

/// "-Y height +X width", rows from the top.
HdrSize ParseSize(const std::string& line, const ByteCursor& cursor) {
  HdrSize size;
  const char* end = line.data() + line.size();
  const auto fail = [&]() {
    cursor.Fail("the size must read '-Y height +X width', not '" + line.substr(0, 40) + "'");
  };
  if (line.rfind("-Y ", 0) != 0) fail();
  const auto [after_height, error] = std::from_chars(line.data() + 3, end, size.height);
  if (error != std::errc() || end - after_height < 5 || std::strncmp(after_height, " +X ", 4)) {
    fail();
  }
  const auto [after_width, width_error] = std::from_chars(after_height + 4, end, size.width);
  if (width_error != std::errc() || after_width != end) fail();
  return size;
}

HdrSize ReadHeader(ByteCursor& cursor) {
  bool rgbe = false;
  for (std::string line = cursor.Line(); !line.empty(); line = cursor.Line()) {
    if (line.rfind("FORMAT=", 0) == 0) rgbe = line == "FORMAT=32-bit_rle_rgbe";
  }
  if (!rgbe) cursor.Fail("only FORMAT=32-bit_rle_rgbe is supported");
  return ParseSize(cursor.Line(), cursor);
}

/// One component of a run-length coded row: counts above 128 repeat the next byte.
void ReadRuns(ByteCursor& cursor, int width, unsigned char* out) {
  for (int x = 0; x < width;) {
    int count = cursor.Byte();
    const bool repeated = count > 128;
    if (repeated) count -= 128;
    if (count == 0 || count > width - x) cursor.Fail("a run leaves its row");
    if (repeated) {
      std::fill_n(out + x, count, cursor.Byte());
    } else {
      std::copy_n(cursor.Take(count), count, out + x);
    }
    x += count;
  }
}

void StorePixel(const unsigned char* rgbe, float* rgb) {
  const float scale = rgbe[3] ? std::ldexp(1.0f, rgbe[3] - kExponentBias) : 0.0f;
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(rgbe[c]) * scale;
}

/// A row of plain pixels, in which (1, 1, 1, n) repeats the pixel before it.
void ReadPlainRow(ByteCursor& cursor, int width, float* row) {
  int shift = 0;
  for (int x = 0; x < width;) {
    const unsigned char* rgbe = cursor.Take(4);
    if (rgbe[0] == 1 && rgbe[1] == 1 && rgbe[2] == 1) {
      const int64_t count = shift > 16 ? width : static_cast<int64_t>(rgbe[3]) << shift;
      if (x == 0 || count > width - x) cursor.Fail("a run leaves its row");
      for (int64_t i = 0; i < count; ++i, ++x) std::copy_n(row + 3 * (x - 1), 3, row + 3 * x);
      shift += 8;
    } else {
      StorePixel(rgbe, row + 3 * x++);
      shift = 0;
    }
  }
}

void AppendRuns(const unsigned char* values, int width, std::string& out) {
  constexpr int kMinRun = 4;
  for (int x = 0; x < width;) {
    int run = 1;
    while (run < 127 && x + run < width && values[x + run] == values[x]) ++run;
    if (run >= kMinRun) {
      out.push_back(static_cast<char>(128 + run));
      out.push_back(static_cast<char>(values[x]));
      x += run;
      continue;
    }
    int end = x + 1;
    while (end < width && end - x < 128) {
      const bool run_begins = end + kMinRun <= width && values[end] == values[end + 1] &&
                              values[end] == values[end + 2] && values[end] == values[end + 3];
      if (run_begins) break;
      ++end;
    }
    out.push_back(static_cast<char>(end - x));
    out.append(reinterpret_cast<const char*>(values + x), end - x);
    x = end;
  }
}

void SharedExponent(const float* rgb, unsigned char* rgbe) {
  float clean[3];
  // Largest value that the format holds: 255 * 2^(255 - 136).
  const float largest_value = std::ldexp(255.0f, 255 - kExponentBias);
  for (int c = 0; c < 3; ++c) clean[c] = rgb[c] > 0 ? std::min(rgb[c], largest_value) : 0.0f;
  const float largest = std::max({clean[0], clean[1], clean[2]});
  std::fill_n(rgbe, 4, static_cast<unsigned char>(0));
  if (largest < std::ldexp(1.0f, 1 - kExponentBias + 7)) return;
  int exponent = 0;
  std::frexp(largest, &exponent);
  // A mantissa that rounds up to 256 needs the next exponent.
  if (std::lround(std::ldexp(largest, 8 - exponent)) > 255) ++exponent;
  for (int c = 0; c < 3; ++c) {
    rgbe[c] = static_cast<unsigned char>(std::lround(std::ldexp(clean[c], 8 - exponent)));
  }
  rgbe[3] = static_cast<unsigned char>(std::clamp(exponent + kExponentBias - 8, 0, 255));
}

}  // namespace

Image DecodeHdr(const EncodedImage& file) {
  ByteCursor cursor(file);
  const HdrSize size = ReadHeader(cursor);
  RequirePlausibleSize(file, size.width, size.height, 3 * sizeof(float));
  const int width = static_cast<int>(size.width), height = static_cast<int>(size.height);
  Image image(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  const unsigned char marker[] = {2, 2, static_cast<unsigned char>(width >> 8),
                                  static_cast<unsigned char>(width)};
  std::vector<unsigned char> planes(static_cast<size_t>(width) * 4);
  for (int y = 0; y < height; ++y) {
    float* row = image.Data<float>() + static_cast<size_t>(y) * width * 3;
    if (width < kMinRunWidth || width > kMaxRunWidth || !cursor.NextIs(marker, 4)) {
      ReadPlainRow(cursor, width, row);
      continue;
    }
    cursor.Take(4);
    for (int c = 0; c < 4; ++c) ReadRuns(cursor, width, planes.data() + c * width);
    for (int x = 0; x < width; ++x) {
      const unsigned char rgbe[] = {planes[x], planes[width + x], planes[2 * width + x],
                                    planes[3 * width + x]};
      StorePixel(rgbe, row + 3 * x);
    }
  }
  return image;
}

std::string EncodeHdr(const Image& image) {
  const int width = image.width(), height = image.height();
  std::string out = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
                    std::to_string(width) + "\n";
  const bool runs = width >= kMinRunWidth && width <= kMaxRunWidth;
  std::vector<unsigned char> pixels(static_cast<size_t>(width) * 4), plane(width);
  for (int y = 0; y < height; ++y) {
    const float* row = image.Data<float>() + static_cast<size_t>(y) * width * 3;
    for (int x = 0; x < width; ++x) SharedExponent(row + 3 * x, &pixels[4 * x]);
    if (!runs) {
      out.append(reinterpret_cast<const char*>(pixels.data()), pixels.size());
      continue;
    }
    out.append({2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)});
    for (int c = 0; c < 4; ++c) {
      for (int x = 0; x < width; ++x) plane[x] = pixels[4 * x + c];
      AppendRuns(plane.data(), width, out);
    }
  }
  return out;
}

}  // namespace lfm
