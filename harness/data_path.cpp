#include "harness/data_path.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>

#include "sampling/error.h"

namespace abn::harness {

namespace fs = std::filesystem;

namespace {

/// The folder of the running program; empty where /proc does not tell.
fs::path program_folder() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path();
}

void append_once(std::vector<fs::path>& folders, const fs::path& folder) {
  const fs::path normal = folder.lexically_normal();
  if (std::find(folders.begin(), folders.end(), normal) == folders.end()) folders.push_back(normal);
}

}  // namespace

std::vector<fs::path> data_folders() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("ABN_DATA"); chosen != nullptr && *chosen != '\0') {
    if (!fs::path(chosen).is_absolute()) {
      throw ConfigError("environment variable ABN_DATA: '" + std::string(chosen) +
                        "' is a relative path; give the absolute path of the folder that holds reference_images and "
                        "experiments, or unset it");
    }
    append_once(folders, chosen);
  }
  if (const fs::path program = program_folder(); !program.empty()) {
    append_once(folders, program.parent_path() / "share" / "abn");
  }
#ifdef ABN_INSTALL_DATADIR
  append_once(folders, ABN_INSTALL_DATADIR);
#endif
#ifdef ABN_SOURCE_DIR
  append_once(folders, ABN_SOURCE_DIR);
#endif
  return folders;
}

fs::path find_data(const fs::path& name) {
  if (name.empty() || name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end()) {
    throw ConfigError("data file '" + name.string() +
                      "': the name must be relative to a data folder, without '..', such as "
                      "reference_images/apple.png");
  }
  std::string places;
  for (const fs::path& folder : data_folders()) {
    std::error_code unreadable;  // a folder that cannot be searched counts as one without the file
    if (const fs::path candidate = folder / name; fs::exists(candidate, unreadable)) return candidate;
    places += (places.empty() ? "" : ", ") + folder.string();
  }
  throw IoError("data file " + name.string() + " not found; looked in " + places +
                ". Set ABN_DATA to the absolute path of the folder that holds it, or run `cmake --install`");
}

}  // namespace abn::harness
