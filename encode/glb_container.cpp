// SPDX-License-Identifier: BSD-3-Clause
#include "encode/glb_container.h"

#include <bit>
#include <cstring>

#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

static_assert(std::endian::native == std::endian::little, "GLB is little endian");

constexpr uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A;
constexpr uint32_t kBinaryChunk = 0x004E4942;
constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

void AppendUint32(std::string& bytes, uint32_t value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

uint32_t ReadUint32(std::string_view bytes, size_t at) {
  uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void PadToFour(std::string& bytes, char filler) {
  bytes.resize((bytes.size() + 3) / 4 * 4, filler);
}

void AppendChunk(std::string& bytes, uint32_t type, const std::string& content) {
  AppendUint32(bytes, static_cast<uint32_t>(content.size()));
  AppendUint32(bytes, type);
  bytes += content;
}

[[noreturn]] void Fail(const std::string& file, const std::string& problem) {
  throw Error(file + ": " + problem + "; run lfm-encode again");
}

// The content of the chunk at `at`, which must be of `type`.
std::string_view ChunkAt(std::string_view bytes, size_t at, uint32_t type,
                         const std::string& file) {
  if (bytes.size() - at < kChunkHeaderBytes) Fail(file, "a GLB chunk is cut off");
  const size_t length = ReadUint32(bytes, at);
  if (ReadUint32(bytes, at + 4) != type) Fail(file, "GLB chunks are not JSON, then binary");
  if (bytes.size() - at - kChunkHeaderBytes < length) Fail(file, "a GLB chunk is cut off");
  return bytes.substr(at + kChunkHeaderBytes, length);
}

}  // namespace

std::string BuildGlb(const GlbContainer& container) {
  std::string json = container.json.dump();
  std::string binary = container.binary;
  PadToFour(json, ' ');
  PadToFour(binary, '\0');
  const size_t total = kHeaderBytes + 2 * kChunkHeaderBytes + json.size() + binary.size();
  if (total > UINT32_MAX) {
    throw Error("model.glb would be larger than 4 GiB, which glTF cannot hold; take fewer terms");
  }
  std::string bytes;
  bytes.reserve(total);
  AppendUint32(bytes, kMagic);
  AppendUint32(bytes, 2);
  AppendUint32(bytes, static_cast<uint32_t>(total));
  AppendChunk(bytes, kJsonChunk, json);
  AppendChunk(bytes, kBinaryChunk, binary);
  return bytes;
}

GlbContainer ParseGlb(std::string_view bytes, const std::string& file) {
  if (bytes.size() < kHeaderBytes || ReadUint32(bytes, 0) != kMagic) {
    Fail(file, "not a GLB file, or cut off");
  }
  if (ReadUint32(bytes, 4) != 2) Fail(file, "not version 2 of GLB");
  if (ReadUint32(bytes, 8) != bytes.size()) Fail(file, "shorter or longer than it says");
  const std::string_view json = ChunkAt(bytes, kHeaderBytes, kJsonChunk, file);
  const size_t after_json = kHeaderBytes + kChunkHeaderBytes + json.size();
  const std::string_view binary = ChunkAt(bytes, after_json, kBinaryChunk, file);
  if (after_json + kChunkHeaderBytes + binary.size() != bytes.size()) {
    Fail(file, "bytes follow the last GLB chunk");
  }
  GlbContainer container;
  container.json = ParseJson(json, file);
  container.binary = binary;
  return container;
}

int ComponentBytes(GltfComponent component) {
  switch (component) {
    case GltfComponent::kUint8:
      return 1;
    case GltfComponent::kUint16:
      return 2;
    default:
      return 4;
  }
}

const char* ShapeName(GltfShape shape) {
  constexpr const char* kNames[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kNames[static_cast<int>(shape) - 1];
}

int GlbBuilder::AddView(const void* data, size_t size, int target) {
  PadToFour(binary_, '\0');
  nlohmann::json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
  if (target != 0) view["target"] = target;
  binary_.append(static_cast<const char*>(data), size);
  json["bufferViews"].push_back(std::move(view));
  return static_cast<int>(json["bufferViews"].size()) - 1;
}

int GlbBuilder::AddAccessor(const void* data, size_t size, GltfComponent component, GltfShape shape,
                            int target) {
  const size_t element = static_cast<size_t>(ComponentBytes(component)) * static_cast<int>(shape);
  const int view = AddView(data, size, target);
  json["accessors"].push_back({{"bufferView", view},
                               {"componentType", static_cast<int>(component)},
                               {"count", size / element},
                               {"type", ShapeName(shape)}});
  return static_cast<int>(json["accessors"].size()) - 1;
}

int GlbBuilder::AddPng(std::span<const std::byte> png, const std::string& name) {
  const int view = AddView(png.data(), png.size());
  json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}, {"name", name}});
  return static_cast<int>(json["images"].size()) - 1;
}

GlbContainer GlbBuilder::Finish() {
  PadToFour(binary_, '\0');
  json["buffers"] = nlohmann::json::array({{{"byteLength", binary_.size()}}});
  return {std::move(json), std::move(binary_)};
}

}  // namespace lfm
