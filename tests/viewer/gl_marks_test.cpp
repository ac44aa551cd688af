// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_marks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_picture.h"

namespace lfm {
namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr double kSide_abs = 1e-9;
constexpr double kCode_abs = 2;  // of 255: rounding, and normals from differences of pixels
const Eigen::Vector3f kBackground = {0.2f, 0.1f, 0.4f};

Camera TestCamera(double focal_px) {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = focal_px;
  camera.fy = 0.9 * focal_px;
  camera.cx = 104.2;  // off centre: a picture mirrored or half a pixel off would show
  camera.cy = 76.7;
  return camera;
}

Pose TestPose() { return LookAt({260, -190, 150}, {3, 5, -2}, {0.1, 0.2, 1}); }

Placement TestPlacement() {
  Placement placement;
  placement.world_from_model.rotation =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  placement.world_from_model.translation = {8, -4, 5};
  placement.scale = 0.6;
  return placement;
}

/// A mesh of one triangle whose corners stand at these pixels and depths, in the model's frame.
TriangleMesh TriangleAt(const GlView& view, const Placement& placement,
                        const std::vector<Eigen::Vector3d>& pixels_and_depths) {
  TriangleMesh mesh;
  for (const Eigen::Vector3d& corner : pixels_and_depths) {
    const Eigen::Vector3d direction = Unproject(view.camera, corner.head<2>());
    const Eigen::Vector3d in_world =
        view.camera_from_world.Inverse() * (direction * (corner.z() / direction.z()));
    mesh.vertices.emplace_back(placement.world_from_model.Inverse() * in_world / placement.scale);
  }
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// What corners' colours look like at a pixel: barycentric weights of where its ray meets the
/// triangle's plane, and the shading factor. Second: the least weight.
std::pair<Eigen::Vector3f, double> ShownAt(const GlView& view, const Placement& placement,
                                           const TriangleMesh& mesh,
                                           const std::vector<Eigen::Vector3f>& colors, int x,
                                           int y) {
  Eigen::Matrix3d corners;  // in the camera's frame
  for (int c = 0; c < 3; ++c) {
    corners.col(c) = view.camera_from_world * (placement * mesh.vertices[c]);
  }
  const Eigen::Vector3d ray = Unproject(view.camera, {x, y});
  Eigen::Vector3d weights = corners.inverse() * ray;
  weights /= weights.sum();
  const Eigen::Vector3d normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
  const double facing = std::abs(normal.dot(ray));
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  for (int c = 0; c < 3; ++c) color += static_cast<float>(weights[c]) * colors[c];
  return {color * static_cast<float>(0.4 + 0.6 * facing), weights.minCoeff()};
}

Eigen::Vector3d CodesAt(const Image& image, int x, int y) {
  return {static_cast<double>(image.At<uint8_t>(x, y, 0)),
          static_cast<double>(image.At<uint8_t>(x, y, 1)),
          static_cast<double>(image.At<uint8_t>(x, y, 2))};
}

double DifferenceInCodes(const Image& image, int x, int y, const Eigen::Vector3f& color) {
  return (CodesAt(image, x, y) - 255 * color.cast<double>()).cwiseAbs().maxCoeff();
}

/// What is drawn over the background.
template <typename Draw>
Image Drawn(const Draw& draw) {
  const GlFramebuffer framebuffer(kWidth, kHeight, 1);
  framebuffer.Bind();
  ClearPicture(kBackground, 1);
  draw();
  return framebuffer.Read();
}

class GlMarksTest : public testing::Test {
 protected:
  EglContext context_;
  const Camera camera_ = TestCamera(400);
  const GlView view_ = ViewOf({{3, 5, -2}, 160}, camera_, TestPose());
  const std::vector<Eigen::Vector3f> red_green_blue_ = {{1, 0, 0.2f}, {0, 0.9f, 0}, {0.1f, 0, 1}};
};

TEST_F(GlMarksTest, CornersColoursAreInterpolatedAndShaded) {
  const double depth = 350;
  for (const std::vector<Eigen::Vector3d>& corners : std::vector<std::vector<Eigen::Vector3d>>{
           {{20, 15, depth}, {180, 40, depth}, {90, 145, depth}},  // faces the camera
           {{20, 15, 250}, {180, 40, 480}, {90, 145, depth}},      // turned
           {{90, 145, 250}, {180, 40, 260}, {20, 15, 470}}}) {     // and seen from behind
    for (const Placement& placement : {Placement(), TestPlacement()}) {
      const TriangleMesh mesh = TriangleAt(view_, placement, corners);
      GlCornerColors marks(mesh);
      marks.SetColors(red_green_blue_);
      const Image drawn = Drawn([&] { marks.DrawInto(view_, placement); });
      int inside = 0, outside = 0, shaded = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const auto [color, least_weight] = ShownAt(view_, placement, mesh, red_green_blue_, x, y);
          if (std::abs(least_weight) < 0.02) continue;
          const bool in = least_weight > 0;
          const double off = DifferenceInCodes(drawn, x, y, in ? color : kBackground);
          ASSERT_LE(off, kCode_abs) << x << ", " << y << (in ? " inside" : " outside");
          (in ? inside : outside) += 1;
          shaded += in && color.sum() < 0.85f;
        }
      }
      EXPECT_GT(inside, 4000);
      EXPECT_GT(outside, 4000);
      EXPECT_EQ(shaded > 0, corners[0].z() != depth) << "only what turns away is darker";
    }
  }
}

