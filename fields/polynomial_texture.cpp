// SPDX-License-Identifier: BSD-3-Clause
#include "fields/polynomial_texture.h"

namespace lfm {

Eigen::VectorXd PolynomialTerms(const Eigen::Vector3d& local) {
  const double lu = local.x(), lv = local.y();
  Eigen::VectorXd terms(6);
  terms << lu * lu, lv * lv, lu * lv, lu, lv, 1;
  return terms;
}

}  // namespace lfm
