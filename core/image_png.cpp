// SPDX-License-Identifier: BSD-3-Clause
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include "core/error.h"
#include "core/image_codecs.h"

// libpng reports errors by a long jump, which must not cross a C++ destructor: between a setjmp and
// the calls that it guards, functions here own only plain data; buffers belong to their callers.

namespace lfm {
namespace {

constexpr size_t kMessageSize = 160;

struct ReadState {
  const unsigned char* data;
  size_t size;
  size_t position;
  char message[kMessageSize];
};

struct WriteState {
  std::string* bytes;
  char message[kMessageSize];
};

void ReadBytes(png_structp png, png_bytep out, size_t count) {
  auto* state = static_cast<ReadState*>(png_get_io_ptr(png));
  if (count > state->size - state->position) png_error(png, "the file is truncated");
  std::memcpy(out, state->data + state->position, count);
  state->position += count;
}

void WriteBytes(png_structp png, png_bytep bytes, size_t count) {
  auto* state = static_cast<WriteState*>(png_get_io_ptr(png));
  state->bytes->append(reinterpret_cast<const char*>(bytes), count);
}

void FlushBytes(png_structp) {}

[[noreturn]] void OnError(png_structp png, png_const_charp message) {
  std::snprintf(static_cast<char*>(png_get_error_ptr(png)), kMessageSize, "%s", message);
  png_longjmp(png, 1);
}

void OnWarning(png_structp, png_const_charp) {}

struct PngHeader {
  int64_t width, height;
  int channels, bits;
};

/// Reads up to the pixels and asks for 8 or 16 bits, no palette, alpha where the file has any.
bool ReadHeader(png_structp png, png_infop info, PngHeader* header) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
  png_read_info(png, info);
  png_set_expand(png);
  if (png_get_bit_depth(png, info) == 16) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  header->width = png_get_image_width(png, info);
  header->height = png_get_image_height(png, info);
  header->channels = png_get_channels(png, info);
  header->bits = png_get_bit_depth(png, info);
  return true;
}

bool ReadRows(png_structp png, png_infop info, unsigned char** rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows);
  png_read_end(png, info);
  return true;
}

struct Reader {
  explicit Reader(ReadState* state)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, state->message, OnError, OnWarning)),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (info) png_set_read_fn(png, state, ReadBytes);
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  png_structp png;
  png_infop info;
};

struct Writer {
  explicit Writer(WriteState* state)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, state->message, OnError, OnWarning)),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (info) png_set_write_fn(png, state, WriteBytes, FlushBytes);
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  png_structp png;
  png_infop info;
};

std::vector<unsigned char*> RowPointers(Image& image) {
  unsigned char* data = image.type() == PixelType::kUint8
                            ? image.Data<uint8_t>()
                            : reinterpret_cast<unsigned char*>(image.Data<uint16_t>());
  const size_t stride = image.Bytes().size() / image.height();
  std::vector<unsigned char*> rows(image.height());
  for (int y = 0; y < image.height(); ++y) rows[y] = data + y * stride;
  return rows;
}

bool WriteAll(png_structp png, png_infop info, const PngHeader& header, int compression,
              const unsigned char* data, size_t stride) {
  if (setjmp(png_jmpbuf(png))) return false;
  constexpr int kColorTypes[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                 PNG_COLOR_TYPE_RGB_ALPHA};
  png_set_IHDR(png, info, static_cast<png_uint_32>(header.width),
               static_cast<png_uint_32>(header.height), header.bits,
               kColorTypes[header.channels - 1], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, compression);
  // Trying every filter costs as much as fast compression itself.
  png_set_filter(png, PNG_FILTER_TYPE_BASE, compression <= 3 ? PNG_FILTER_SUB : PNG_ALL_FILTERS);
  png_write_info(png, info);
  if (header.bits == 16) png_set_swap(png);
  for (int64_t y = 0; y < header.height; ++y) png_write_row(png, data + y * stride);
  png_write_end(png, info);
  return true;
}

}  // namespace

Image DecodePng(const EncodedImage& file, std::optional<ColorEncoding> encoding) {
  ReadState state{file.data, file.size, 0, ""};
  Reader reader(&state);
  if (!reader.info) throw Error(file.name + ": out of memory", ErrorKind::kSystem);
  const auto fail = [&]() {
    throw Error(file.name + ": not a whole PNG picture (" + state.message + "); copy it again");
  };
  PngHeader header{};
  if (!ReadHeader(reader.png, reader.info, &header)) fail();
  RequirePlausibleSize(file, header.width, header.height, header.channels * header.bits / 8);
  if (header.bits == 16 && !encoding) {
    throw Error(file.name +
                ": a 16-bit PNG does not say whether it is linear or sRGB; state its encoding");
  }
  Image image(static_cast<int>(header.width), static_cast<int>(header.height), header.channels,
              header.bits == 16 ? PixelType::kUint16 : PixelType::kUint8,
              header.bits == 16 ? *encoding : ColorEncoding::kSrgb);
  std::vector<unsigned char*> rows = RowPointers(image);
  if (!ReadRows(reader.png, reader.info, rows.data())) fail();
  return image;
}

std::string EncodePngFile(const Image& image, int compression) {
  std::string bytes;
  // Grown ahead, so that appending inside libpng's frames is unlikely to allocate.
  bytes.reserve(image.Bytes().size() / 2 + 4096);
  WriteState state{&bytes, ""};
  Writer writer(&state);
  if (!writer.info) throw Error("PNG encoder: out of memory", ErrorKind::kSystem);
  const PngHeader header{image.width(), image.height(), image.channels(),
                         image.type() == PixelType::kUint16 ? 16 : 8};
  const auto* data = reinterpret_cast<const unsigned char*>(image.Bytes().data());
  if (!WriteAll(writer.png, writer.info, header, std::clamp(compression, 0, 9), data,
                image.Bytes().size() / image.height())) {
    throw Error(std::string("PNG encoder: ") + state.message, ErrorKind::kSystem);
  }
  return bytes;
}

}  // namespace lfm
