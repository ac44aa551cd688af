// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer's entry points.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/model_evaluation.h"
#include "tests/fuzz/fuzz_one.h"

namespace lfm::testing {

void UseModel(const LightFieldModel& model) {
  constexpr int kMostTriangles = 1000;  // more of them are more of the same
  const int count = std::min(static_cast<int>(model.placements.size()), kMostTriangles);
  for (int t = 0; t < count; ++t) {
    for (const Eigen::Vector3d& weights :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0.5, 0.5), Eigen::Vector3d(0.2, 0.3, 0.5)}) {
      for (const Eigen::Vector3d& to_eye :
           {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(-0.8, 0.6, 0)}) {
        const Eigen::Vector3f color = EvaluateModel(model, t, weights, to_eye);
        if (!color.allFinite()) std::abort();
      }
    }
  }
}

}  // namespace lfm::testing

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  lfm::SetThreadCount(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    lfm::testing::FuzzOne({data, size});
  } catch (const lfm::Error& error) {
    // What is the input's fault is said in one line.
    if (error.kind() != lfm::ErrorKind::kInput) std::abort();
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
