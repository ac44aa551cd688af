// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "calib/vector_page.h"

namespace lfm {
namespace {

// A glyph's lines on a grid 4 wide and 6 high: pairs of digits x y, lines parted by spaces.
const std::map<char, std::string_view>& Glyphs() {
  static const std::map<char, std::string_view> glyphs = {
      {' ', ""},
      {'A', "0004264440 0343"},
      {'B', "00063645443303 3342413000"},
      {'C', "4536160501103041"},
      {'D', "00062644422000"},
      {'E', "46060040 0333"},
      {'F', "460600 0333"},
      {'G', "45361605011030414323"},
      {'H', "0006 4046 0343"},
      {'I', "1030 1636 2026"},
      {'J', "0110304146"},
      {'K', "0006 460340"},
      {'L', "060040"},
      {'M', "0006234640"},
      {'N', "00064046"},
      {'O', "103041453616050110"},
      {'P', "00063645443303"},
      {'Q', "103041453616050110 2240"},
      {'R', "00063645443303 2340"},
      {'S', "453616050413334241301001"},
      {'T', "0646 2620"},
      {'U', "060110304146"},
      {'V', "062046"},
      {'W', "0610233046"},
      {'X', "0046 0640"},
      {'Y', "062346 2320"},
      {'Z', "06460040"},
      {'0', "103041453616050110 1135"},
      {'1', "052620 1030"},
      {'2', "05163645440040"},
      {'3', "0516364544334241301001 1333"},
      {'4', "360242 3036"},
      {'5', "460603334241301001"},
      {'6', "4536160501103041423303"},
      {'7', "064610"},
      {'8', "13040516364544331302011030414233"},
      {'9', "0110304145361605041343"},
      {'.', "2021"},
      {',', "2110"},
      {':', "2122 2425"},
      {';', "2110 2425"},
      {'-', "1333"},
      {'+', "1333 2224"},
      {'/', "0046"},
      {'%', "0046 0616150506 3040413130"},
      {'(', "36242230"},
      {')', "16242210"},
      {'_', "0040"},
      {'=', "1232 1434"},
      {'?', "051636454422 2021"},
  };
  return glyphs;
}

constexpr double kGridHeight = 6, kAdvance = 6;
constexpr double kLineWidthInHeights = 0.1;

}  // namespace

std::vector<VectorShape> TextLines(const std::string& text, const Eigen::Vector2d& origin,
                                   double height, const VectorColor& color) {
  const double unit = height / kGridHeight;
  std::vector<VectorShape> shapes;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
    const auto found = Glyphs().find(c);
    std::string_view lines = (found == Glyphs().end() ? Glyphs().find('?') : found)->second;
    const Eigen::Vector2d corner =
        origin + Eigen::Vector2d(kAdvance * unit * static_cast<double>(i), 0);
    while (!lines.empty()) {
      const std::string_view line = lines.substr(0, lines.find(' '));
      StrokedLine stroke{{}, kLineWidthInHeights * height, color};
      for (size_t k = 0; k + 1 < line.size(); k += 2) {
        stroke.points.push_back(corner + unit * Eigen::Vector2d(line[k] - '0', line[k + 1] - '0'));
      }
      shapes.emplace_back(std::move(stroke));
      lines.remove_prefix(std::min(lines.size(), line.size() + 1));
    }
  }
  return shapes;
}

double TextWidth(const std::string& text, double height) {
  if (text.empty()) return 0;
  return (kAdvance * static_cast<double>(text.size()) - 2) * height / kGridHeight;
}

}  // namespace lfm
