// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/darknet_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

const std::string kNet = "[net]\nwidth=320\nheight = 224\nchannels=3\n";
const std::string kYolo = "[yolo]\nmask=0,1\nanchors=1,2, 3,4\nclasses=2\nnum=2\n";

std::string refusal(const std::string& cfg) {
  std::string wrong;
  ck_assert_msg(!read_darknet_cfg(cfg, wrong), "%s", cfg.c_str());
  return wrong;
}
void expect_refused(const std::string& cfg, const std::string& why) {
  const std::string wrong = refusal(cfg);
  ck_assert_msg(wrong.find(why) != std::string::npos, "\"%s\": %s", cfg.c_str(), wrong.c_str());
}

std::optional<std::uint64_t> weights_of(const std::string& layers) {
  std::string wrong;
  const auto network = read_darknet_cfg(kNet + layers + kYolo, wrong);
  ck_assert_msg(network.has_value(), "%s", wrong.c_str());
  return network->weights;
}

std::string file_of(std::int32_t major, std::int32_t minor, std::size_t numbers) {
  const std::int32_t version[3] = {major, minor, 0};
  std::string file(sizeof version + (major > 0 || minor >= 2 ? 8 : 4) + 4 * numbers, '\0');
  std::memcpy(file.data(), version, sizeof version);
  return file;
}

}  // namespace

START_TEST(a_configuration_gives_the_input_and_the_classes) {
  std::string wrong;
  const auto network = read_darknet_cfg("# a comment\r\n" + kNet + "\n; another\n" + kYolo, wrong);
  ck_assert(network.has_value());
  ck_assert_int_eq(network->input.width, 320);
  ck_assert_int_eq(network->input.height, 224);
  ck_assert_int_eq(network->classes, 2);
  ck_assert(network->weights == std::optional<std::uint64_t>(0));
}
END_TEST

START_TEST(weights_are_counted_through_the_layers) {
  // 3 planes, 8 filters of 3 x 3: 216 and 8 biases; normalised: three numbers more for each filter.
  ck_assert(weights_of("[convolutional]\nfilters=8\nsize=3\n") == 216 + 8);
  ck_assert(weights_of("[convolutional]\nfilters=8\nsize=3\nbatch_normalize=1\n") == 216 + 32);
  // 8 planes in 8 groups, then all of them into 4.
  ck_assert(weights_of("[convolutional]\nfilters=8\n[convolutional]\nfilters=8\ngroups=8\nsize=5\n"
                       "[maxpool]\nsize=2\nstride=2\n[dropout]\n[convolutional]\nfilters=4\n") ==
            24 + 8 + 200 + 8 + 32 + 4);
  // A route joins 8 and 4 planes; in two groups one takes half of them.
  const std::string two = "[convolutional]\nfilters=8\n[convolutional]\nfilters=4\n";
  ck_assert(weights_of(two + "[route]\nlayers = -1, 0\n[convolutional]\nfilters=1\n") == 32 + 36 + 12 + 1);
  ck_assert(weights_of(two + "[route]\nlayers=-2\ngroups=2\n[convolutional]\nfilters=1\n") ==
            32 + 36 + 4 + 1);
  // The largest layer: 2^16 planes, as many filters of 2^6 x 2^6, and the layer before.
  const std::string most = "[convolutional]\nfilters=65536\n";
  ck_assert(weights_of(most + most + "size=64\n") ==
            (3 + 1) * std::uint64_t{1 << 16} + (std::uint64_t{1} << 44) + (1 << 16));
  ck_assert(!weights_of("[connected]\noutput=5\n"));
}
END_TEST

START_TEST(what_is_no_configuration_of_a_detector_is_refused_with_the_reason) {
  expect_refused("", "no darknet configuration");
  expect_refused("not a model", "no darknet configuration");
  expect_refused("[convolutional]\n" + kNet, "no darknet configuration");
  expect_refused("[net]\nwidth=320\n" + kYolo, "no width and height");
  expect_refused("[net]\nwidth=9999\nheight=8\n" + kYolo, "no width and height");
  expect_refused("[net]\nwidth=8.5\nheight=8\n" + kYolo, "no width and height");
  expect_refused("[net]\nwidth=8\nheight=8\nchannels=1\n" + kYolo, "three planes");
  expect_refused(kNet + "[convolutional]\nfilters=18\n", "no [yolo] layer");
  expect_refused(kNet + "[convolutional]\nfilters=x\n" + kYolo, "its layer 0 has no usable filters");
  for (const char* wrong : {"size=65", "size=65536", "size=0", "size=-3", "filters=65537", "groups=0"})
    expect_refused(kNet + "[convolutional]\n" + wrong + "\n" + kYolo, "its layer 0 has no usable filters");
  expect_refused(kNet + "[convolutional]\nfilters=4\ngroups=2\n" + kYolo, "groups that do not divide");
  expect_refused(kNet + "[convolutional]\nfilters=4\n[route]\nlayers=-2\n" + kYolo,
                 "its layer 1 names a layer");
  expect_refused(kNet + "[route]\nlayers=0\n" + kYolo, "its layer 0 names a layer");
  expect_refused(kNet + "[yolo]\nnum=3\n", "names no classes");
  expect_refused(kNet + kYolo + "[yolo]\nmask=0\nclasses=3\n", "different classes");
  for (const char* mask : {"2", "-1", "0,2", "", "x"})
    expect_refused(kNet + "[yolo]\nmask=" + mask + "\nclasses=1\nnum=2\n", "an anchor that is not there");
}
END_TEST

