// SPDX-License-Identifier: LGPL-2.1-or-later
// Which connected parts of what differs from the scene's memory are objects: by how much of them has moved, by whether
// their outline is an edge of the frame or one of the memory, and by where they came from.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vision/background/component_origins.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// How many frames of this rate things take. Limits are those of the planes' 8 bits.
struct ClassificationWindows {
  int fresh = 1;    // what moves at this moment: the last frame, 0.04 s
  int now = 3;      // what moved so lately moves: 3 frames, 0.12 s
  int lately = 25;  // 1 s: what moved so lately may have stopped for a moment
  int young = 50;   // 2 s: what the memory has learnt for less may be an object's place
  int hold = 250;   // 10 s, 50 to 250 frames: how long something that stopped is kept
  // seconds: from frame to frame, > 0.
  static ClassificationWindows of(double seconds);
};

struct ClassificationPlanes {
  GrayView present, memory;  // the frame and the memory, blurred alike, under the same light
  GrayView age;              // frames the memory has learnt a pixel for
  GrayView quiet;            // frames since a pixel moved
  bool still = false;        // the camera stands
  bool followed = false;     // it moves, and the memory fits the frame nearly everywhere
  // What the frame shows of each row; none: all.
  std::span<const RowSpan> shown{};
};

class ForegroundComponents {
 public:
  void preallocate(Size picture);
  // The memory begins.
  void begin();
  // mask: what differs in; out, the objects. absorb := what the memory shall take over. True if the memory is young
  // under one of the objects: then join() is due.
  bool judge(const ClassificationPlanes& planes, const ClassificationWindows& windows, MutableBitView mask,
             MutableBitView absorb);
  // A place that somebody leaves who stood there when the scene began looks like an object: the memory has his picture,
  // a moving edge goes along it, and from a few frames nobody can tell which is which. So where the memory is young,
  // what lies close together is one: two of about a size, or two fronts, with an even gap between them (which belongs
  // to it), or a big part and its pieces (which are dropped: joined to it they would be a strip of the scene beside
  // it). closed: the mask with its gaps closed, used as scratch; mask: in and out.
  void join(const ClassificationPlanes& planes, const ClassificationWindows& windows, MutableBitView closed,
            MutableBitView mask);
  // After these: what lies between fronts of one thing, one above the other, belongs to it (scene_fronts.h), if the
  // camera stands: errors of registration lie along edges of the scene, which are sides of nothing. closed: as for
  // join().
  void join_fronts(const ClassificationPlanes& planes, MutableBitView closed, MutableBitView mask);
  std::size_t bytes() const;

 private:
  // What is known of a connected part.
  struct Part {
    int now = 0, lately = 0;    // pixels that moved in the last frames, and for some time back
    int young = 0, newest = 0;  // pixels that the memory has learnt for no longer than those windows
    int outline = 0;            // places of it to the left and right
    int frame = 0, memory = 0;  // contrast across those in frame and memory ...
    int compared = 0;           // ... of which so many are known in both
    // Places of it, above and below too, that are an edge of one of them only.
    int frame_only = 0, memory_only = 0;
    int places = 0;
    ComponentOrigins::Before before;
    ComponentOrigins::Origin origin = ComponentOrigins::Origin::elsewhere;
    bool moving = false, fresh = false;  // has moved lately, and moves
    bool ghost = false, object = false;  // by its outline
    bool doubtful = false;               // needs its owner's motion
    bool kept = false;                   // is an object
    bool whole = false;                  // has been joined with another one
    bool piece = false;                  // of another one
  };
  void measure(const ClassificationPlanes& planes, const ClassificationWindows& windows, BitView mask);
  void measure_edges(const ClassificationPlanes& planes, const Run& run, BitView mask, Part& part) const;
  void weigh(const ClassificationPlanes& planes, const Component& component, Part& part) const;
  void find_places();
  void find_owners();

  Labeller labeller_;
  std::vector<Part> parts_;
  ComponentOrigins origins_;
  int moved_ = 3;  // frames since the camera stood; as many as end what is known: it never did
};

}  // namespace cerberus::vision