// From far away a facet that faces the eye has its corners' colours as they are.
TEST_F(GlMarksTest, AFacingTrianglesCornersHaveTheirColours) {
  const Camera camera = TestCamera(20000);
  const GlView view = ViewOf({{3, 5, -2}, 10}, camera, TestPose());
  const double depth = (view.camera_from_world * Eigen::Vector3d(3, 5, -2)).z();
  const std::vector<Eigen::Vector3d> corners = {
      {20, 15, depth}, {180, 40, depth}, {90, 145, depth}};
  GlCornerColors marks(TriangleAt(view, {}, corners));
  marks.SetColors(red_green_blue_);
  const Image drawn = Drawn([&] { marks.DrawInto(view, {}); });
  const Eigen::Vector2d middle(290.0 / 3, 200.0 / 3);
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector2d pixel =
        corners[c].head<2>() + 2 * (middle - corners[c].head<2>()).normalized();
    const int x = static_cast<int>(std::lround(pixel.x()));
    const int y = static_cast<int>(std::lround(pixel.y()));
    constexpr double kNearCorner_abs = 12;  // two or three pixels of about a hundred away
    EXPECT_LT(DifferenceInCodes(drawn, x, y, red_green_blue_[c]), kNearCorner_abs) << c;
  }
}

TEST_F(GlMarksTest, ColoursAreReplacedAndNearerTrianglesHideFartherOnes) {
  const std::vector<Eigen::Vector3f> red(3, {1, 0, 0}), blue(3, {0, 0, 1});
  const TriangleMesh near = TriangleAt(view_, {}, {{20, 15, 300}, {180, 15, 300}, {90, 145, 300}});
  const TriangleMesh far = TriangleAt(view_, {}, {{20, 15, 400}, {180, 15, 400}, {90, 145, 400}});
  GlCornerColors first(near), second(far);
  second.SetColors(red);
  first.SetColors(blue);
  first.SetColors(std::vector<Eigen::Vector3f>(3, {0, 1, 0}));
  for (const bool near_first : {true, false}) {
    const Image drawn = Drawn([&] {
      (near_first ? first : second).DrawInto(view_, {});
      (near_first ? second : first).DrawInto(view_, {});
    });
    const Eigen::Vector3d codes = CodesAt(drawn, 95, 55);
    EXPECT_GT(codes.y(), 200) << near_first;
    EXPECT_EQ(codes.x() + codes.z(), 0) << near_first;
  }
  EXPECT_THROW(first.SetColors(std::vector<Eigen::Vector3f>(2)), Error);
  EXPECT_THROW(first.SetColors(std::vector<Eigen::Vector3f>(4)), Error);
}

