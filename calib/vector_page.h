// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lfm {

/// A page drawn with shapes: exact at every resolution. Millimetres, origin at the page's lower
/// left corner, y up. Colours are sRGB.
using VectorColor = std::array<uint8_t, 3>;

/// A filled area, by the even-odd rule; every loop is closed.
struct FilledPath {
  std::vector<std::vector<Eigen::Vector2d>> loops;
  VectorColor color = {0, 0, 0};
};
struct FilledDisc {
  Eigen::Vector2d center = {0, 0};
  double radius = 0;
  VectorColor color = {0, 0, 0};
};
/// An open line with round ends and joints.
struct StrokedLine {
  std::vector<Eigen::Vector2d> points;
  double width = 0.2;
  VectorColor color = {0, 0, 0};
};
using VectorShape = std::variant<FilledPath, FilledDisc, StrokedLine>;

/// Shapes of which only what lies inside `clip` is drawn.
struct VectorGroup {
  std::optional<Eigen::AlignedBox2d> clip;
  std::vector<VectorShape> shapes;
};

struct VectorPage {
  double width_mm = 0, height_mm = 0;
  std::vector<VectorGroup> groups;
};

/// The pages as PDF 1.7: one page each, its MediaBox the page to 1e-5 mm, no fonts, no compression,
/// no date, with the viewer preference to print without scaling. Discs are four Bezier arcs, round
/// to 0.03 % of the radius. Throws Error (kSystem) without pages.
std::string PdfOfPages(const std::vector<VectorPage>& pages, const std::string& title);

/// One page as SVG 1.1, width and height in mm, one user unit a millimetre.
std::string SvgOfPage(const VectorPage& page, const std::string& title);

/// A shape moved by `shift`.
VectorShape Moved(const VectorShape& shape, const Eigen::Vector2d& shift);

/// The smallest box that holds a shape.
Eigen::AlignedBox2d BoundsOf(const VectorShape& shape);

/// A coordinate as files hold it: decimal, at most five digits after the point.
std::string VectorNumber(double value);

/// Letters, digits and punctuation as lines, so that nothing depends on a font: `height` mm high,
/// starting at `origin` (lower left). Small letters become capitals; what has no glyph becomes "?".
std::vector<VectorShape> TextLines(const std::string& text, const Eigen::Vector2d& origin,
                                   double height, const VectorColor& color);
/// The width of such a text, mm.
double TextWidth(const std::string& text, double height);

}  // namespace lfm
