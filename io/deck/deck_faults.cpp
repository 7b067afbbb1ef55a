#include "io/deck/deck_faults.hpp"

#include "io/deck/terminal_text.hpp"

#include <algorithm>
#include <tuple>

namespace brickwall::io {
namespace {

// Marks `length` bytes from `column` under the line; tabs stay tabs, UTF-8 continuation bytes take
// no place.
std::string marksUnder(const std::string& line, int column, int length) {
  const auto isContinuation = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
  const std::size_t begin = std::min<std::size_t>(std::max(column - 1, 0), line.size());
  const std::size_t end = std::min<std::size_t>(begin + std::max(length, 1), line.size());
  std::string marks;
  for (std::size_t i = 0; i < begin; ++i)
    if (!isContinuation(line[i]))
      marks += line[i] == '\t' ? '\t' : ' ';
  std::string carets;
  for (std::size_t i = begin; i < end; ++i)
    if (!isContinuation(line[i]))
      carets += '^';
  return marks + (carets.empty() ? "^" : carets);
}

} // namespace

DeckFaults::DeckFaults(std::string path, std::vector<std::string> lines,
                       std::vector<std::string> overrides)
    : _path(std::move(path)), _lines(std::move(lines)), _overrides(std::move(overrides)) {}

void DeckFaults::add(const Position& at, const std::string& subject, const std::string& found,
                     const std::string& expected, const std::string& nearest) {
  Fault fault{at, subject, found, expected, nearest};
  fault.at.line = std::min(std::max(at.line, 1), std::max(1, numLines()));
  _faults.push_back(std::move(fault));
}

void DeckFaults::warn(const Position& at, const std::string& text) {
  _warnings.push_back({at, "", text, "", ""});
}

std::string DeckFaults::placeOf(const Position& at) const {
  return at.option >= 0 ? "--set " + _overrides.at(static_cast<std::size_t>(at.option))
                        : _path + ":" + std::to_string(at.line);
}

std::string DeckFaults::describe(const Fault& fault) const {
  const bool from_option = fault.at.option >= 0;
  std::string out = placeOf(fault.at) + ": ";
  if (!fault.subject.empty())
    out += fault.subject + ": ";
  out += "found " + fault.found;
  if (!fault.expected.empty())
    out += ", expected " + fault.expected;
  if (!fault.nearest.empty())
    out += "; did you mean \"" + fault.nearest + "\"?";
  out = terminalText(out, "\t") + "\n";
  if (!from_option && fault.at.line <= numLines()) {
    std::string line = _lines[static_cast<std::size_t>(fault.at.line - 1)];
    if (line.size() > 160) // too long for a terminal
      line.resize(160);
    const std::string number = std::to_string(fault.at.line);
    out += "  " + number + " | " + terminalText(line, "\t") + "\n";
    out += "  " + std::string(number.size(), ' ') + " | " +
           marksUnder(line, fault.at.column, fault.at.length) + "\n";
  }
  return out;
}

std::vector<DeckFaults::Fault> DeckFaults::sorted(std::vector<Fault> faults) {
  std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) {
    const auto place = [](const Fault& f) {
      // Overrides come last, in their own order.
      return std::make_tuple(f.at.option, f.at.option < 0 ? f.at.line : 0,
                             f.at.option < 0 ? f.at.column : 0);
    };
    return place(a) < place(b);
  });
  return faults;
}

std::string DeckFaults::message() const {
  constexpr std::size_t most = 200; // that anybody reads
  std::string out;
  const std::vector<Fault> all = sorted(_faults);
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    out += describe(all[i]);
  if (all.size() > most)
    out += "and " + std::to_string(all.size() - most) +
           (all.size() == most + 1 ? " more fault\n" : " more faults\n");
  if (!out.empty())
    out.pop_back(); // the caller prints the last line end
  return out;
}

std::vector<std::string> DeckFaults::warnings() const {
  std::vector<std::string> lines;
  for (const Fault& warning : sorted(_warnings))
    lines.push_back(terminalText(placeOf(warning.at) + ": " + warning.found, "\t"));
  return lines;
}

} // namespace brickwall::io
