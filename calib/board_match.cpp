// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_match.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "calib/homography.h"

namespace lfm {
namespace {

constexpr double kMaxErrorInTags = 1.0 / 3;
constexpr double kMinAgreeingShare = 2.0 / 3;
// Of all copies of all tags: a second board must not be as large as the first.
constexpr double kMinShareOfCopies = 0.55;
// All pairs of the usual two dozen tags; on larger boards an even selection of pairs does.
constexpr size_t kMaxPairs = 600;

struct SeenTag {
  int id = 0;
  std::array<Eigen::Vector2d, 4> points_mm, pixels;
  double side_px = 0;
};

std::vector<SeenTag> SelectBoardTags(const Board& board,
                                     const std::vector<TagDetection>& detections) {
  std::map<int, const BoardTag*> tag_of_id;
  for (const BoardTag& tag : board.tags) tag_of_id[tag.id] = &tag;
  std::vector<SeenTag> seen;
  for (const TagDetection& detection : detections) {
    const auto it = tag_of_id.find(detection.id);
    if (it == tag_of_id.end()) continue;
    SeenTag tag;
    tag.id = detection.id;
    const std::array<Eigen::Vector3d, 4> corners = board.TagCorners(*it->second);
    tag.pixels = detection.corners;
    for (int c = 0; c < 4; ++c) {
      tag.points_mm[c] = corners[c].head<2>();
      tag.side_px += (tag.pixels[(c + 1) % 4] - tag.pixels[c]).norm() / 4;
    }
    seen.push_back(tag);
  }
  return seen;
}

std::optional<Eigen::Matrix3d> HomographyOf(const std::vector<SeenTag>& seen,
                                            const std::vector<size_t>& selection) {
  std::vector<Eigen::Vector2d> from, to;
  for (const size_t i : selection) {
    from.insert(from.end(), seen[i].points_mm.begin(), seen[i].points_mm.end());
    to.insert(to.end(), seen[i].pixels.begin(), seen[i].pixels.end());
  }
  return FitHomography(from, to);
}

std::vector<size_t> Agreeing(const std::vector<SeenTag>& seen, const Eigen::Matrix3d& h) {
  std::vector<size_t> agreeing;
  for (size_t i = 0; i < seen.size(); ++i) {
    bool agrees = true;
    for (int c = 0; c < 4; ++c) {
      const double error = (MapByHomography(h, seen[i].points_mm[c]) - seen[i].pixels[c]).norm();
      // A point on the line at infinity has error NaN, which agrees with nothing.
      agrees = agrees && error <= kMaxErrorInTags * seen[i].side_px;
    }
    if (agrees) agreeing.push_back(i);
  }
  return agreeing;
}

std::vector<size_t> LargestAgreement(const std::vector<SeenTag>& seen) {
  const size_t n = seen.size();
  const size_t stride = std::max<size_t>(1, n * (n - 1) / 2 / kMaxPairs);
  std::vector<size_t> best;
  size_t pair = 0;
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = i + 1; j < n; ++j, ++pair) {
      if (pair % stride != 0) continue;
      const std::optional<Eigen::Matrix3d> h = HomographyOf(seen, {i, j});
      if (!h) continue;
      std::vector<size_t> agreeing = Agreeing(seen, *h);
      if (agreeing.size() > best.size()) best = std::move(agreeing);
    }
  }
  // The whole agreement sees farther than the pair that it grew from.
  if (const std::optional<Eigen::Matrix3d> h = HomographyOf(seen, best)) {
    std::vector<size_t> agreeing = Agreeing(seen, *h);
    if (agreeing.size() >= best.size()) best = std::move(agreeing);
  }
  if (best.empty()) best = {0};
  return best;
}

std::string ForeignIds(const std::vector<TagDetection>& detections) {
  std::string ids;
  for (size_t i = 0; i < std::min<size_t>(detections.size(), 4); ++i) {
    ids += (i ? ", " : "") + std::to_string(detections[i].id);
  }
  return ids + (detections.size() > 4 ? ", ..." : "");
}

// What one plate makes of the detections.
std::variant<BoardMatch, BoardMismatch> MatchPlate(const BoardPlate& plate,
                                                   const std::vector<SeenTag>& seen) {
  const std::vector<size_t> agreeing = LargestAgreement(seen);
  std::set<int> ids;
  for (const SeenTag& tag : seen) ids.insert(tag.id);
  const double agree = static_cast<double>(agreeing.size());
  if (agree < kMinAgreeingShare * static_cast<double>(ids.size()) ||
      agree < kMinShareOfCopies * static_cast<double>(seen.size())) {
    return BoardMismatch{"only " + std::to_string(agreeing.size()) + " of " +
                         std::to_string(seen.size()) +
                         " tags lie as on the board; two boards mixed up?"};
  }
  const std::optional<Eigen::Matrix3d> h = HomographyOf(seen, agreeing);
  if (!h) return BoardMismatch{"its tags lie on a line; the pose cannot be found"};
  BoardMatch match;
  match.tags = static_cast<int>(agreeing.size());
  match.pixel_from_board = *h;
  match.world_from_plate = plate.world_from_plate;
  for (const size_t i : agreeing) {
    match.points_mm.insert(match.points_mm.end(), seen[i].points_mm.begin(),
                           seen[i].points_mm.end());
    match.pixels.insert(match.pixels.end(), seen[i].pixels.begin(), seen[i].pixels.end());
  }
  for (const Eigen::Vector2d& p : match.points_mm) {
    match.world_points.push_back(plate.world_from_plate * Eigen::Vector3d(p.x(), p.y(), 0));
  }
  match.world_pixels = match.pixels;
  return match;
}

// Adds what another plate says; the one that shows more leads.
BoardMatch JoinMatches(BoardMatch a, BoardMatch b) {
  // points_mm are the leader's own, tags those of all plates so far.
  if (b.points_mm.size() > a.points_mm.size()) std::swap(a, b);
  a.tags += b.tags;
  a.world_points.insert(a.world_points.end(), b.world_points.begin(), b.world_points.end());
  a.world_pixels.insert(a.world_pixels.end(), b.world_pixels.begin(), b.world_pixels.end());
  return a;
}

}  // namespace

std::variant<BoardMatch, BoardMismatch> MatchBoard(const Board& board,
                                                   const std::vector<TagDetection>& detections) {
  if (detections.empty()) {
    return BoardMismatch{"no " + board.family +
                         " tag found; is the platform in the picture, sharp?"};
  }
  std::optional<BoardMatch> joined;
  std::optional<BoardMismatch> mismatch;
  for (const BoardPlate& plate : PlatesOf(board)) {
    const std::vector<SeenTag> seen = SelectBoardTags(*plate.board, detections);
    if (seen.empty()) continue;
    std::variant<BoardMatch, BoardMismatch> match = MatchPlate(plate, seen);
    if (BoardMatch* found = std::get_if<BoardMatch>(&match)) {
      joined = joined ? JoinMatches(std::move(*joined), std::move(*found)) : std::move(*found);
    } else if (!mismatch) {
      mismatch = std::get<BoardMismatch>(match);
    }
  }
  if (joined) return *joined;
  if (mismatch) return *mismatch;
  return BoardMismatch{"its tags (ids " + ForeignIds(detections) +
                       ") are not on the board; a picture of another board?"};
}

}  // namespace lfm
