// SPDX-License-Identifier: BSD-3-Clause
#include "calib/circle_match.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/homography.h"

namespace lfm {
namespace {

constexpr int kMinCircles = 4;
constexpr int kFewTags = 3;
constexpr double kMaxErrorInDiameters = 1.0 / 3, kMaxSizeRatio = 1.6;
// Perspective makes a plate's far half smaller than an affine guess.
constexpr double kMaxAffineRatio = 1.8, kMaxAffineError = 0.3;
constexpr int kRefits = 4;
// A guess takes some tens of microseconds; usual pictures need a few hundred at most.
constexpr int kMaxGuesses = 20000;

// Detection of every circle of the board, or -1.
using Assignment = std::vector<int>;

int CountAssigned(const Assignment& assignment) {
  return static_cast<int>(assignment.size()) -
         static_cast<int>(std::count(assignment.begin(), assignment.end(), -1));
}

// The affine map that an ellipse and the direction to another circle suggest: pixels from board,
// mirrored, since the board's y points up and the picture's down.
std::optional<Eigen::Matrix2d> AffineOfPair(const BoardCircle& a, const BoardCircle& b,
                                            const DetectedCircle& seen_a,
                                            const DetectedCircle& seen_b) {
  const Eigen::Matrix2d root = Eigen::Matrix2d(seen_a.shape.llt().matrixL()) / (a.diameter_mm / 2);
  const Eigen::Vector2d from = b.center_mm - a.center_mm;
  const Eigen::Vector2d to = root.inverse() * (seen_b.center - seen_a.center);
  const double ratio = to.norm() / from.norm();
  const double sizes =
      std::sqrt(std::sqrt(seen_b.shape.determinant() / seen_a.shape.determinant())) *
      a.diameter_mm / b.diameter_mm;
  for (const double r : {ratio, sizes}) {
    if (!(r < kMaxAffineRatio && r > 1 / kMaxAffineRatio)) return std::nullopt;
  }
  const Eigen::Vector2d u = from.normalized(), v = to.normalized();
  // The reflection that takes u to v.
  Eigen::Matrix2d turn;
  const double c = u.x() * v.x() - u.y() * v.y(), s = u.x() * v.y() + u.y() * v.x();
  turn << c, s, s, -c;
  return root * turn * ratio;
}

Assignment AssignByAffine(const Board& board, const std::vector<DetectedCircle>& seen, size_t a,
                          size_t seen_a, const Eigen::Matrix2d& affine) {
  Assignment assignment(board.circles.size(), -1);
  for (size_t i = 0; i < board.circles.size(); ++i) {
    const Eigen::Vector2d way = affine * (board.circles[i].center_mm - board.circles[a].center_mm);
    const double radius = std::sqrt(std::sqrt(seen[seen_a].shape.determinant()));
    double nearest = kMaxAffineError * way.norm() + radius;
    for (size_t j = 0; j < seen.size(); ++j) {
      if (seen[j].color != board.circles[i].color) continue;
      const double distance = (seen[seen_a].center + way - seen[j].center).norm();
      if (distance < nearest) {
        nearest = distance;
        assignment[i] = static_cast<int>(j);
      }
    }
  }
  return assignment;
}

// Fits the circles' centres, correcting where ellipses have theirs.
std::optional<Eigen::Matrix3d> FitCircles(const Board& board,
                                          const std::vector<DetectedCircle>& seen,
                                          const Assignment& assignment,
                                          std::vector<Eigen::Vector2d>& pixels) {
  std::vector<Eigen::Vector2d> points;
  std::vector<size_t> used;
  pixels.clear();
  for (size_t i = 0; i < assignment.size(); ++i) {
    if (assignment[i] < 0) continue;
    used.push_back(i);
    points.push_back(board.circles[i].center_mm);
    pixels.push_back(seen[static_cast<size_t>(assignment[i])].center);
  }
  std::optional<Eigen::Matrix3d> h = FitHomography(points, pixels);
  for (int round = 0; h && round < kRefits; ++round) {
    for (size_t k = 0; k < used.size(); ++k) {
      const EllipseView view = ViewCircle(*h, board.circles[used[k]]);
      if (!view.center_bias.allFinite()) return std::nullopt;
      pixels[k] = seen[static_cast<size_t>(assignment[used[k]])].center - view.center_bias;
    }
    h = FitHomography(points, pixels);
  }
  return h;
}

// Circles whose ellipse under `h` is one that was seen.
Assignment AssignByHomography(const Board& board, const std::vector<DetectedCircle>& seen,
                              const Eigen::Matrix3d& h) {
  Assignment assignment(board.circles.size(), -1);
  for (size_t i = 0; i < board.circles.size(); ++i) {
    const EllipseView view = ViewCircle(h, board.circles[i]);
    const double area = view.shape.determinant();
    if (!view.center.allFinite() || !(area > 0)) continue;
    double nearest = kMaxErrorInDiameters * 2 * std::sqrt(std::sqrt(area));
    for (size_t j = 0; j < seen.size(); ++j) {
      if (seen[j].color != board.circles[i].color) continue;
      const double ratio = std::sqrt(std::sqrt(seen[j].shape.determinant() / area));
      if (!(ratio < kMaxSizeRatio && ratio > 1 / kMaxSizeRatio)) continue;
      const double distance = (view.center - seen[j].center).norm();
      if (distance < nearest) {
        nearest = distance;
        assignment[i] = static_cast<int>(j);
      }
    }
  }
  return assignment;
}

// Circles in whose place a disc of another colour is seen.
int CountContradictions(const Board& board, const std::vector<DetectedCircle>& seen,
                        const Eigen::Matrix3d& h) {
  int contradictions = 0;
  for (const BoardCircle& circle : board.circles) {
    const EllipseView view = ViewCircle(h, circle);
    const double area = view.shape.determinant();
    if (!view.center.allFinite() || !(area > 0)) continue;
    const double near = kMaxErrorInDiameters * 2 * std::sqrt(std::sqrt(area));
    contradictions += std::any_of(seen.begin(), seen.end(), [&](const DetectedCircle& s) {
      const double ratio = std::sqrt(std::sqrt(s.shape.determinant() / area));
      return s.color != circle.color && (view.center - s.center).norm() < near &&
             ratio < kMaxSizeRatio && ratio > 1 / kMaxSizeRatio;
    });
  }
  return contradictions;
}

// Grows a guess until the same circles agree; no answer when fewer than four do, or too many
// others are there in another colour.
std::optional<Assignment> Consolidate(const Board& board, const std::vector<DetectedCircle>& seen,
                                      Assignment assignment) {
  std::vector<Eigen::Vector2d> pixels;
  for (int round = 0; round < kRefits; ++round) {
    if (CountAssigned(assignment) < kMinCircles) return std::nullopt;
    const std::optional<Eigen::Matrix3d> h = FitCircles(board, seen, assignment, pixels);
    // A mirrored plate is not one seen from above.
    if (!h || !(h->determinant() * (*h)(2, 2) < 0)) return std::nullopt;
    Assignment next = AssignByHomography(board, seen, *h);
    if (next == assignment) {
      if (4 * CountContradictions(board, seen, *h) > CountAssigned(assignment)) return std::nullopt;
      return assignment;
    }
    assignment = std::move(next);
  }
  return std::nullopt;
}

Assignment LargestAgreement(const Board& board, const std::vector<DetectedCircle>& seen) {
  const std::vector<BoardCircle>& circles = board.circles;
  Assignment best;
  int most = 0, guesses = 0;
  for (size_t a = 0; a < circles.size(); ++a) {
    for (size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].color != circles[a].color) continue;
      for (size_t b = 0; b < circles.size(); ++b) {
        for (size_t j = 0; j < seen.size(); ++j) {
          if (a == b || i == j || seen[j].color != circles[b].color) continue;
          const auto affine = AffineOfPair(circles[a], circles[b], seen[i], seen[j]);
          if (!affine) continue;
          if (++guesses > kMaxGuesses) return best;
          auto grown = Consolidate(board, seen, AssignByAffine(board, seen, a, i, *affine));
          if (!grown || CountAssigned(*grown) <= most) continue;
          most = CountAssigned(*grown);
          best = std::move(*grown);
          if (most == static_cast<int>(circles.size())) return best;
        }
      }
    }
  }
  return best;
}