TEST_F(GlMarksTest, EdgesAreDarkAndNothingElseIs) {
  TriangleMesh square;  // of two triangles
  const std::vector<Eigen::Vector2d> at = {{30, 20}, {170, 20}, {170, 140}, {30, 140}};
  for (size_t i = 0; i < 4; i += 2) {
    const TriangleMesh half = TriangleAt(view_, {},
                                         {{at[i].x(), at[i].y(), 350},
                                          {at[i + 1].x(), at[i + 1].y(), 350},
                                          {at[(i + 2) % 4].x(), at[(i + 2) % 4].y(), 350}});
    square.vertices.insert(square.vertices.end(), half.vertices.begin(), half.vertices.end());
  }
  square.triangles = {{0, 1, 2}, {3, 4, 5}};
  GlCornerColors marks(square);
  marks.SetColors(std::vector<Eigen::Vector3f>(6, {1, 1, 1}));
  const Image without = Drawn([&] { marks.DrawInto(view_, {}); });
  const Image with = Drawn([&] { marks.DrawInto(view_, {}, EdgeOverlay::kWireframe); });
  const auto edge_distance = [&](const Eigen::Vector2d& p) {
    double least = 1e9;
    for (const auto& [i, j] : {std::pair(0, 1), {1, 2}, {2, 3}, {3, 0}, {2, 0}}) {
      const Eigen::Vector2d along = at[j] - at[i];
      const double t = std::clamp((p - at[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (p - at[i] - t * along).norm());
    }
    return least;
  };
  int dark = 0;
  for (int y = 21; y < 140; ++y) {
    for (int x = 31; x < 170; ++x) {
      const double distance = edge_distance({x, y});
      const double share = CodesAt(with, x, y).sum() / CodesAt(without, x, y).sum();
      if (distance > 2.5) {
        ASSERT_EQ(share, 1) << x << ", " << y;
      }
      if (distance < 0.3) {
        ASSERT_LT(share, 0.6) << x << ", " << y;
        ++dark;
      }
    }
  }
  EXPECT_GT(dark, 50);
}

// A line along a row of pixels, half of it before or behind a triangle.
TEST_F(GlMarksTest, LinesAreSeenInFrontAndHiddenOrFaintBehind) {
  const TriangleMesh mesh = TriangleAt(view_, {}, {{10, 10, 350}, {150, 10, 350}, {10, 150, 350}});
  GlCornerColors marks(mesh);
  marks.SetColors(std::vector<Eigen::Vector3f>(3, {1, 1, 1}));
  const GlLines lines;
  const Eigen::Vector3f color(1, 0.4f, 0);
  const Image plain = Drawn([&] { marks.DrawInto(view_, {}); });
  const auto with_line = [&](double depth, LineDepth how) {
    const std::vector<Eigen::Vector3d> ends =
        TriangleAt(view_, {}, {{30, 60, depth}, {190, 60, depth}, {0, 0, 1}}).vertices;
    return Drawn([&] {
      marks.DrawInto(view_, {});
      lines.DrawInto(view_, {ends.data(), 2}, color, how);
    });
  };
  constexpr int kOver = 60, kBeside = 160;  // columns on the triangle, and right of it
  for (const LineDepth how : {LineDepth::kHidden, LineDepth::kFaintBehind}) {
    const Image front = with_line(300, how), behind = with_line(420, how);
    EXPECT_LE(DifferenceInCodes(front, kOver, 60, color), 1);
    EXPECT_LE(DifferenceInCodes(front, kBeside, 60, color), 1);
    EXPECT_LE(DifferenceInCodes(behind, kBeside, 60, color), 1) << "nothing stands before it";
    const Eigen::Vector3d surface = CodesAt(plain, kOver, 60);
    const double share = (surface - CodesAt(behind, kOver, 60)).norm() /
                         (surface - 255 * color.cast<double>()).norm();
    const bool faint = how == LineDepth::kFaintBehind;
    EXPECT_GE(share, faint ? 0.1 : 0.0);
    EXPECT_LE(share, faint ? 0.5 : 0.0);
    int changed = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (CodesAt(front, x, y) == CodesAt(plain, x, y)) continue;
        ++changed;
        EXPECT_LE(std::abs(y - 60), 0) << "a pixel wide";
      }
    }
    EXPECT_NEAR(changed, 160, 2);
  }
}

TEST_F(GlMarksTest, LinesFarFromTheOriginAreWhereTheyShouldBe) {
  const GlLines lines;
  const std::vector<Eigen::Vector3d> points = {
      {-30, 10, 0}, {40, -20, 30}, {0, 30, 20}, {10, -40, 5}};
  const auto picture = [&](const Eigen::Vector3d& shift) {
    std::vector<Eigen::Vector3d> moved = points;
    for (Eigen::Vector3d& point : moved) point += shift;
    GlView view = view_;
    view.camera_from_world.translation -= view.camera_from_world.rotation * shift;
    return Drawn([&] { lines.DrawInto(view, moved, {1, 1, 1}, LineDepth::kHidden); });
  };
  const Image here = picture({0, 0, 0}), there = picture({4e6, -7e6, 2e6});
  int lit = 0, differ = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      lit += here.At<uint8_t>(x, y, 1) == 255;
      differ += here.At<uint8_t>(x, y, 1) != there.At<uint8_t>(x, y, 1);
    }
  }
  EXPECT_GT(lit, 60);
  EXPECT_LE(differ, 4) << "ties of rounding";
  const Image none = Drawn([&] { lines.DrawInto(view_, {}, {1, 1, 1}, LineDepth::kHidden); });
  EXPECT_EQ(CodesAt(none, 100, 80), CodesAt(none, 0, 0));
}

