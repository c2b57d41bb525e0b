// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes a small darknet model by hand: the text of its configuration, and its weights.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace cerberus::tests::darknet {

// A box as wide and high as the anchor, in the middle of each cell. The scores are before the sigmoid.
struct Anchor {
  int width = 0, height = 0;  // pixels
  float object = 0;
  std::vector<float> classes;
};

// One cell over the whole picture of `side` x `side` pixels, with one yolo layer an anchor: a convolution as large as the
// picture, before each of them.
inline std::string cfg(int side, const std::vector<Anchor>& anchors) {
  const std::string pixels = std::to_string(side);
  std::string text = "[net]\nwidth=" + pixels + "\nheight=" + pixels + "\nchannels=3\n";
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const Anchor& anchor = anchors[i];
    // Pictures are no layer: each branch begins with the first convolution, which hands them on.
    if (i == 0)
      text += "\n[convolutional]\nfilters=3\nsize=1\nstride=1\npad=0\nactivation=linear\n";
    else
      text += "\n[route]\nlayers=0\n";
    text += "\n[convolutional]\nfilters=" + std::to_string(5 + anchor.classes.size()) + "\nsize=" + pixels +
            "\nstride=" + pixels +
            "\npad=0\nactivation=linear\n\n[yolo]\nmask=0\nanchors=" + std::to_string(anchor.width) + "," +
            std::to_string(anchor.height) + "\nclasses=" + std::to_string(anchor.classes.size()) +
            "\nnum=1\n";
  }
  return text;
}

// Version 0.2, no pictures seen, then biases and kernels, layer by layer. light: weight of each pixel in the object's
// score.
inline std::string weights(int side, const std::vector<Anchor>& anchors, float light = 0) {
  std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};  // the first convolution hands on
  const auto pixels = static_cast<std::size_t>(3 * side * side);
  for (const Anchor& anchor : anchors) {
    numbers.insert(numbers.end(), {0, 0, 0, 0, anchor.object});
    numbers.insert(numbers.end(), anchor.classes.begin(), anchor.classes.end());
    for (std::size_t filter = 0; filter < 5 + anchor.classes.size(); ++filter)
      numbers.insert(numbers.end(), pixels, filter == 4 ? light : 0);
  }
  const std::int32_t header[5] = {0, 2, 0, 0, 0};
  std::string file(sizeof header + numbers.size() * sizeof(float), '\0');
  std::memcpy(file.data(), header, sizeof header);
  std::memcpy(file.data() + sizeof header, numbers.data(), numbers.size() * sizeof(float));
  return file;
}

}  // namespace cerberus::tests::darknet
