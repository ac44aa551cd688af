// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_settings.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

using Setter = std::function<void(ViewerState&, const std::string&)>;

enum class NumberKind { kAny, kWhole };

double ParseNumber(const std::string& text, double least, double most,
                   NumberKind kind = NumberKind::kAny) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  const bool whole = kind == NumberKind::kWhole;
  if (parsed.ec != std::errc() || parsed.ptr != end || !(value >= least && value <= most) ||
      (whole && value != std::floor(value))) {
    char range[80];
    std::snprintf(range, sizeof(range), "a %snumber from %g to %g", whole ? "whole " : "", least,
                  most);
    throw Error(range);
  }
  return value;
}

Setter Number(double least, double most, std::function<void(ViewerState&, double)> set) {
  return [=](ViewerState& state, const std::string& text) {
    set(state, ParseNumber(text, least, most));
  };
}

Setter WholeNumber(int least, int most, std::function<void(ViewerState&, int)> set) {
  return [=](ViewerState& state, const std::string& text) {
    set(state, static_cast<int>(ParseNumber(text, least, most, NumberKind::kWhole)));
  };
}

template <typename Enum>
Setter Choice(std::vector<std::string> names, std::function<void(ViewerState&, Enum)> set) {
  return [=](ViewerState& state, const std::string& text) {
    std::string known;
    for (size_t i = 0; i < names.size(); ++i) {
      if (names[i] == text) return set(state, static_cast<Enum>(i));
      known += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    }
    throw Error(known);
  };
}

Setter Switch(bool ViewerState::*member) {
  return Choice<bool>({"off", "on"}, [member](ViewerState& state, bool on) { state.*member = on; });
}

void SetCamera(ViewerState& state, const OrbitCamera& camera) {
  state.camera = camera;
  state.touched = true;
  state.photograph.clear();
}

// "2 100 0 0 0 0 90 0.5": a model's number from 1, millimetres, degrees about x, y and z, scale.
void PlaceModel(ViewerState& state, const std::string& text) {
  std::istringstream words(text);
  std::vector<double> numbers;
  try {
    for (std::string word; words >> word;) {
      const size_t i = numbers.size();
      const auto last = static_cast<double>(state.models.size());
      numbers.push_back(i == 0 ? ParseNumber(word, 1, last, NumberKind::kWhole)
                        : i == 7
                            ? ParseNumber(word, Placement::kLeastScale, Placement::kMostScale)
                            : ParseNumber(word, -Placement::kFarthestMm, Placement::kFarthestMm));
    }
  } catch (const Error&) {
    numbers.clear();
  }
  if (numbers.size() != 8) {
    throw Error("eight numbers: a model's (1 to " + std::to_string(state.models.size()) +
                "), x, y and z in mm, degrees about x, y and z, and a scale from 1e-6 to 1e6");
  }
  ShownModel& model = state.models[static_cast<size_t>(numbers[0]) - 1];
  model.translation = {numbers[1], numbers[2], numbers[3]};
  model.angles_deg = {numbers[4], numbers[5], numbers[6]};
  model.scale = numbers[7];
}

