#include "svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace corotet::program {
namespace {

constexpr double width = 760, height = 460, left = 70, right = 220, top = 40, bottom = 55;
constexpr double inner_width = width - left - right, inner_height = height - top - bottom;

/// Told apart by eyes that see colours differently, too (Okabe & Ito 2008).
constexpr std::array<const char*, 8> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#e69f00", "#56b4e9", "#000000", "#8a8a00"};

const char* colour(std::size_t index) { return colours[index % colours.size()]; }

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

class Canvas {
 public:
  explicit Canvas(double canvas_height) {
    add(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" )"
        R"(font-family="sans-serif" font-size="12">)"
        "\n"
        R"(<rect width="100%" height="100%" fill="white"/>)"
        "\n",
        width, canvas_height);
  }

  void text(double x, double y, const std::string& what, const char* anchor = "middle", const char* more = "") {
    add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y, anchor, more, escaped(what));
  }
  void line(double x0, double y0, double x1, double y1, const char* stroke, double thickness = 1) {
    add("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", x0, y0,
        x1, y1, stroke, thickness);
  }
  void box(double x, double y, double w, double h, const char* fill) {
    add("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x, y, w, h, fill);
  }
  /// One of four shapes, told apart without colour.
  void mark(double x, double y, std::size_t shape, const char* fill) {
    constexpr double r = 4;
    if (shape % 4 == 0) return add("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, r, fill);
    if (shape % 4 == 1) return box(x - r, y - r, 2 * r, 2 * r, fill);
    const double up = shape % 4 == 2 ? -1 : 1;
    add("<polygon points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\" fill=\"{}\"/>\n", x, y + up * 1.3 * r,
        x - 1.2 * r, y - up * r, x + 1.2 * r, y - up * r, fill);
  }
  void path(const std::vector<std::pair<double, double>>& points, const char* stroke) {
    add("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" points=\"", stroke);
    for (const auto& [x, y] : points) add("{:.1f},{:.1f} ", x, y);
    text_ += "\"/>\n";
  }

  [[nodiscard]] std::string finish() && { return std::move(text_) + "</svg>\n"; }

 private:
  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  std::string text_;
};

/// Decades of a logarithmic axis, at least one, with room around the values.
struct LogAxis {
  double least = std::numeric_limits<double>::infinity(), most = -least;  // log10

  void include(double value) {
    least = std::min(least, std::log10(value));
    most = std::max(most, std::log10(value));
  }
  void finish() {
    if (least > most) least = most = 0;
    least -= 0.08;
    most += 0.08;
    if (most - least < 1) {
      const double middle = (least + most) / 2;
      least = middle - 0.5;
      most = middle + 0.5;
    }
  }
  [[nodiscard]] double part(double value) const { return (std::log10(value) - least) / (most - least); }

  /// Where lines go: 1, 2, 5 of each decade if there are few decades.
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> values;
    for (int decade = static_cast<int>(std::floor(least)); decade <= std::ceil(most); ++decade)
      for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit > 1 && most - least > 2.5) continue;
        const double log = decade + std::log10(digit);
        if (log >= least && log <= most) values.push_back(digit * std::pow(10.0, decade));
      }
    return values;
  }
};

bool drawable(const std::pair<double, double>& p) {
  return p.first > 0 && p.second > 0 && std::isfinite(p.first) && std::isfinite(p.second);
}

}  // namespace

