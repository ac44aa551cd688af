// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace lfm {

/// Peak resident memory of this process so far, in MiB (0 where the system does not tell).
double PeakMemoryMib();

/// Resident memory of this process now, in bytes (0 where the system does not tell), mapped pages
/// of files included. What was freed is given back to the system first.
int64_t ResidentMemoryBytes();

/// Memory that the machine could give to processes now, in bytes (the largest number where it does
/// not tell).
int64_t AvailableMemoryBytes();

/// A bound on the resident memory of this process, for work that can be cut to fit, or refused.
class MemoryLimit {
 public:
  /// 0: what the machine has. `option` is what sets it, for messages.
  explicit MemoryLimit(int limit_mib, const char* option = "--memory-mib")
      : limit_mib_(limit_mib), option_(option) {}

  /// Of the limit, not resident now; negative when it is exceeded.
  int64_t BytesLeft() const;
  /// Throws Error in one line when fewer than `bytes` are left: what the option must be at least,
  /// for `what`, and the `cure` beside raising it.
  void Require(int64_t bytes, const std::string& what, const std::string& cure) const;

 private:
  int limit_mib_;
  const char* option_;
};

}  // namespace lfm
