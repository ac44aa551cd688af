// SPDX-License-Identifier: BSD-3-Clause
#include "core/hash.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <vector>

#include "core/error.h"

namespace lfm {

uint64_t Checksum(const void* data, size_t size) { return XXH3_64bits(data, size); }

std::string FileFingerprint(const std::filesystem::path& file) {
  constexpr uint64_t kSample = 4096;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return "";
  const uint64_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) return "";
  Hasher hasher;
  hasher.Add(std::to_string(size));
  std::string sample(std::min(kSample, size), '\0');
  const uint64_t last = size - sample.size();
  for (const uint64_t start : {uint64_t{0}, last / 2, last}) {
    stream.seekg(static_cast<std::streamoff>(start));
    stream.read(sample.data(), static_cast<std::streamsize>(sample.size()));
    if (!stream) return "";
    hasher.Add(sample);
  }
  return hasher.HexDigest();
}

struct Hasher::State {
  XXH3_state_t* xxh = XXH3_createState();
  State() { XXH3_128bits_reset(xxh); }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

Hasher::Hasher() : state_(std::make_unique<State>()) {}
Hasher::~Hasher() = default;
Hasher::Hasher(Hasher&&) noexcept = default;
Hasher& Hasher::operator=(Hasher&&) noexcept = default;

Hasher& Hasher::Add(std::string_view piece) {
  const uint64_t length = piece.size();
  XXH3_128bits_update(state_->xxh, &length, sizeof length);
  XXH3_128bits_update(state_->xxh, piece.data(), piece.size());
  return *this;
}

Hasher& Hasher::AddFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be read; check that it exists");
  std::vector<char> buffer(1 << 20);
  uint64_t length = 0;
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    XXH3_128bits_update(state_->xxh, buffer.data(), static_cast<size_t>(stream.gcount()));
    length += static_cast<uint64_t>(stream.gcount());
  }
  if (stream.bad()) throw Error(file.string() + ": reading failed", ErrorKind::kSystem);
  XXH3_128bits_update(state_->xxh, &length, sizeof length);
  return *this;
}

std::string Hasher::HexDigest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

}  // namespace lfm
