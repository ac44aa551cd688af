// SPDX-License-Identifier: BSD-3-Clause
#include "scan/solver_log.h"

#include <glog/logging.h>

#include <mutex>

namespace lfm {

void SilenceSolverLog() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
}

}  // namespace lfm
