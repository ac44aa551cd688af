// SPDX-License-Identifier: BSD-3-Clause
#include "fields/matrix_room.h"

#include <limits>

#include "core/process_memory.h"
#include "fields/function_rows.h"

namespace lfm {

void RequireRoom(int64_t rows, int64_t columns, const std::string& name, const std::string& cure) {
  constexpr int64_t kBytes = sizeof(float);
  const int64_t stride =
      (columns + FunctionRows::kLane - 1) / FunctionRows::kLane * FunctionRows::kLane;
  if (stride < 1 || rows < 0 || rows > std::numeric_limits<int64_t>::max() / kBytes / stride)
    return;
  MemoryLimit(0).Require(rows * stride * kBytes,
                         name + ": the matrix of " + std::to_string(rows) + " functions over " +
                             std::to_string(columns) + " directions",
                         cure);
}

}  // namespace lfm