// True when tags of the platform's plane lie a tag or more from where the circles say.
bool ContradictsTags(const BoardMatch& circles, const BoardMatch& tags) {
  if (tags.pixels.size() < 4) return false;
  const double tag_px = (tags.pixels[0] - tags.pixels[2]).norm();
  for (size_t i = 0; i < tags.world_points.size(); ++i) {
    const Eigen::Vector3d& p = tags.world_points[i];
    if (std::abs(p.z()) > 1e-6) continue;
    const Eigen::Vector2d expected = MapByHomography(circles.pixel_from_board, p.head<2>());
    if (!((expected - tags.world_pixels[i]).norm() < tag_px)) return true;
  }
  return false;
}

bool OnOneLine(const std::vector<BoardCircle>& circles) {
  Eigen::Vector2d mean(0, 0);
  for (const BoardCircle& c : circles) mean += c.center_mm / static_cast<double>(circles.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  double diameter = 0;
  for (const BoardCircle& c : circles) {
    spread += (c.center_mm - mean) * (c.center_mm - mean).transpose();
    diameter = std::max(diameter, c.diameter_mm);
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues()[0] <
         diameter * diameter / 4;
}

bool MapsOntoItself(const std::vector<BoardCircle>& circles, const Eigen::Matrix3d& motion) {
  bool moves = false;
  for (size_t i = 0; i < circles.size(); ++i) {
    const Eigen::Vector2d p = (motion * circles[i].center_mm.homogeneous()).head<2>();
    bool lands = false;
    for (size_t j = 0; j < circles.size(); ++j) {
      if (circles[j].color != circles[i].color) continue;
      if ((circles[j].center_mm - p).norm() > circles[j].diameter_mm / 2) continue;
      lands = true;
      moves = moves || i != j;
    }
    if (!lands) return false;
  }
  return moves;
}

Eigen::Matrix3d Triple(const BoardCircle& a, const BoardCircle& b, const BoardCircle& c) {
  Eigen::Matrix3d columns;
  columns << a.center_mm.homogeneous(), b.center_mm.homogeneous(), c.center_mm.homogeneous();
  return columns;
}

}  // namespace

EllipseView ViewCircle(const Eigen::Matrix3d& pixel_from_board, const BoardCircle& circle) {
  const Eigen::Vector3d center = circle.center_mm.homogeneous();
  const double radius = circle.diameter_mm / 2;
  Eigen::Matrix3d dual = center * center.transpose();
  dual(0, 0) -= radius * radius;
  dual(1, 1) -= radius * radius;
  const Eigen::Matrix3d seen = pixel_from_board * dual * pixel_from_board.transpose();
  const Eigen::Matrix3d scaled = seen / seen(2, 2);
  EllipseView view;
  view.center = scaled.topRightCorner<2, 1>();
  view.shape = view.center * view.center.transpose() - scaled.topLeftCorner<2, 2>();
  view.center_bias = view.center - MapByHomography(pixel_from_board, circle.center_mm);
  return view;
}

std::variant<BoardMatch, BoardMismatch> MatchCircles(
    const Board& board, const std::vector<DetectedCircle>& detections) {
  const Assignment assignment = LargestAgreement(board, detections);
  if (assignment.empty()) {
    return BoardMismatch{"only " + std::to_string(detections.size()) +
                         " coloured circles found, fewer than four of them as on the board; is the "
                         "platform in the picture, in colour and evenly lit?"};
  }
  BoardMatch match;
  const std::optional<Eigen::Matrix3d> h = FitCircles(board, detections, assignment, match.pixels);
  if (!h) return BoardMismatch{"its circles lie on a line; the pose cannot be found"};
  match.pixel_from_board = *h;
  for (size_t i = 0; i < assignment.size(); ++i) {
    if (assignment[i] < 0) continue;
    const Eigen::Vector2d& p = board.circles[i].center_mm;
    match.points_mm.push_back(p);
    match.world_points.emplace_back(p.x(), p.y(), 0.0);
  }
  match.world_pixels = match.pixels;
  match.circles = CountAssigned(assignment);
  return match;
}

std::variant<BoardMatch, BoardMismatch> ChooseMatch(std::variant<BoardMatch, BoardMismatch> tags,
                                                    const Board& board, const Image& picture,
                                                    BoardSearch search) {
  if (board.circles.empty()) return tags;
  const std::vector<BoardPlate> plates = PlatesOf(board);
  const bool has_tags = std::any_of(plates.begin(), plates.end(),
                                    [](const BoardPlate& p) { return !p.board->tags.empty(); });
  if (search == BoardSearch::kTags) {
    if (has_tags) return tags;
    return BoardMismatch{"the board has no tags, but circles: use --start auto or circles"};
  }
  const BoardMatch* match = std::get_if<BoardMatch>(&tags);
  if (search == BoardSearch::kAuto && match != nullptr && match->tags >= kFewTags) return tags;
  if (picture.channels() < 3) {
    if (has_tags) return tags;
    return BoardMismatch{
        "is gray, and the board has coloured circles only; gray pictures (a "
        "scanner's) need a board with tags too"};
  }
  std::variant<BoardMatch, BoardMismatch> circles = MatchCircles(board, DetectCircles(picture));
  if (BoardMatch* found = std::get_if<BoardMatch>(&circles)) {
    if (match != nullptr && ContradictsTags(*found, *match)) return tags;
    found->tags = match != nullptr ? match->tags : 0;
    return circles;
  }
  if (!has_tags) return circles;
  if (match == nullptr) {
    return BoardMismatch{std::get<BoardMismatch>(tags).reason + " (" +
                         std::get<BoardMismatch>(circles).reason + ")"};
  }
  return tags;
}

bool CirclesAreAmbiguous(const std::vector<BoardCircle>& circles) {
  const size_t n = circles.size();
  if (n < 3 || OnOneLine(circles)) return true;
  // Three that are not on a line carry the whole motion.
  size_t a = 0, b = 1, c = 2;
  double largest = 0;
  for (size_t i = 1; i < n; ++i) {
    for (size_t j = i + 1; j < n; ++j) {
      const double area = std::abs(Triple(circles[0], circles[i], circles[j]).determinant());
      if (area > largest) {
        largest = area;
        b = i;
        c = j;
      }
    }
  }
  const Eigen::Matrix3d from = Triple(circles[a], circles[b], circles[c]).inverse();
  for (size_t i = 0; i < n; ++i) {
    if (circles[i].color != circles[a].color) continue;
    for (size_t j = 0; j < n; ++j) {
      if (j == i || circles[j].color != circles[b].color) continue;
      for (size_t k = 0; k < n; ++k) {
        if (k == i || k == j || circles[k].color != circles[c].color) continue;
        const Eigen::Matrix3d motion = Triple(circles[i], circles[j], circles[k]) * from;
        if (motion.determinant() > 0 && MapsOntoItself(circles, motion)) return true;
      }
    }
  }
  return false;
}

}  // namespace lfm
