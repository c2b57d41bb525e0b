// SPDX-License-Identifier: LGPL-2.1-or-later
// The places of real video that tests and benches may use. None of it is part of the project: a test that finds none
// skips and names what is missing. This is the only file with these paths.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace cerberus::tests {

// The folder of research data with ground truth: the environment's CERBERUS_DATA; else ../shared/data beside the
// checkout.
std::optional<std::filesystem::path> data_folder();

// The folder of published networks: the environment's CERBERUS_MODELS; else ../shared/models beside the checkout.
std::optional<std::filesystem::path> models_folder();

// vtest.avi, people on a campus seen by a still camera: the environment's CERBERUS_VIDEO; else what `pipelines/setup`
// put into the build folder; else the one of the data folder or of Debian's package opencv-doc.
std::optional<std::filesystem::path> vtest();
// What decodes it, for gst_parse_launch.
std::optional<std::string> vtest_source();

// The text for a user without the data.
inline constexpr char kNoVtest[] =
    "no vtest.avi (`pipelines/setup video FOLDER` fetches it; CERBERUS_VIDEO names its place)";
inline constexpr char kNoData[] = "no research data (CERBERUS_DATA names its folder)";

inline constexpr char kNoModels[] = "no published networks (CERBERUS_MODELS names their folder)";

// What a program needs that judges what is found on real video.
struct RealVideo {
  std::filesystem::path data;  // data_folder()
  std::string vtest;           // vtest_source()
};
// Nothing where one of them is missing; prints which.
std::optional<RealVideo> real_video();
inline constexpr int kSkipped = 77;  // the exit status of a skipped test, for Meson

}  // namespace cerberus::tests
