// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_linear_programme.h"

#include <glpk.h>

#include <memory>
#include <mutex>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

// GLPK keeps an environment a thread, where it is built so, else one for all.
std::unique_lock<std::mutex> LockUnlessThreaded() {
  static std::mutex mutex;
  return glp_config("TLS") ? std::unique_lock<std::mutex>() : std::unique_lock(mutex);
}

struct Environment {
  std::unique_lock<std::mutex> lock = LockUnlessThreaded();
  Environment() { glp_term_out(GLP_OFF); }
  ~Environment() { glp_free_env(); }
};

struct DeleteProgramme {
  void operator()(glp_prob* programme) const { glp_delete_prob(programme); }
};
using Programme = std::unique_ptr<glp_prob, DeleteProgramme>;

Programme BuildProgramme(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                         ResidualSign sign) {
  const int terms = static_cast<int>(functions.rows()), rows = static_cast<int>(functions.cols());
  const int parts = sign == ResidualSign::kPositive ? 1 : 2;
  Programme programme(glp_create_prob());
  glp_set_obj_dir(programme.get(), GLP_MIN);
  glp_add_rows(programme.get(), rows);
  glp_add_cols(programme.get(), terms + parts * rows);
  for (int j = 0; j < rows; ++j) glp_set_row_bnds(programme.get(), j + 1, GLP_FX, target[j], 0);
  std::vector<int> row(static_cast<size_t>(rows) + 1);
  std::vector<double> value(static_cast<size_t>(rows) + 1);
  for (int t = 0; t < terms; ++t) {
    for (int j = 0; j < rows; ++j) {
      row[j + 1] = j + 1;
      value[j + 1] = functions(t, j);
    }
    glp_set_col_bnds(programme.get(), t + 1, GLP_FR, 0, 0);
    glp_set_mat_col(programme.get(), t + 1, rows, row.data(), value.data());
  }
  for (int part = 0; part < parts; ++part) {
    for (int j = 0; j < rows; ++j) {
      const int column = terms + part * rows + j + 1;
      const int at[] = {0, j + 1};
      const double one[] = {0, part == 0 ? 1.0 : -1.0};
      glp_set_col_bnds(programme.get(), column, GLP_LO, 0, 0);
      glp_set_obj_coef(programme.get(), column, 1);
      glp_set_mat_col(programme.get(), column, 1, at, one);
    }
  }
  return programme;
}

// Where x is 0 and the residual is the target: feasible, unless a sign is wrong.
void StartAtZero(glp_prob& programme, const Eigen::VectorXd& target, int terms) {
  const int rows = static_cast<int>(target.size());
  const bool two_sided = glp_get_num_cols(&programme) > terms + rows;
  for (int t = 0; t < terms; ++t) glp_set_col_stat(&programme, t + 1, GLP_NF);
  for (int j = 0; j < rows; ++j) {
    const bool below = two_sided && target[j] < 0;
    glp_set_row_stat(&programme, j + 1, GLP_NS);
    glp_set_col_stat(&programme, terms + j + 1, below ? GLP_NL : GLP_BS);
    if (two_sided) glp_set_col_stat(&programme, terms + rows + j + 1, below ? GLP_BS : GLP_NL);
  }
}

// The status reached. From its own start the method finds feasible programmes infeasible now and
// then: then from a better one.
int Simplex(glp_prob& programme, const Eigen::VectorXd& target, int terms) {
  glp_smcp parameters;
  glp_init_smcp(&parameters);
  parameters.msg_lev = GLP_MSG_OFF;
  parameters.tol_bnd = parameters.tol_dj = 1e-9;
  const bool done = glp_simplex(&programme, &parameters) == 0;
  if (done && glp_get_status(&programme) == GLP_OPT) return GLP_OPT;
  StartAtZero(programme, target, terms);
  return glp_simplex(&programme, &parameters) == 0 ? glp_get_status(&programme) : GLP_UNDEF;
}

}  // namespace

std::optional<Eigen::VectorXd> SolveLinearProgramme(const Eigen::MatrixXd& functions,
                                                    const Eigen::VectorXd& target,
                                                    ResidualSign sign) {
  const Environment environment;
  const Programme programme = BuildProgramme(functions, target, sign);
  const int status = Simplex(*programme, target, static_cast<int>(functions.rows()));
  if (status == GLP_NOFEAS && sign == ResidualSign::kPositive) return std::nullopt;
  if (status != GLP_OPT) throw Error("the linear programme was not solved", ErrorKind::kSystem);
  Eigen::VectorXd weights(functions.rows());
  for (Eigen::Index t = 0; t < weights.size(); ++t) {
    weights[t] = glp_get_col_prim(programme.get(), static_cast<int>(t) + 1);
  }
  return weights;
}

}  // namespace lfm
