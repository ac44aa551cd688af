// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {

/// A sphere of 128 triangles, n = 5 and 9.
inline LightFieldModel MakeSphereModel(const EncodeOptions& options, const Appearance& appearance) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(2), 12, 120, [](int t) { return t % 2 == 0 ? 5 : 9; }, appearance);
  return Encode(field.Source(), options, SilentProgress()).model;
}

/// With as many terms as needed for 50 dB.
inline const LightFieldModel& GlossyModel() {
  static const LightFieldModel model = MakeSphereModel({.target_db = 50,
                                                        .max_terms = 6,
                                                        .patch_detail = MapDetail::kFull,
                                                        .view_detail = MapDetail::kFull,
                                                        .transport_db = 0},
                                                       GlossyAppearance);
  return model;
}

/// The same model with a vertex more, of no triangle.
inline LightFieldModel WithIsolatedVertex(LightFieldModel model) {
  model.mesh.vertices.push_back({100, 0, 0});
  model.mesh.normals.push_back({0, 0, 1});
  model.vertex_frames.push_back(Eigen::Matrix3d::Identity());
  std::vector<MapRange> surface, view;
  const size_t vertices = model.vertex_terms.size();
  for (int k = 0; k < model.terms; ++k) {
    for (size_t v = 0; v < vertices; ++v) {
      surface.push_back(model.surface_ranges[k * vertices + v]);
      view.push_back(model.view_ranges[k * vertices + v]);
    }
    surface.push_back({0, 0});
    view.push_back({0, 0});
  }
  model.surface_ranges = surface;
  model.view_ranges = view;
  for (std::vector<int>& tiles : model.view_codes) tiles.push_back(0);
  model.vertex_terms.push_back(0);
  model.guessed.clear();  // not known of the new vertex
  model.view_slots = RankByTerms(model.vertex_terms);
  return model;
}

/// PSNR of the colours that two models of one mesh show from in front and aside.
inline double ShownPsnr(const LightFieldModel& a, const LightFieldModel& b) {
  double sum = 0;
  int count = 0;
  for (int t = 0; t < static_cast<int>(a.placements.size()); ++t) {
    for (const Eigen::Vector3d& tilt :
         {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, -0.5, 0.2)}) {
      const Eigen::Vector3d to_eye = (TriangleNormal(a.mesh, t) + tilt).normalized();
      for (const Eigen::Vector3d& w :
           {Eigen::Vector3d(0.3, 0.3, 0.4), Eigen::Vector3d(0.8, 0.1, 0.1)}) {
        sum += (EvaluateModel(a, t, w, to_eye) - EvaluateModel(b, t, w, to_eye)).squaredNorm();
        count += 3;
      }
    }
  }
  return -10 * std::log10(sum / count + 1e-12);
}

}  // namespace lfm::testing
