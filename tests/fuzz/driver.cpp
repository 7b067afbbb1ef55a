// Runs a fuzz target without libFuzzer, the same way each time: on all files of a corpus, then on a
// fixed number of mutations of them from a fixed seed.
//
//   fuzz_TARGET MUTATIONS FOLDER...     of a corpus
//   fuzz_TARGET FILE                    one input again
//
// An input that crashes, breaks a property or takes longer than 10 s is kept as crash_input.
#include "tests/fuzz/fuzz_target.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes present_input;

void keepInput(int signal) {
  const int file = open("crash_input", O_CREAT | O_WRONLY | O_TRUNC, 0644);
  if (file >= 0 && write(file, present_input.data(), present_input.size()) >= 0)
    std::fputs(signal == SIGALRM ? "hang: the input is kept as crash_input\n"
                                 : "crash: the input is kept as crash_input\n",
               stderr);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void test(Bytes input) {
  present_input = std::move(input);
  alarm(10);
  LLVMFuzzerTestOneInput(present_input.data(), present_input.size());
  alarm(0);
}

Bytes contentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<Bytes> readCorpus(const std::vector<std::string>& folders) {
  std::vector<Bytes> corpus;
  for (const std::string& folder : folders) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.is_regular_file())
        paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths)
      corpus.push_back(contentOf(path));
  }
  return corpus;
}

class Mutator {
public:
  explicit Mutator(const std::vector<Bytes>& corpus) : _corpus(corpus) {}

  Bytes next() {
    Bytes input = _corpus[below(_corpus.size())];
    for (std::size_t i = 1 + below(4); i > 0; --i)
      mutate(input);
    return input;
  }

private:
  std::size_t below(std::size_t limit) { return limit > 0 ? _random() % limit : 0; }

  void mutate(Bytes& input) {
    if (input.empty())
      input.push_back(' ');
    const std::size_t at = below(input.size());
    const auto place = [&] { return input.begin() + static_cast<std::ptrdiff_t>(at); };
    switch (below(8)) {
    case 0:
      input[at] ^= static_cast<std::uint8_t>(1u << below(8));
      break;
    case 1:
      input[at] = static_cast<std::uint8_t>(below(256));
      break;
    case 2:
      input.insert(place(), static_cast<std::uint8_t>(below(256)));
      break;
    case 3:
      input.erase(place(), place() + static_cast<std::ptrdiff_t>(
                                         std::min(1 + below(20), input.size() - at)));
      break;
    case 4: // a piece of this or another input
      insertPiece(input, at, below(2) == 0 ? input : _corpus[below(_corpus.size())]);
      break;
    case 5:
      writeInteger(input, at);
      break;
    case 6:
      replaceNumber(input, at);
      break;
    default:
      if (below(10) == 0)
        input.resize(at);
    }
  }

  void insertPiece(Bytes& input, std::size_t at, const Bytes& from) {
    const std::size_t begin = below(from.size());
    const std::size_t end = std::min(from.size(), begin + 1 + below(60));
    const Bytes piece(from.begin() + static_cast<std::ptrdiff_t>(begin),
                      from.begin() + static_cast<std::ptrdiff_t>(end));
    input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), piece.begin(), piece.end());
  }

  // Big endian, as in netCDF headers.
  void writeInteger(Bytes& input, std::size_t at) {
    constexpr std::int64_t odd[] = {
        0, 1, -1, 7, 255, 0x7fffffff, -0x80000000ll, 1ll << 40, 0x7fffffffffffffffll};
    const auto value = static_cast<std::uint64_t>(odd[below(std::size(odd))]);
    const std::size_t bytes = below(2) == 0 ? 4 : 8;
    for (std::size_t i = 0; i < bytes && at + i < input.size(); ++i)
      input[at + i] = static_cast<std::uint8_t>(value >> (8 * (bytes - 1 - i)));
  }

  void replaceNumber(Bytes& input, std::size_t at) {
    static const std::string numbers[] = {"0",    "-1",    "1e400", "1e-400", "nan",
                                          "inf",  ".5",    "0x10",  "1_000",  "9223372036854775808",
                                          "true", "\"x\"", "[1, 2]"};
    const auto is_digit = [](std::uint8_t c) { return c >= '0' && c <= '9'; };
    const auto from = input.begin() + static_cast<std::ptrdiff_t>(at);
    const auto begin = std::find_if(from, input.end(), is_digit);
    const auto end = std::find_if_not(begin, input.end(), is_digit);
    const std::string& number = numbers[below(std::size(numbers))];
    if (begin != input.end())
      input.insert(input.erase(begin, end), number.begin(), number.end());
  }

  const std::vector<Bytes>& _corpus;
  std::mt19937_64 _random{20161201};
};

} // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGALRM})
    std::signal(signal, keepInput);
  if (argc == 2) {
    test(contentOf(argv[1]));
    return 0;
  }
  const long mutations = argc > 2 ? std::atol(argv[1]) : 0;
  const std::vector<Bytes> corpus = readCorpus({argv + std::min(argc, 2), argv + argc});
  if (corpus.empty()) {
    std::fputs("usage: fuzz_TARGET MUTATIONS FOLDER... | fuzz_TARGET FILE\n", stderr);
    return 2;
  }
  for (const Bytes& input : corpus)
    test(input);
  Mutator mutator(corpus);
  for (long i = 0; i < mutations; ++i)
    test(mutator.next());
  std::printf("%zu files and %ld mutations\n", corpus.size(), mutations);
}
