#include "parts.hpp"

#include <frontlux/file.hpp>
#include <frontlux/report/report.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <stdexcept>
#include <string_view>
#include <zlib.h>

namespace frontlux::report {
namespace {

// As text between tags.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c == '&' || c == '<' || c == '>')
      out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : "&gt;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return out;
}

void check(std::span<const ReportedRun> runs) {
  if (runs.empty()) throw std::invalid_argument("a report needs at least one run");
  for (const ReportedRun& run : runs) {
    if (run.recording == nullptr) throw std::invalid_argument(run.name + ": a run without a recording");
    const std::size_t robots = run.recording->head.robots.size();
    if (robots == 0) throw std::invalid_argument(run.name + ": a recording without robots");
    if (run.recording->steps.empty()) throw std::invalid_argument(run.name + ": a recording without steps");
    for (const planner::RecordedStep& step : run.recording->steps)
      if (step.step.robots.size() != robots || step.known.size() != robots)
        throw std::invalid_argument(run.name + ": step " + std::to_string(step.step.number) + " has " +
                                    std::to_string(step.step.robots.size()) + " robots instead of " +
                                    std::to_string(robots));
  }
}

// Bytes in zlib's format (RFC 1950), which browsers read by themselves.
std::string compressed(std::string_view bytes) {
  uLongf length = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(length, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION) != Z_OK)
    throw std::runtime_error("there is not enough memory to compress a report; close other programs");
  out.resize(length);
  return out;
}

// Letters, digits, + and /, four for each three bytes; = fills up the end.
std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < here ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= here ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

// The facts and the data of a run: the length of the facts in four bytes, the lowest first, and both.
std::string packed(const ReportedRun& run, const std::string& version) {
  const std::string facts = detail::run_facts(run, version);
  std::string bytes;
  if (facts.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::runtime_error(run.name + ": what is known of the run has " + std::to_string(facts.size()) +
                             " bytes, too many for a report");
  append_number(bytes, static_cast<std::uint32_t>(facts.size()));
  bytes.append(facts).append(detail::run_data(*run.recording));
  return base64(compressed(bytes));
}

std::string title_of(std::span<const ReportedRun> runs) {
  std::string title;
  for (const ReportedRun& run : runs) title.append(title.empty() ? "" : ", ").append(run.name);
  return escaped(detail::unicode_of(title) + " - frontlux");
}

}  // namespace

void write_report(const std::filesystem::path& file, std::span<const ReportedRun> runs,
                  const std::string& version) {
  check(runs);
  const std::string_view page = detail::page();
  const std::size_t title = page.find(detail::kTitleMark), data = page.find(detail::kRunsMark);
  if (title == std::string_view::npos || data == std::string_view::npos || data < title)
    throw std::logic_error("the page that is built in lacks its marks");
  write_file(file, [&](std::ostream& out) {
    out << page.substr(0, title) << title_of(runs);
    const std::size_t after = title + detail::kTitleMark.size();
    out << page.substr(after, data - after);
    for (const ReportedRun& run : runs)
      out << "<script type=\"text/plain\" class=\"run\">" << packed(run, version) << "</script>\n";
    out << page.substr(data + detail::kRunsMark.size());
  });
}

}  // namespace frontlux::report
