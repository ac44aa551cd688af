// SPDX-License-Identifier: BSD-3-Clause
#include "bench/jpeg_xl.h"

#include <jxl/decode_cxx.h>
#include <jxl/encode_cxx.h>

#include <algorithm>
#include <vector>

#include "core/error.h"

namespace lfm::bench {
namespace {

void Require(bool done, const char* what) {
  if (!done) throw Error(std::string("libjxl cannot ") + what, ErrorKind::kSystem);
}

struct Samples {
  int width = 0, height = 0, channels = 1;
  std::vector<uint8_t> values;
};

std::vector<uint8_t> Encode(const Samples& samples, float distance) {
  const JxlEncoderPtr encoder = JxlEncoderMake(nullptr);
  JxlBasicInfo info;
  JxlEncoderInitBasicInfo(&info);
  info.xsize = static_cast<uint32_t>(samples.width);
  info.ysize = static_cast<uint32_t>(samples.height);
  info.bits_per_sample = 8;
  info.num_color_channels = static_cast<uint32_t>(samples.channels);
  info.uses_original_profile = distance == 0 ? JXL_TRUE : JXL_FALSE;
  Require(JxlEncoderSetBasicInfo(encoder.get(), &info) == JXL_ENC_SUCCESS, "take the size");
  JxlColorEncoding color;
  JxlColorEncodingSetToSRGB(&color, samples.channels == 1 ? JXL_TRUE : JXL_FALSE);
  Require(JxlEncoderSetColorEncoding(encoder.get(), &color) == JXL_ENC_SUCCESS, "take sRGB");
  JxlEncoderFrameSettings* settings = JxlEncoderFrameSettingsCreate(encoder.get(), nullptr);
  JxlEncoderFrameSettingsSetOption(settings, JXL_ENC_FRAME_SETTING_EFFORT, 7);
  if (distance == 0) {
    JxlEncoderSetFrameLossless(settings, JXL_TRUE);
  } else {
    JxlEncoderSetFrameDistance(settings, distance);
  }
  const JxlPixelFormat format = {static_cast<uint32_t>(samples.channels), JXL_TYPE_UINT8,
                                 JXL_NATIVE_ENDIAN, 0};
  Require(JxlEncoderAddImageFrame(settings, &format, samples.values.data(),
                                  samples.values.size()) == JXL_ENC_SUCCESS,
          "take the picture");
  JxlEncoderCloseInput(encoder.get());
  std::vector<uint8_t> bytes(1 << 16);
  uint8_t* next = bytes.data();
  size_t left = bytes.size();
  JxlEncoderStatus status = JxlEncoderProcessOutput(encoder.get(), &next, &left);
  while (status == JXL_ENC_NEED_MORE_OUTPUT) {
    const auto written = static_cast<size_t>(next - bytes.data());
    bytes.resize(2 * bytes.size());
    next = bytes.data() + written;
    left = bytes.size() - written;
    status = JxlEncoderProcessOutput(encoder.get(), &next, &left);
  }
  Require(status == JXL_ENC_SUCCESS, "encode");
  bytes.resize(static_cast<size_t>(next - bytes.data()));
  return bytes;
}

Samples Decode(const std::vector<uint8_t>& bytes, const Samples& like) {
  Samples samples = like;
  const JxlDecoderPtr decoder = JxlDecoderMake(nullptr);
  JxlDecoderSubscribeEvents(decoder.get(), JXL_DEC_FULL_IMAGE);
  JxlDecoderSetInput(decoder.get(), bytes.data(), bytes.size());
  JxlDecoderCloseInput(decoder.get());
  Require(JxlDecoderProcessInput(decoder.get()) == JXL_DEC_NEED_IMAGE_OUT_BUFFER, "decode");
  const JxlPixelFormat format = {static_cast<uint32_t>(like.channels), JXL_TYPE_UINT8,
                                 JXL_NATIVE_ENDIAN, 0};
  Require(JxlDecoderSetImageOutBuffer(decoder.get(), &format, samples.values.data(),
                                      samples.values.size()) == JXL_DEC_SUCCESS,
          "give the picture");
  Require(JxlDecoderProcessInput(decoder.get()) == JXL_DEC_FULL_IMAGE, "decode");
  return samples;
}

}  // namespace

JpegXlPicture ThroughJpegXl(const Image& image, float distance, Channels channels) {
  JpegXlPicture picture{image, 0};
  const size_t count = static_cast<size_t>(image.width()) * image.height();
  const int planes = channels == Channels::kApart ? 3 : 1, own = 3 / planes;
  uint8_t* out = picture.image.Data<uint8_t>();
  for (int plane = 0; plane < planes; ++plane) {
    Samples samples{image.width(), image.height(), own, std::vector<uint8_t>(own * count)};
    for (size_t i = 0; i < count; ++i) {
      std::copy_n(out + 3 * i + plane, own, samples.values.data() + own * i);
    }
    const std::vector<uint8_t> bytes = Encode(samples, distance);
    picture.bytes += static_cast<int64_t>(bytes.size());
    samples = Decode(bytes, samples);
    for (size_t i = 0; i < count; ++i) {
      std::copy_n(samples.values.data() + own * i, own, out + 3 * i + plane);
    }
  }
  return picture;
}

}  // namespace lfm::bench
