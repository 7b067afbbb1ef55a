#include "miniapp/commands/companion.hpp"

#include "contact/base/error.hpp"
#include "miniapp/commands/failure.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <unistd.h>

namespace brickwall::miniapp {

int startCompanion(int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.empty() || word.find_first_not_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos)
    return 0;
  std::error_code fault;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", fault);
  std::string path = self.parent_path() / ("brickwall-" + word);
  const bool is_known = word == "report" || word == "study"; // which no deck is taken for
  if (fault || (!is_known && access(path.c_str(), X_OK) != 0))
    return 0;
  argv[1] = path.data();
  execv(path.c_str(), argv + 1);
  printMessage("error: " + path + " cannot be started: " + std::strerror(errno));
  return static_cast<int>(ExitCode::internal);
}

} // namespace brickwall::miniapp
