// SPDX-License-Identifier: LGPL-2.1-or-later
// Which connected components of the pixels that differ from the background model are objects, and which are ghosts:
// places that an object left. Evidence: how much of a component moved lately, whether its outline is an edge of the
// frame or of the background, and whether it came from outside the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/components/component_origins.h"
#include "vision/components/flashes.h"
#include "vision/components/outline_contrast.h"
#include "vision/components/resting_ghosts.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Frames: a pixel that is learnt anew because it was wrong, or from one frame only, counts as this old.
// Origin unknown: kept from the first version; guard: mean F of bench-quality.
inline constexpr std::uint8_t kRelearn = 4;

// Durations. Those of rest are in ticks, by which the plane `quiet` counts: as many frames as come nearest to 0.04 s, so that
// its 8 bits reach for 7 to 10 s. Those of learning are in frames.
struct FrameWindows {
  int fresh;   // 0.04 s: motion in the last tick
  int moving;  // 0.12 s, at least 3 ticks: a pixel that moved so lately is moving
  int recent;  // 1 s: a pixel that moved so lately may have stopped for a moment
  // 10 s, 50 to 250 ticks (6.8 s at 37 frames a second, 8.3 s at 30 and 60): how long an object that stopped stays
  // foreground
  int hold;
  int newest;      // frames, 1 s: a background learnt for less may still be wrong ...
  int young;       // ... and for less than 2 s may show an object
  int tick;        // frames
  double seconds;  // from frame to frame
  // seconds: > 0.
  static FrameWindows of(double seconds);
};

// What may be left out: see background/mechanisms.h.
struct ComponentMechanisms {
  bool flashes = true;           // flashes.h
  bool was_empty = true;         // what left the picture moves no more: decide()
  bool sides_go_on = true;       // component_sides.h
  bool origins = true;           // component_origins.h
  bool resting_ghosts = true;    // resting_ghosts.h
  bool merge_neighbours = true;  // of a young background
};

struct ComponentInput {
  GrayView frame, background;  // blurred alike, under the same light
  GrayView age;                // frames for which the model has learnt a pixel
  GrayView quiet;              // ticks since a pixel moved
  bool still = false;          // the camera stands
  bool registered = false;     // it moves, and the model fits the frame nearly everywhere
  // The columns that the frame covers, per row; empty: all.
  std::span<const RowSpan> visible{};
  ComponentMechanisms mechanisms{};

  // Edges of the scene lie at the same pixels of the frame and of the background.
  bool is_aligned() const { return still || registered; }
  VisibleColumns columns() const { return {visible, frame.width}; }
};

class ForegroundComponents {
 public:
  void preallocate(Size picture);
  // The background model starts anew.
  void reset();
  // mask in: the pixels that differ from the background; out: the objects. absorb := the pixels that the model shall
  // take over. Returns true if the model is young under one of the objects: merge_neighbours() is due then.
  bool classify(const ComponentInput& input, const FrameWindows& windows, MutableBitView mask,
                MutableBitView absorb);
  // Where the background is young, the ghost of an object that stood there at the start looks like an object: a moving
  // edge runs along it, and a few frames cannot tell the two apart. Components close to each other are then one object:
  // two of similar size, or two narrow ones, with an even gap between them (the gap is filled), or a large component
  // and its fragments (the fragments are dropped: they would join a strip of background to it). Two whose
  // facing sides are an object's stay two where the picture is aligned. A small one whose own sides are both is no fragment
  // before a camera that stands. (Before a moving one it cost .01 of MOTA on davis_tennis: bench-variants.)
  // closed: the mask with its gaps closed, used as scratch memory.
  void merge_neighbours(const ComponentInput& input, const FrameWindows& windows, MutableBitView closed,
                        MutableBitView mask);
  // Called last: fills the gap between fragments of one object that lie one above the other (fragment_joining.h), if
  // the camera stands. Registration errors of a moving camera lie along edges of the background. closed: as above.
  void join_fragments(const ComponentInput& input, MutableBitView closed, MutableBitView mask);
  std::size_t bytes() const;

 private:
  // Of one component.
  struct Evidence {
    int moving_pixels = 0, recent_pixels = 0;  // pixels that moved within these windows
    int young_pixels = 0, newest_pixels = 0;   // pixels learnt for less than the windows `young` and `newest`
    int outline = 0;                           // outline pixels to the left and right
    ComponentOrigins::Overlap overlap;
    ComponentOrigins::Origin origin = ComponentOrigins::Origin::outside;
    OutlineContrast contrast;  // of those that lie inside the frame and the background
    bool moved_recently = false, moving = false;
    bool object = false, ghost = false;  // decided by the outline; both false: undecided
    bool doubtful = false;               // stays only while it moves
    bool kept = false;                   // is an object
    bool flash = false;                  // is none, and nothing is learnt from it
    bool merged = false;                 // with a neighbour
    bool fragment = false;               // of a larger neighbour
  };
  void measure(const ComponentInput& input, const FrameWindows& windows);
  void decide(const ComponentInput& input, const Component& component, Evidence& evidence) const;
  void remove_flashes(const ComponentInput& input, const FrameWindows& windows, BitView mask);
  void doubt_edges(const ComponentInput& input, BitView mask);
  void find_ghosts();
  void absorb_rest(const ComponentInput& input, const FrameWindows& windows, MutableBitView absorb) const;

  Labeller labeller_;
  std::vector<Evidence> evidence_;  // by component
  Flashes flashes_;
  ComponentOrigins origins_;
  RestingGhosts resting_ghosts_;
  int moved_ =
      3;  // frames since the camera stood; as many as `shake` and more: it has moved away from what it saw
};

}  // namespace cerberus::vision
