// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/light_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

[[noreturn]] void Fail(const std::string& text) {
  throw Error("--light: '" + text +
              "' is no direction; write AZIMUTH,ELEVATION in degrees, as 30,45, or X,Y,Z");
}

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  size_t begin = 0;
  for (;;) {
    const size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

double ParseNumber(std::string part, const std::string& whole) {
  part.erase(0, part.find_first_not_of(' '));
  part.erase(part.find_last_not_of(' ') + 1);
  double value = 0;
  const auto parsed = std::from_chars(part.data(), part.data() + part.size(), value);
  if (part.empty() || parsed.ec != std::errc() || parsed.ptr != part.data() + part.size() ||
      !std::isfinite(value)) {
    Fail(whole);
  }
  return value;
}

Vector3d ParseDirection(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& part : Split(text, ',')) numbers.push_back(ParseNumber(part, text));
  if (numbers.size() == 2 && std::abs(numbers[1]) <= 90) {
    const double azimuth = numbers[0] * kPi / 180, elevation = numbers[1] * kPi / 180;
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }
  if (numbers.size() != 3) Fail(text);
  const Vector3d direction(numbers[0], numbers[1], numbers[2]);
  const double largest = direction.cwiseAbs().maxCoeff();
  if (!(largest > 0)) Fail(text);
  return (direction / largest).normalized();
}

// At `share` of the way from the first direction to the last; opposite ones go over any circle.
Vector3d OnTheWay(const std::vector<Vector3d>& stations, double share) {
  std::vector<double> reached = {0};
  for (size_t i = 1; i < stations.size(); ++i) {
    const double step =
        std::atan2(stations[i - 1].cross(stations[i]).norm(), stations[i - 1].dot(stations[i]));
    reached.push_back(reached.back() + step);
  }
  const double place = share * reached.back();
  size_t leg = 1;
  while (leg + 1 < stations.size() && reached[leg] < place) ++leg;
  const double length = reached[leg] - reached[leg - 1];
  if (!(length > 0)) return stations[leg];
  const auto turn = Eigen::Quaterniond::FromTwoVectors(stations[leg - 1], stations[leg]);
  const double part = (place - reached[leg - 1]) / length;
  return Eigen::Quaterniond::Identity().slerp(part, turn) * stations[leg - 1];
}

}  // namespace

std::vector<Vector3d> ParseLightDirections(const std::string& text) {
  std::vector<Vector3d> directions;
  for (const std::string& part : Split(text, ';')) directions.push_back(ParseDirection(part));
  return directions;
}

std::vector<FrameLight> PlanLights(double turn_deg, const std::vector<Vector3d>& to_light,
                                   int frames) {
  std::vector<FrameLight> plan;
  for (int i = 0; i < frames; ++i) {
    FrameLight frame;
    const double turn = 360.0 * i / frames;
    frame.turn_deg = turn_deg + turn;
    if (to_light.size() == 1) {
      frame.to_light = Eigen::AngleAxisd(turn * kPi / 180, Vector3d::UnitZ()) * to_light[0];
    } else if (!to_light.empty()) {
      frame.to_light = OnTheWay(to_light, frames == 1 ? 0 : static_cast<double>(i) / (frames - 1));
    }
    plan.push_back(frame);
  }
  return plan;
}

}  // namespace lfm