std::string LogLogPlot::svg() const {
  LogAxis x_axis, y_axis;
  for (const PlotSeries& s : series)
    for (const auto& point : s.points)
      if (drawable(point)) {
        x_axis.include(point.first);
        y_axis.include(point.second);
      }
  x_axis.finish();
  y_axis.finish();
  const auto x_of = [&](double x) { return left + inner_width * x_axis.part(x); };
  const auto y_of = [&](double y) { return top + inner_height * (1 - y_axis.part(y)); };

  Canvas canvas(height);
  canvas.text(left, 22, title, "start", "font-size=\"15\" font-weight=\"bold\"");
  for (const double x : x_axis.ticks()) {
    canvas.line(x_of(x), top, x_of(x), top + inner_height, "#dddddd");
    canvas.text(x_of(x), top + inner_height + 17, fmt::format("{:.4g}", x));
  }
  for (const double y : y_axis.ticks()) {
    canvas.line(left, y_of(y), left + inner_width, y_of(y), "#dddddd");
    canvas.text(left - 6, y_of(y) + 4, fmt::format("{:.4g}", y), "end");
  }
  canvas.line(left, top, left, top + inner_height, "black");
  canvas.line(left, top + inner_height, left + inner_width, top + inner_height, "black");
  canvas.text(left + inner_width / 2, height - 15, x_label);
  canvas.text(0, 0, y_label, "middle",
              fmt::format("transform=\"translate(16,{:.0f}) rotate(-90)\"", top + inner_height / 2).c_str());

  for (std::size_t s = 0; s < series.size(); ++s) {
    std::vector<std::pair<double, double>> points;
    for (const auto& point : series[s].points)
      if (drawable(point)) points.emplace_back(x_of(point.first), y_of(point.second));
    if (series[s].line) canvas.path(points, colour(s));
    if (series[s].marks)
      for (const auto& [x, y] : points) canvas.mark(x, y, s, colour(s));
    const double y = top + 10 + 18 * double(s), x = left + inner_width + 18;
    if (series[s].line) canvas.line(x - 9, y - 4, x + 9, y - 4, colour(s), 1.5);
    if (series[s].marks) canvas.mark(x, y - 4, s, colour(s));
    canvas.text(x + 14, y, series[s].name, "start");
  }
  return std::move(canvas).finish();
}

std::string StackedBars::svg() const {
  constexpr double bar_height = 22, gap = 12, names = 230;
  double most = 0;
  for (const Bar& bar : bars) {
    double sum = 0;
    for (const double part : bar.parts) sum += std::isfinite(part) ? part : 0;
    most = std::max({most, sum, std::isfinite(bar.total) ? bar.total : 0});
  }
  if (!(most > 0)) most = 1;
  const double bars_height = double(bars.size()) * (bar_height + gap), span = width - names - 30;
  Canvas canvas(top + 26 + bars_height + bottom);
  canvas.text(14, 22, title, "start", "font-size=\"15\" font-weight=\"bold\"");
  for (std::size_t p = 0; p < part_names.size(); ++p) {
    const double x = 14 + 100 * double(p);
    canvas.box(x, top, 12, 12, colour(p));
    canvas.text(x + 17, top + 11, part_names[p], "start");
  }
  const double total_x = 14 + 100 * double(part_names.size());
  canvas.line(total_x + 6, top - 2, total_x + 6, top + 14, "black", 2);
  canvas.text(total_x + 17, top + 11, "together", "start");

  const double first = top + 26;
  const double step = std::pow(10.0, std::floor(std::log10(most / 2)));
  const double tick = most / step > 10 ? 5 * step : most / step > 5 ? 2 * step : step;
  for (double value = 0; value <= most * 1.0001; value += tick) {
    const double x = names + span * value / most;
    canvas.line(x, first, x, first + bars_height, "#dddddd");
    canvas.text(x, first + bars_height + 16, fmt::format("{:.3g}", value));
  }
  canvas.text(names + span / 2, first + bars_height + 38, x_label);
  for (std::size_t b = 0; b < bars.size(); ++b) {
    const double y = first + double(b) * (bar_height + gap) + gap / 2;
    canvas.text(names - 8, y + 15, bars[b].name, "end");
    double x = names;
    for (std::size_t p = 0; p < bars[b].parts.size(); ++p) {
      const double length = std::isfinite(bars[b].parts[p]) ? span * bars[b].parts[p] / most : 0;
      canvas.box(x, y, length, bar_height, colour(p));
      x += length;
    }
    if (std::isfinite(bars[b].total)) {
      const double at_total = names + span * bars[b].total / most;
      canvas.line(at_total, y - 3, at_total, y + bar_height + 3, "black", 2);
    }
  }
  return std::move(canvas).finish();
}

}  // namespace corotet::program