/// No two pixels alike, and rows of a length that four does not divide.
Image Mosaic(int width, int height) {
  Image image(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.At<uint8_t>(x, y, 0) = static_cast<uint8_t>(8 * x);
      image.At<uint8_t>(x, y, 1) = static_cast<uint8_t>(10 * y);
      image.At<uint8_t>(x, y, 2) = static_cast<uint8_t>(90 + 3 * (x ^ y));
    }
  }
  return image;
}

TEST_F(GlMarksTest, APictureInItsSizeKeepsItsPixels) {
  const Image image = Mosaic(29, 23);
  const GlPicture picture(image);
  EXPECT_EQ(picture.width(), 29);
  EXPECT_EQ(picture.height(), 23);
  // What stands nearest is covered as well: pictures have no depth.
  GlCornerColors behind(TriangleAt(view_, {}, {{0, 0, 210}, {190, 0, 210}, {0, 150, 210}}));
  behind.SetColors(red_green_blue_);
  const Image without = Drawn([&] { behind.DrawInto(view_, {}); });
  const Image drawn = Drawn([&] {
    behind.DrawInto(view_, {});
    picture.DrawInto({40, 15, 29, 23}, kWidth, kHeight);
  });
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool in = x >= 40 && x < 69 && y >= 15 && y < 38;
      ASSERT_EQ(CodesAt(drawn, x, y), in ? CodesAt(image, x - 40, y - 15) : CodesAt(without, x, y))
          << x << ", " << y;
    }
  }
}

TEST_F(GlMarksTest, APictureIsStretchedOverItsRectangle) {
  Image quarters(64, 64, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const Eigen::Vector3d colors[] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {250, 240, 10}};
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) {
        quarters.At<uint8_t>(x, y, c) = static_cast<uint8_t>(colors[x / 32 + 2 * (y / 32)][c]);
      }
    }
  }
  const GlPicture picture(quarters);
  for (const PixelRectangle& place :  // magnified, shrunk, and beyond the picture
       {PixelRectangle{10, 20, 180, 120}, {50, 60, 16, 12}, {-100, -60, 400, 280}}) {
    const Image drawn = Drawn([&] { picture.DrawInto(place, kWidth, kHeight); });
    for (const int quarter : {0, 1, 2, 3}) {
      for (const double inwards : {0.3, 0.002}) {  // the last is a pixel in the corner
        const double right = quarter % 2 == 0 ? inwards : 1 - inwards;
        const double down = quarter / 2 == 0 ? inwards : 1 - inwards;
        const int x = static_cast<int>(std::floor(place.x + place.width * right));
        const int y = static_cast<int>(std::floor(place.y + place.height * down));
        if (!camera_.Contains({x, y})) continue;
        EXPECT_EQ(CodesAt(drawn, x, y), colors[quarter]) << quarter << " of " << place.width;
      }
    }
  }
}

TEST_F(GlMarksTest, PicturesAreRgbOfEightBits) {
  EXPECT_THROW(GlPicture(Image(8, 8, 1, PixelType::kUint8, ColorEncoding::kSrgb)), Error);
  EXPECT_THROW(GlPicture(Image(8, 8, 4, PixelType::kUint8, ColorEncoding::kSrgb)), Error);
  EXPECT_THROW(GlPicture(Image(8, 8, 3, PixelType::kUint16, ColorEncoding::kSrgb)), Error);
  EXPECT_THROW(GlPicture(Image(8, 8, 3, PixelType::kFloat32, ColorEncoding::kLinear)), Error);
  EXPECT_THROW(GlPicture(Image(65536, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb)), Error);
}

TEST(FitInto, IsTheLargestInTheMiddle) {
  for (const PixelRectangle& frame :
       {PixelRectangle{0, 0, 200, 160}, {30, 50, 100, 300}, {-7.5, 3, 640.5, 20}}) {
    for (const auto& [width, height] : {std::pair(400, 300), {30, 90}, {5, 4}, {1, 1}}) {
      const PixelRectangle fitted = FitInto(frame, width, height);
      EXPECT_NEAR(fitted.width * height, fitted.height * width, kSide_abs * width * height);
      EXPECT_NEAR(fitted.x + fitted.width / 2, frame.x + frame.width / 2, kSide_abs);
      EXPECT_NEAR(fitted.y + fitted.height / 2, frame.y + frame.height / 2, kSide_abs);
      EXPECT_LE(fitted.width, frame.width + kSide_abs);
      EXPECT_LE(fitted.height, frame.height + kSide_abs);
      EXPECT_TRUE(fitted.width > frame.width - kSide_abs ||
                  fitted.height > frame.height - kSide_abs);
    }
  }
}

}  // namespace
}  // namespace lfm
