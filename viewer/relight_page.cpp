// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/relight_page.h"

#include <Eigen/LU>
#include <cstdio>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/markup_text.h"
#include "viewer/page_marks.h"
#include "viewer/web_bundle.h"

namespace lfm {
namespace {

bool IsRotation(const Eigen::Matrix3d& r) {
  constexpr double kRotation_abs = 1e-6;
  return r.allFinite() && (r * r.transpose()).isIdentity(kRotation_abs) && r.determinant() > 0;
}

// Nine numbers, row by row; none without a camera.
std::string CameraText(const std::optional<Eigen::Matrix3d>& camera_from_world) {
  if (!camera_from_world) return "";
  if (!IsRotation(*camera_from_world)) throw Error("the camera of a page has no proper rotation");
  std::string text;
  for (int i = 0; i < 9; ++i) {
    char number[32];
    std::snprintf(number, sizeof(number), "%s%.12g", i == 0 ? "" : " ",
                  (*camera_from_world)(i / 3, i % 3));
    text += number;
  }
  return text;
}

}  // namespace

void WriteRelightPages(std::string_view lfr, const std::string& title,
                       const std::filesystem::path& folder,
                       const std::optional<Eigen::Matrix3d>& camera_from_world) {
  if (lfr.empty()) throw Error("a page for relighting needs a model");
  const std::string camera = CameraText(camera_from_world);
  // The title last: it may be anything, what stands before holds no mark.
  const auto fill = [&](std::string_view page) {
    return FillMark(FillMark(page, kCameraMark, camera), kTitleMark, EscapeMarkup(title));
  };
  WriteFilesTogether(folder, [&](const std::filesystem::path& files) {
    WriteFileAtomically(files / "model.lfr", lfr);
    WriteFileAtomically(files / "app.js", web_bundle::RelightAppJs());
    WriteFileAtomically(files / "index.html", fill(web_bundle::RelightIndexHtml()));
    WriteFileAtomically(files / "relight.html",
                        fill(FillMark(web_bundle::RelightSingleHtml(), kModelMark, Base64(lfr))));
  });
}

}  // namespace lfm
