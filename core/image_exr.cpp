// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/image_codecs.h"

namespace lfm {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(const EncodedImage& file) : IStream(file.name.c_str()), file_(file) {}
  bool read(char out[], int count) override {
    if (count < 0 || static_cast<size_t>(count) > file_.size - position_) {
      throw Error("the file is truncated");
    }
    std::memcpy(out, file_.data + position_, count);
    position_ += count;
    return position_ < file_.size;
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override {
    if (position > file_.size) throw Error("the file is truncated");
    position_ = position;
  }

 private:
  const EncodedImage& file_;
  size_t position_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("memory") {}
  void write(const char bytes[], int count) override {
    if (position_ + count > bytes_.size()) bytes_.resize(position_ + count);
    std::memcpy(bytes_.data() + position_, bytes, count);
    position_ += count;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t position_ = 0;
};

/// The colour channels of a file in the order of our pixels.
std::vector<std::string> ChannelNames(const Imf::ChannelList& channels) {
  const bool alpha = channels.findChannel("A") != nullptr;
  std::vector<std::string> names;
  if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B")) {
    names = {"R", "G", "B"};
  } else if (channels.findChannel("Y") && !channels.findChannel("RY")) {
    names = {"Y"};
  } else {
    throw Error("it has neither channels R, G, B nor Y alone");
  }
  for (const std::string& name : names) {
    const Imf::Channel& channel = channels[name.c_str()];
    if (channel.xSampling != 1 || channel.ySampling != 1) throw Error("subsampled channels");
  }
  if (alpha) names.push_back("A");
  return names;
}

/// Walks over the header's attributes (name, type, length, value) and finds the size of the
/// picture, before OpenEXR takes memory for any length that a forged header promises.
void ExamineHeader(const EncodedImage& file) {
  constexpr uint32_t kDeepOrMultiPart = 0x800 | 0x1000;
  MemoryInput input(file);
  const auto read_int = [&]() {
    unsigned char b[4];
    input.read(reinterpret_cast<char*>(b), 4);
    return static_cast<int32_t>(b[0] | b[1] << 8 | b[2] << 16 | static_cast<uint32_t>(b[3]) << 24);
  };
  const auto read_text = [&]() {
    std::string text;
    for (char c = 1; c;) {
      input.read(&c, 1);
      if (c) text.push_back(c);
      if (text.size() > 255) throw Error("an attribute's name does not end");
    }
    return text;
  };
  read_int();
  if (static_cast<uint32_t>(read_int()) & kDeepOrMultiPart) {
    throw Error("deep and multi-part files are not supported");
  }
  bool found = false;
  for (std::string name = read_text(); !name.empty(); name = read_text()) {
    read_text();
    const int32_t length = read_int();
    const uint64_t value = input.tellg();
    if (length < 0 || static_cast<uint64_t>(length) > file.size - value) {
      throw Error("the file is truncated");
    }
    if (name == "dataWindow" && length == 16) {
      const int64_t x0 = read_int(), y0 = read_int(), x1 = read_int(), y1 = read_int();
      RequirePlausibleSize(file, x1 - x0 + 1, y1 - y0 + 1, 4 * sizeof(float));
      found = true;
    }
    input.seekg(value + length);
  }
  if (!found) throw Error("the header does not tell the picture's size");
}

Imf::FrameBuffer MakeFrameBuffer(float* data, const std::vector<std::string>& names, int64_t width,
                                 int64_t x0, int64_t y0) {
  const int64_t channels = static_cast<int64_t>(names.size());
  // OpenEXR addresses pixels from the origin of its data window's coordinates. The address is
  // computed as a number, since it may lie outside the buffer.
  const auto origin =
      reinterpret_cast<intptr_t>(data) - static_cast<intptr_t>((y0 * width + x0) * channels * 4);
  Imf::FrameBuffer buffer;
  for (int64_t c = 0; c < channels; ++c) {
    buffer.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(origin + 4 * c),
                                       4 * channels, 4 * channels * width));
  }
  return buffer;
}

Image DecodeExrOrThrow(const EncodedImage& file) {
  MemoryInput input(file);
  Imf::InputFile exr(input);
  if (!exr.isComplete()) throw Error("the file is truncated");
  const Imath::Box2i window = exr.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  const std::vector<std::string> names = ChannelNames(exr.header().channels());
  Image image(width, height, static_cast<int>(names.size()), PixelType::kFloat32,
              ColorEncoding::kLinear);
  exr.setFrameBuffer(
      MakeFrameBuffer(image.Data<float>(), names, width, window.min.x, window.min.y));
  exr.readPixels(window.min.y, window.max.y);
  return image;
}

}  // namespace

Image DecodeExr(const EncodedImage& file) {
  const auto fail = [&](const std::string& why) -> Error {
    return Error(file.name + ": not an EXR picture that can be read (" +
                 why.substr(0, why.find('\n')) + "); copy or save it again");
  };
  try {
    ExamineHeader(file);
    return DecodeExrOrThrow(file);
  } catch (const Error& error) {
    const std::string message = error.what();
    if (message.rfind(file.name, 0) == 0) throw;
    throw fail(message);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw fail(error.what());
  }
}

std::string EncodeExr(const Image& image) {
  const std::vector<std::string> all[] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  const std::vector<std::string>& names = all[image.channels() - 1];
  Imf::Header header(image.width(), image.height());
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  MemoryOutput output;
  {
    Imf::OutputFile exr(output, header);
    float* data = const_cast<float*>(image.Data<float>());  // OpenEXR's slices are never const.
    exr.setFrameBuffer(MakeFrameBuffer(data, names, image.width(), 0, 0));
    exr.writePixels(image.height());
  }
  return output.Take();
}

}  // namespace lfm
