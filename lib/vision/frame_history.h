// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides from times and marks alone whether a frame continues the scene of the frames before it or begins a new one,
// and how far apart the frames of a scene are. Not thread-safe.
#pragma once

#include <chrono>
#include <optional>

namespace cerberus::vision {

class FrameHistory {
 public:
  using Time = std::chrono::nanoseconds;

  // Guarded by unit-frame_history, which checks each of them. None was swept.
  struct Parameters {
    // A frame that comes later than both, gap_factor usual distances and gap_seconds, begins a new scene. Derived: what
    // moved has moved too far then for a difference of neighbours to mean anything. Live cameras that stall for a
    // moment stay below gap_seconds; cameras that send a frame every few seconds are judged by their own distance.
    double gap_factor = 3, gap_seconds = .25;
    // Steps of the times by more than this, and by more than outlier_factor usual distances, are no gap: the time of a
    // single frame is wrong, unless those of more than `outliers` in a row are. The frames are taken to follow at the
    // usual distance until then. In a stream that has shown a wrong gap, every gap is judged so. Chosen: a camera that stalls comes back within outlier_forwards, or its stream begins
    // anew; outlier_backwards is beyond what a decoder reorders.
    double outlier_forwards = 10, outlier_backwards = 1, outlier_factor = 25;
    int outliers = 2;
    double smoothing = .1;        // weight of a new distance in the usual one: about the last ten frames
    double missing_factor = 1.5;  // usual distances from which on a frame is missing: half way to two
    double least_seconds = 1e-4;  // a smaller distance is no time of a camera, whatever the timestamps say
    int late_frames = 8;  // in a row that are older than assumed, after which their times are used again
    // Seconds for which a repeated picture stands for the stream: no gap is counted within. Derived: a source of two
    // frames a second, of which another element has made more; slower ones are too slow to follow people.
    double longest_repeat = .5;
    // Seconds for which damaged pictures stand for the stream. Derived: a camera's keyframes, which mend the picture,
    // are at most 10 s apart, and two of three may be damaged, too.
    double longest_damage = 30;
    int lost_pictures = 5;  // pictures in a row that may be lost within a scene: a fifth of a second of video
    double unknown_distance = .04;  // seconds, where neither caps nor frames have shown one: 25 a second
  };

  FrameHistory() = default;
  explicit FrameHistory(const Parameters& parameters) : parameters_(parameters) {}

  // The next frame starts a scene: caps, segment, flush, DISCONT.
  void drop() { any_ = false; }
  // Records a frame without its picture. The next one follows the last with a picture, unless too many are lost in a
  // row.
  void lose();

  struct Repeated {
    double seconds = 0;  // since the last picture
    std::optional<Time>
        time;  // of this frame: its own, or, where that is an outlier, the one at the usual distance
  };
  // Records a frame that repeats the last picture, or (damaged) one in whose place the last picture counts. Returns
  // nullopt where a scene begins. time, nominal, confirmed: as of next().
  std::optional<Repeated> repeat(std::optional<Time> time, double nominal, bool damaged = false,
                                 bool confirmed = false);

  // Running time of the last frame with a picture of its own, where it had one.
  std::optional<Time> previous() const { return previous_; }

  struct Step {
    bool fresh = true;       // no predecessor: everything learnt from earlier frames is dropped
    bool broken = false;     // there was a predecessor, but the time ended the scene
    bool backwards = false;  // older than the frame before; if only a little, its time counts as unknown
    bool repeatable =
        false;  // the previous frame is recent enough to be repeated by this one, as times in order tell
    double seconds = 0;            // since the previous frame; 0: none, or not known
    std::optional<Time> previous;  // running time of the previous frame, where it has one
    // That of this frame: its own, or, where that is an outlier, the one at the usual distance.
    std::optional<Time> time;
  };

  // Records a frame with a picture of its own. time: its running time, where it has one. nominal: frame distance of the
  // caps in seconds, 0 = variable. marked: the source says that the stream does not go on: its time is no outlier, and says
  // nothing of those before it. confirmed: a clock says that the time is right (clock_confirms()): it is no outlier.
  Step next(std::optional<Time> time, double nominal, bool marked = false, bool confirmed = false);
  // Returns whether frames are missing between the last one, repeated or not, and this: a leaky queue marks the gap by
  // DISCONT, as a cut is marked.
  bool misses_frames(std::optional<Time> time, double nominal) const;

 private:
  void begin_picture(std::optional<Time> time);
  void follow(Step& step, std::optional<Time> time, double rhythm);
  void take_back(std::optional<Time> time);
  bool is_outlier(std::optional<Time> time, double rhythm, bool known_right);
  Step pass_over(Time time, double even);

  Parameters parameters_;
  bool any_ = false;  // a frame of this scene was seen
  int lost_ = 0;      // since the last picture
  int repeats_ = 0;   // likewise
  // Seconds for which the last picture stands for the stream: up to the last damaged frame (at most longest_damage) or
  // plain repetition (at most longest_repeat).
  double held_ = 0;
  bool damage_ = false;           // since the last picture
  std::optional<Time> previous_;  // of the last picture
  std::optional<Time> shown_;     // of the last frame, repeated or not
  std::optional<Time> stamp_;     // of the last frame of this scene that had a time at all
  Time clock_{};                  // the time that was assumed for it
  int late_ = 0;                  // frames in a row that were older than that
  double usual_ = 0;              // smoothed distance between frames, s
  struct Ended {
    Time at{};         // of the last frame of the scene before
    double usual = 0;  // its usual distance
    int frames = 0;    // since then
  };
  std::optional<Ended> ended_;  // by the time of one of the last frames
  bool distrusted_ = false;     // such an end was wrong: every gap may be an outlier
  int outliers_ = 0;     // frames in a row, up to the last, whose times are far from that of the frame before
  bool ordered_ = true;  // all frames of this scene had times, each later than the one before
};

}  // namespace cerberus::vision
