// SPDX-License-Identifier: BSD-3-Clause
#include "calib/vector_page.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
// Control points of a quarter circle (the usual cubic; 0.027 % too wide at most).
constexpr double kQuarterCircle = 0.5522847498307936;

template <typename... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

std::string Point(const Eigen::Vector2d& p) {
  return VectorNumber(p.x()) + " " + VectorNumber(p.y());
}

// What every reader's text can hold.
std::string PlainTitle(const std::string& title) {
  std::string plain;
  for (const char c : title) {
    const bool keep =
        c >= ' ' && c <= '~' && std::string_view("()\\<>&\"'").find(c) == std::string_view::npos;
    plain += keep ? c : '?';
  }
  return plain;
}

std::string PdfColor(const VectorColor& color, const char* operation) {
  std::string text;
  for (const uint8_t level : color) text += VectorNumber(level / 255.0) + " ";
  return text + operation + "\n";
}

std::string PdfLine(const std::vector<Eigen::Vector2d>& points) {
  std::string text;
  for (size_t i = 0; i < points.size(); ++i) text += Point(points[i]) + (i == 0 ? " m " : " l ");
  return text;
}

std::string PdfDisc(const FilledDisc& disc) {
  const Eigen::Vector2d& c = disc.center;
  const Eigen::Vector2d x(disc.radius, 0), y(0, disc.radius);
  const auto arc = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return Point(c + from + kQuarterCircle * to) + " " + Point(c + to + kQuarterCircle * from) +
           " " + Point(c + to) + " c ";
  };
  return Point(c + x) + " m " + arc(x, y) + arc(y, -x) + arc(-x, -y) + arc(-y, x) + "h f\n";
}

std::string PdfShape(const VectorShape& shape) {
  return std::visit(
      Overloaded{[](const FilledPath& path) {
                   std::string text = PdfColor(path.color, "rg");
                   for (const auto& loop : path.loops) text += PdfLine(loop) + "h ";
                   return text + "f*\n";
                 },
                 [](const FilledDisc& disc) { return PdfColor(disc.color, "rg") + PdfDisc(disc); },
                 [](const StrokedLine& line) {
                   return PdfColor(line.color, "RG") + VectorNumber(line.width) + " w " +
                          PdfLine(line.points) + "S\n";
                 }},
      shape);
}

std::string PdfContent(const VectorPage& page) {
  char scale[64];
  std::snprintf(scale, sizeof scale, "%.9f 0 0 %.9f 0 0 cm\n", kPointsPerMm, kPointsPerMm);
  std::string content = std::string(scale) + "1 J 1 j\n";
  for (const VectorGroup& group : page.groups) {
    content += "q\n";
    if (group.clip) {
      content += Point(group.clip->min()) + " " + Point(group.clip->sizes()) + " re W n\n";
    }
    for (const VectorShape& shape : group.shapes) content += PdfShape(shape);
    content += "Q\n";
  }
  return content;
}

std::string SvgColor(const VectorColor& color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0], color[1], color[2]);
  return text;
}

// SVG's y points down: y_svg = height - y.
std::string SvgPath(const std::vector<Eigen::Vector2d>& points, double height) {
  std::string text;
  for (size_t i = 0; i < points.size(); ++i) {
    text += (i == 0 ? "M" : "L") + Point({points[i].x(), height - points[i].y()});
  }
  return text;
}

std::string SvgShape(const VectorShape& shape, double height) {
  return std::visit(
      Overloaded{[&](const FilledPath& path) {
                   std::string text =
                       "<path fill-rule=\"evenodd\" fill=\"" + SvgColor(path.color) + "\" d=\"";
                   for (const auto& loop : path.loops) text += SvgPath(loop, height) + "Z";
                   return text + "\"/>\n";
                 },
                 [&](const FilledDisc& disc) {
                   return "<circle fill=\"" + SvgColor(disc.color) + "\" cx=\"" +
                          VectorNumber(disc.center.x()) + "\" cy=\"" +
                          VectorNumber(height - disc.center.y()) + "\" r=\"" +
                          VectorNumber(disc.radius) + "\"/>\n";
                 },
                 [&](const StrokedLine& line) {
                   return "<path fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
                          "stroke=\"" +
                          SvgColor(line.color) + "\" stroke-width=\"" + VectorNumber(line.width) +
                          "\" d=\"" + SvgPath(line.points, height) + "\"/>\n";
                 }},
      shape);
}

}  // namespace

std::string VectorNumber(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.5f", value);
  std::string number = text;
  number.erase(number.find_last_not_of('0') + 1);
  if (number.back() == '.') number.pop_back();
  return number == "-0" ? "0" : number;
}