START_TEST(every_beginning_of_a_configuration_is_read_or_refused) {
  const std::string whole = kNet + "[convolutional]\nfilters=8\nsize=3\n[route]\nlayers=-1,0\n" + kYolo;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    std::string wrong;
    const std::string part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    ck_assert(read_darknet_cfg(part, wrong).has_value() == wrong.empty());
  }
}
END_TEST

START_TEST(a_threshold_is_written_into_each_yolo_layer) {
  const std::string cfg = darknet_cfg_with_threshold("[net]\n [yolo]\r\nclasses=1\n[yolo]", .05);
  ck_assert_str_eq(cfg.c_str(), "[net]\n [yolo]\r\nthresh=0.05\nclasses=1\n[yolo]\nthresh=0.05\n");
  // Instead of the layer's own, wherever that stands; what other layers name so stays.
  const std::string instead = darknet_cfg_with_threshold(
      "[net]\nthresh=1\n[yolo]\nthresh = .7\r\nnum=1\n thresh=.8\n[a]\nthresh=2\n", .05);
  ck_assert_str_eq(instead.c_str(), "[net]\nthresh=1\n[yolo]\nthresh=0.05\nnum=1\n[a]\nthresh=2\n");
}
END_TEST

START_TEST(numbers_of_a_file_of_weights_are_counted_behind_its_header) {
  ck_assert(count_darknet_weights(file_of(0, 1, 7)) == std::optional<std::uint64_t>(7));
  ck_assert(count_darknet_weights(file_of(0, 2, 7)) == std::optional<std::uint64_t>(7));
  ck_assert(count_darknet_weights(file_of(1, 0, 0)) == std::optional<std::uint64_t>(0));
  ck_assert(!count_darknet_weights(file_of(0, 2, 7).substr(1)));
  ck_assert(!count_darknet_weights(file_of(0, 2, 0).substr(0, 14)));
  ck_assert(!count_darknet_weights(file_of(2000, 2, 7)));
  ck_assert(!count_darknet_weights(file_of(-1, 2, 7)));
  ck_assert(!count_darknet_weights("[net]\nwidth=320\n"));
  ck_assert(!count_darknet_weights(""));
}
END_TEST

// Sides of whole cells; a small network may look at twice as many pixels, a large one at as many as it has.
START_TEST(the_input_has_the_frames_aspect) {
  for (const Size own : {Size{64, 64}, Size{320, 320}, Size{416, 416}, Size{608, 608}, Size{96, 320}})
    for (const Size frame :
         {Size{640, 480}, Size{1920, 1080}, Size{480, 640}, Size{100, 100}, Size{4000, 10}}) {
      const auto scale = [&](Size s) {
        return std::min(double(s.width) / frame.width, double(s.height) / frame.height);
      };
      const Size input = darknet_input_for(frame, own);
      const int pixels = input.width * input.height, before = own.width * own.height;
      ck_assert(input.width % 32 == 0 && input.height % 32 == 0 && input.width > 0 && input.height > 0);
      ck_assert_msg(pixels <= 2 * before && (before < 448 * 448 || pixels <= before), "%d x %d", input.width,
                    input.height);
      ck_assert(scale(input) >= scale(own));
    }
  // 16:9 fills the square by 9/16 only: at twice the pixels 1.8 times as large, less what whole cells lose.
  ck_assert_int_ge(darknet_input_for({1920, 1080}, {320, 320}).width, 544);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "darknet_file",
      {a_configuration_gives_the_input_and_the_classes, weights_are_counted_through_the_layers,
       what_is_no_configuration_of_a_detector_is_refused_with_the_reason,
       every_beginning_of_a_configuration_is_read_or_refused, a_threshold_is_written_into_each_yolo_layer,
       the_input_has_the_frames_aspect, numbers_of_a_file_of_weights_are_counted_behind_its_header});
}
