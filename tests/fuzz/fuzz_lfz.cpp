// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <string>

#include "core/hash.h"
#include "encode/transport_form.h"
#include "encode/transport_stream.h"
#include "tests/fuzz/fuzz_one.h"

namespace lfm::testing {
namespace {

// Lengths and checksums of the parts: a part that claims more than there is takes the rest.
void Repair(std::string& bytes) {
  size_t place = sizeof(transport::FileHeader);
  while (place + sizeof(transport::PartHeader) <= bytes.size()) {
    transport::PartHeader part;
    std::memcpy(&part, bytes.data() + place, sizeof part);
    const size_t content = place + sizeof part;
    part.bytes = std::min<uint64_t>(part.bytes, bytes.size() - content);
    part.checksum = Checksum(bytes.data() + content, part.bytes);
    std::memcpy(bytes.data() + place, &part, sizeof part);
    place = content + part.bytes;
  }
}

}  // namespace

void FuzzOne(std::span<const uint8_t> input) {
  std::string bytes(reinterpret_cast<const char*>(input.data()), input.size());
  Repair(bytes);
  UseModel(DecodeTransport(bytes, "model.lfz").model);
}

}  // namespace lfm::testing