Eigen::AlignedBox2d BoundsOf(const VectorShape& shape) {
  Eigen::AlignedBox2d box;
  const auto grow = [&](const std::vector<Eigen::Vector2d>& points, double by) {
    for (const Eigen::Vector2d& p : points) {
      box.extend(Eigen::Vector2d(p.array() - by));
      box.extend(Eigen::Vector2d(p.array() + by));
    }
  };
  std::visit(Overloaded{[&](const FilledPath& path) {
                          for (const auto& loop : path.loops) grow(loop, 0);
                        },
                        [&](const FilledDisc& disc) { grow({disc.center}, disc.radius); },
                        [&](const StrokedLine& line) { grow(line.points, line.width / 2); }},
             shape);
  return box;
}

VectorShape Moved(const VectorShape& shape, const Eigen::Vector2d& shift) {
  return std::visit(Overloaded{[&](FilledPath path) -> VectorShape {
                                 for (auto& loop : path.loops) {
                                   for (Eigen::Vector2d& p : loop) p += shift;
                                 }
                                 return path;
                               },
                               [&](FilledDisc disc) -> VectorShape {
                                 disc.center += shift;
                                 return disc;
                               },
                               [&](StrokedLine line) -> VectorShape {
                                 for (Eigen::Vector2d& p : line.points) p += shift;
                                 return line;
                               }},
                    shape);
}

std::string PdfOfPages(const std::vector<VectorPage>& pages, const std::string& title) {
  if (pages.empty()) throw Error("a PDF needs a page", ErrorKind::kSystem);
  // Objects: 1 catalog, 2 page tree, 3 information, then page and content of each page.
  std::vector<std::string> objects(3);
  std::string kids;
  for (size_t i = 0; i < pages.size(); ++i) {
    const std::string content = PdfContent(pages[i]);
    const std::string number = std::to_string(4 + 2 * i),
                      content_number = std::to_string(5 + 2 * i);
    kids += number + " 0 R ";
    objects.push_back("<< /Type /Page /Parent 2 0 R /Resources << >> /MediaBox [0 0 " +
                      VectorNumber(pages[i].width_mm * kPointsPerMm) + " " +
                      VectorNumber(pages[i].height_mm * kPointsPerMm) + "] /Contents " +
                      content_number + " 0 R >>");
    objects.push_back("<< /Length " + std::to_string(content.size()) + " >>\nstream\n" + content +
                      "endstream");
  }
  objects[0] =
      "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None "
      "/PickTrayByPDFSize true >> >>";
  objects[1] =
      "<< /Type /Pages /Count " + std::to_string(pages.size()) + " /Kids [ " + kids + "] >>";
  objects[2] = "<< /Title (" + PlainTitle(title) + ") /Producer (lfm) >>";
  std::string pdf = "%PDF-1.7\n";
  std::string table;
  for (size_t i = 0; i < objects.size(); ++i) {
    char entry[32];
    std::snprintf(entry, sizeof entry, "%010zu 00000 n \n", pdf.size());
    table += entry;
    pdf += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::string count = std::to_string(objects.size() + 1);
  const std::string start = std::to_string(pdf.size());
  pdf += "xref\n0 " + count + "\n0000000000 65535 f \n" + table;
  pdf += "trailer\n<< /Size " + count + " /Root 1 0 R /Info 3 0 R >>\nstartxref\n" + start +
         "\n%%EOF\n";
  return pdf;
}

std::string SvgOfPage(const VectorPage& page, const std::string& title) {
  const std::string width = VectorNumber(page.width_mm), height = VectorNumber(page.height_mm);
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height +
      "\">\n<title>" + PlainTitle(title) + "</title>\n";
  for (size_t i = 0; i < page.groups.size(); ++i) {
    const VectorGroup& group = page.groups[i];
    const std::string id = "clip" + std::to_string(i);
    if (group.clip) {
      svg += "<clipPath id=\"" + id + "\"><rect x=\"" + VectorNumber(group.clip->min().x()) +
             "\" y=\"" + VectorNumber(page.height_mm - group.clip->max().y()) + "\" width=\"" +
             VectorNumber(group.clip->sizes().x()) + "\" height=\"" +
             VectorNumber(group.clip->sizes().y()) + "\"/></clipPath>\n<g clip-path=\"url(#" + id +
             ")\">\n";
    } else {
      svg += "<g>\n";
    }
    for (const VectorShape& shape : group.shapes) svg += SvgShape(shape, page.height_mm);
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace lfm
