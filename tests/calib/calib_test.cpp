// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "rendered_board.h"

namespace lfm {
namespace {

TEST(Calibrate, RecoversIntrinsicsAndPosesFromRenderedPictures) {
  const Board board = DefaultBoard();
  const RenderedCapture rendered = RenderCapture(board, 10, 2);
  const CalibResult result =
      Calibrate(rendered.capture, board, rendered.Loader(), {}, SilentProgress());
  for (const RejectedImage& image : result.rejected) ADD_FAILURE() << image.id << image.reason;
  const Camera& camera = result.cameras.at("photo");
  std::printf("f %.3f %.3f c %.3f %.3f k %.5f %.5f %.5f p %.5f %.5f rms %.4f noise %.4f\n",
              camera.fx, camera.fy, camera.cx, camera.cy, camera.k1, camera.k2, camera.k3,
              camera.p1, camera.p2, result.reprojection_rms_px, result.corner_noise_px);
  for (size_t i = 0; i < result.photos.size(); ++i) {
    const Pose& pose = result.photos[i].camera_from_world;
    std::printf("%zu: corners %d rms %.4f centre %.4f mm rot %.5f deg  sigma %.4f\n", i,
                result.photos[i].corners, result.photos[i].reprojection_rms_px,
                (pose.Center() - rendered.poses[i].Center()).norm(),
                RotationAngle(pose.rotation, rendered.poses[i].rotation) * 57.3,
                std::sqrt(result.photos[i].covariance(5, 5)));
  }
}

}  // namespace
}  // namespace lfm