std::map<std::string, Setter> MakeSetters() {
  using S = ViewerState;
  std::map<std::string, Setter> setters;
  setters["terms"] = Number(
      0, 1024, [](S& s, double n) { s.terms = std::min(static_cast<int>(n), s.model_terms); });
  setters["show"] = Choice<ShownTerms>({"all", "mean", "term-alone"},
                                       [](S& s, ShownTerms shown) { s.shown = shown; });
  setters["overlay"] =
      Choice<Overlay>({"none", "normals", "photographs", "guessed", "terms", "patch-sizes"},
                      [](S& s, Overlay overlay) { s.overlay = overlay; });
  setters["edges"] =
      Choice<EdgeOverlay>({"off", "on"}, [](S& s, EdgeOverlay edges) { s.edges = edges; });
  setters["view-coordinates"] =
      Choice<ViewCoordinates>({"pixel", "vertex", "corner-maps"},
                              [](S& s, ViewCoordinates where) { s.view_coordinates = where; });
  setters["passes"] = Choice<Passes>({"one", "paper", "paper-unsigned"},
                                     [](S& s, Passes passes) { s.passes = passes; });
  setters["exposure"] = Number(-10, 10, [](S& s, double stops) { s.tone.exposure_stops = stops; });
  setters["tone"] =
      Choice<ToneCurve>({"clip", "soft"}, [](S& s, ToneCurve curve) { s.tone.curve = curve; });
  setters["background"] = [](S& s, const std::string& text) {
    try {
      s.background = ParseColor(text);
    } catch (const Error&) {
      throw Error("rrggbb in hexadecimal, as 181a1f");
    }
  };
  setters["azimuth"] = Number(-3600, 3600, [](S& s, double degrees) {
    SetCamera(s, Orbit(s.camera, degrees * kDegree - s.camera.azimuth, 0));
  });
  setters["elevation"] = Number(-89, 89, [](S& s, double degrees) {
    SetCamera(s, Orbit(s.camera, 0, degrees * kDegree - s.camera.elevation));
  });
  setters["distance"] = Number(1e-6, 1e9, [](S& s, double distance) {
    SetCamera(s, Zoom(s.camera, distance / s.camera.distance));
  });
  setters["photograph"] = [](S& s, const std::string& text) {
    s.photograph = text == "none" ? "" : text;
  };
  setters["compare"] = Switch(&S::show_photograph);
  setters["cameras"] = Switch(&S::show_cameras);
  setters["measure"] = Choice<Tool>({"off", "on"}, [](S& s, Tool tool) {
    s.tool = tool;
    s.tape.clear();
  });
  setters["scrolling"] = Choice<Scrolling>({"automatic", "zooms", "turns"},
                                           [](S& s, Scrolling does) { s.scrolling = does; });
  setters["panel"] = Switch(&S::show_panel);
  setters["frame-times"] = Switch(&S::show_frame_times);
  setters["add-dropped"] = Switch(&S::add_dropped);
  setters["place"] = [](S& s, const std::string& text) { PlaceModel(s, text); };
  setters["save"] = [](S& s, const std::string& text) {
    if (text == "screenshot") {
      s.save_screenshot = true;
    } else if (text == "path") {
      s.save_path = true;
    } else if (text == "scene") {
      s.save_scene = true;
    } else {
      throw Error("screenshot, path or scene");
    }
  };
  setters["turntable"] = WholeNumber(1, 100000, [](S& s, int frames) {
    s.turntable_frames = frames;
    s.film = Film::kTurntable;
  });
  setters["film"] = Choice<Film>({"none", "turntable", "path"}, [](S& s, Film film) {
    s.film = film;
    s.stop_film = film == Film::kNone;
  });
  return setters;
}

const std::map<std::string, Setter>& Setters() {
  static const std::map<std::string, Setter> setters = MakeSetters();
  return setters;
}

}  // namespace

ViewerState SetByName(ViewerState state, const std::string& setting) {
  const size_t blank = setting.find(' ');
  const std::string name = setting.substr(0, blank);
  const std::string value = blank == std::string::npos ? "" : setting.substr(blank + 1);
  const auto setter = Setters().find(name);
  if (setter == Setters().end()) {
    std::string known;
    for (const std::string& other : SettingNames()) known += (known.empty() ? "" : ", ") + other;
    throw Error("there is no setting '" + name + "'; known are " + known);
  }
  try {
    setter->second(state, value);
  } catch (const Error& error) {
    throw Error("setting '" + name + "' cannot be '" + value + "'; give " + error.what());
  }
  return state;
}

std::vector<std::string> SettingNames() {
  std::vector<std::string> names;
  for (const auto& [name, setter] : Setters()) names.push_back(name);
  return names;
}

nlohmann::json StateToJson(const ViewerState& state, const ViewerStatus& status) {
  const auto point = [](const Eigen::Vector3d& p) {
    return nlohmann::json::array({p.x(), p.y(), p.z()});
  };
  nlohmann::json json = {
      {"azimuth", state.camera.azimuth / kDegree},
      {"elevation", state.camera.elevation / kDegree},
      {"distance", state.camera.distance},
      {"target", point(state.camera.target)},
      {"terms", state.terms},
      {"model_terms", state.model_terms},
      {"models", status.models},
      {"triangles", status.triangles},
      {"passes", status.passes},
      {"photograph", state.photograph},
      {"message", state.message},
      {"error", status.error},
  };
  if (status.photograph_psnr_db) json["photograph_psnr_db"] = *status.photograph_psnr_db;
  json["tape"] = nlohmann::json::array();
  for (const Eigen::Vector3d& end : state.tape) json["tape"].push_back(point(end));
  if (const auto length = TapeLength(state)) json["tape_mm"] = *length;
  json["legend"] = nlohmann::json::array();
  for (const LegendEntry& entry : status.legend) json["legend"].push_back(entry.text);
  return json;
}

}  // namespace lfm
