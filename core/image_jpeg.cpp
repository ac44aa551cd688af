// SPDX-License-Identifier: BSD-3-Clause
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <memory>
//
#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>

#include "core/error.h"
#include "core/image_codecs.h"

// libjpeg reports errors by a long jump: see image_png.cpp.

namespace lfm {
namespace {

struct ErrorState {
  jpeg_error_mgr manager;  // first, so that a pointer to it is a pointer to the whole
  jmp_buf jump;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void OnError(j_common_ptr info) {
  auto* state = reinterpret_cast<ErrorState*>(info->err);
  info->err->format_message(info, state->message);
  std::longjmp(state->jump, 1);
}

/// libjpeg fills what is missing with gray and goes on: for a measurement that is an error. Stray
/// bytes between segments, which some cameras write, lose nothing.
void OnMessage(j_common_ptr info, int level) {
  if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) OnError(info);
}

void InstallErrorState(ErrorState* state, jpeg_error_mgr** place) {
  *place = jpeg_std_error(&state->manager);
  state->manager.error_exit = OnError;
  state->manager.emit_message = OnMessage;
  state->message[0] = '\0';
}

bool ReadHeader(jpeg_decompress_struct* jpeg, ErrorState* state, const EncodedImage& file) {
  if (setjmp(state->jump)) return false;
  jpeg_mem_src(jpeg, file.data, static_cast<unsigned long>(file.size));
  jpeg_read_header(jpeg, TRUE);
  jpeg->out_color_space = jpeg->num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_calc_output_dimensions(jpeg);
  return true;
}

bool ReadRows(jpeg_decompress_struct* jpeg, ErrorState* state, uint8_t* data, size_t stride) {
  if (setjmp(state->jump)) return false;
  jpeg_start_decompress(jpeg);
  while (jpeg->output_scanline < jpeg->output_height) {
    JSAMPROW row = data + jpeg->output_scanline * stride;
    jpeg_read_scanlines(jpeg, &row, 1);
  }
  jpeg_finish_decompress(jpeg);
  return true;
}

bool WriteAll(jpeg_compress_struct* jpeg, ErrorState* state, const Image& image, int quality,
              unsigned char** buffer, unsigned long* size) {
  if (setjmp(state->jump)) return false;
  jpeg_mem_dest(jpeg, buffer, size);
  jpeg->image_width = image.width();
  jpeg->image_height = image.height();
  jpeg->input_components = image.channels();
  jpeg->in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(jpeg);
  jpeg_set_quality(jpeg, quality, TRUE);
  // No chroma subsampling: colour at silhouettes and highlights is data here.
  jpeg->comp_info[0].h_samp_factor = 1;
  jpeg->comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(jpeg, TRUE);
  const uint8_t* data = image.Data<uint8_t>();
  const size_t stride = static_cast<size_t>(image.width()) * image.channels();
  while (jpeg->next_scanline < jpeg->image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(data + jpeg->next_scanline * stride);
    jpeg_write_scanlines(jpeg, &row, 1);
  }
  jpeg_finish_compress(jpeg);
  return true;
}

struct Decompressor {
  explicit Decompressor(ErrorState* state) {
    InstallErrorState(state, &jpeg.err);
    jpeg_create_decompress(&jpeg);
  }
  ~Decompressor() { jpeg_destroy_decompress(&jpeg); }
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
  jpeg_decompress_struct jpeg{};
};

struct Compressor {
  explicit Compressor(ErrorState* state) {
    InstallErrorState(state, &jpeg.err);
    jpeg_create_compress(&jpeg);
  }
  ~Compressor() { jpeg_destroy_compress(&jpeg); }
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;
  jpeg_compress_struct jpeg{};
};

}  // namespace

Image DecodeJpeg(const EncodedImage& file) {
  ErrorState state;
  Decompressor reader(&state);
  const auto fail = [&]() {
    throw Error(file.name + ": not a whole JPEG picture (" + state.message + "); copy it again");
  };
  if (!ReadHeader(&reader.jpeg, &state, file)) fail();
  const int channels = reader.jpeg.out_color_components;
  RequirePlausibleSize(file, reader.jpeg.output_width, reader.jpeg.output_height, channels);
  Image image(static_cast<int>(reader.jpeg.output_width),
              static_cast<int>(reader.jpeg.output_height), channels, PixelType::kUint8,
              ColorEncoding::kSrgb);
  if (!ReadRows(&reader.jpeg, &state, image.Data<uint8_t>(),
                static_cast<size_t>(image.width()) * channels)) {
    fail();
  }
  return image;
}

std::string EncodeJpeg(const Image& image, int quality) {
  ErrorState state;
  Compressor writer(&state);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const bool written =
      WriteAll(&writer.jpeg, &state, image, std::clamp(quality, 1, 100), &buffer, &size);
  const std::unique_ptr<unsigned char, decltype(&std::free)> owner(buffer, &std::free);
  if (!written) throw Error(std::string("JPEG encoder: ") + state.message);
  return std::string(reinterpret_cast<const char*>(buffer), size);
}

}  // namespace lfm
