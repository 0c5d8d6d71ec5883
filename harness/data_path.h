// Where data files lie: reference images and experiments.
#pragma once

#include <filesystem>
#include <vector>

namespace abn::harness {

/// The folders that may hold data files, in the order they are searched: the one named by the environment variable
/// ABN_DATA, `share/abn` of the installation (beside the program's `bin`, then as configured), the source tree. The
/// working directory is never among them, so a program finds the same files wherever it is started.
/// Throws ConfigError if ABN_DATA is a relative path, which would mean another folder in every working directory.
std::vector<std::filesystem::path> data_folders();

/// The first existing file or folder `name` ("reference_images/apple.png") of data_folders(), as an absolute path.
/// Throws IoError listing the places looked at, ConfigError if `name` is empty, absolute or leaves its folder ("..").
std::filesystem::path find_data(const std::filesystem::path& name);

}  // namespace abn::harness
