// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <string>

#include "encode/glb.h"
#include "tests/fuzz/fuzz_one.h"

namespace lfm::testing {
namespace {

// The lengths of the file and of its chunks, where a mutation has left room for them; a shorter or
// longer JSON text is padded with spaces, as the format says.
void Repair(std::string& bytes) {
  constexpr size_t kHeader = 12, kChunkHeader = 8;
  if (bytes.size() < kHeader + kChunkHeader) return;
  const auto word = [&](size_t at) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  const auto set = [&](size_t at, size_t value) {
    const auto number = static_cast<uint32_t>(value);
    std::memcpy(bytes.data() + at, &number, sizeof number);
  };
  // The binary chunk is where its name stands, whatever the length before it says.
  const size_t binary = bytes.find(std::string("BIN\0", 4));
  if (binary != std::string::npos && binary >= kHeader + kChunkHeader + 4) {
    const size_t text_end = binary - 4;
    bytes.insert(text_end, (4 - text_end % 4) % 4, ' ');
    bytes.append((4 - bytes.size() % 4) % 4, '\0');
    const size_t start = text_end + (4 - text_end % 4) % 4;
    set(kHeader, start - kHeader - kChunkHeader);
    set(start, bytes.size() - start - kChunkHeader);
  } else if (word(kHeader) > bytes.size()) {
    set(kHeader, bytes.size() - kHeader - kChunkHeader);
  }
  set(8, bytes.size());
}

}  // namespace

void FuzzOne(std::span<const uint8_t> input) {
  std::string bytes(reinterpret_cast<const char*>(input.data()), input.size());
  Repair(bytes);
  UseModel(ReadGlbBytes(bytes, "model.glb"));
}

}  // namespace lfm::testing
