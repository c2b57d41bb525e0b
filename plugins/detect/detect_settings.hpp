// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of detection: motiondetect has all of them, each stage element those of its stage.
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "shared/camera_mount.hpp"
#include "shared/enums.hpp"
#include "shared/properties.hpp"
#include "shared/stamps.hpp"
#include "vision/detector.h"

namespace cerberus::plugin {

struct DetectSettings {
  int model = static_cast<int>(vision::CameraMotionOptions{}.model);
  std::string head = "head";
  bool blur = vision::DifferenceOptions{}.blur > 1;
  bool compensate_light = vision::DifferenceOptions{}.compensate_light;
  int weighting = static_cast<int>(vision::FuzzyThresholdOptions{}.weighting);
  int extremes = static_cast<int>(vision::FuzzyThresholdOptions{}.extremes);
  int order = vision::FuzzyThresholdOptions{}.order;
  bool clip = vision::FuzzyThresholdOptions{}.clip;
  int area = static_cast<int>(vision::ForegroundMaskOptions{}.area);
  bool noise_floor = vision::ForegroundMaskOptions{}.noise_floor;
  bool memory = vision::ForegroundMaskOptions{}.background_model;
  bool burnt_in = true;
  int closing = vision::RegionOptions{}.closing;
  bool people = vision::RegionOptions{}.people;
  double minimum_area = vision::RegionOptions{}.minimum_area;
  std::string zones;
  double minimum_width = 0, maximum_width = 0, minimum_height = 0, maximum_height = 0;
  double minimum_width_metres = vision::human_size().metres_wide.least;
  double maximum_width_metres = vision::human_size().metres_wide.most;
  double minimum_height_metres = vision::human_size().metres_high.least;
  double maximum_height_metres = vision::human_size().metres_high.most;
  int keep_planes = KEEP_PLANES_AUTO;
  guint64 confirm_time = clock_time(vision::TrackOptions{}.confirm_time);
  guint64 coast_time = clock_time(vision::TrackOptions{}.coast_time);
  guint64 hold_stopped = clock_time(vision::TrackOptions{}.hold_stopped);
  guint64 away_time = clock_time(vision::TrackOptions{}.away_time);
  guint64 hold_time = 2 * GST_SECOND;
  double minimum_speed = 0, maximum_speed = 0;
  double minimum_speed_metres = vision::human_speed().metres.least;
  double maximum_speed_metres = vision::human_speed().metres.most;
  double horizontal_fov = 0;
  double mounting_height = kDefaultMountingHeight;
  double tilt = 0;
  std::string camera_name;
  int preset = PRESET_DEFAULT;
};

inline constexpr double kMaximumPixels = 8192, kMaximumMetres = 100;

// Two or more tables of properties as one.
template <std::size_t... kCounts>
constexpr auto joined(const std::array<Property<DetectSettings>, kCounts>&... tables) {
  std::array<Property<DetectSettings>, (kCounts + ...)> all{};
  auto at = all.begin();
  ((at = std::copy(tables.begin(), tables.end(), at)), ...);
  return all;
}

// Of one stage alone.
inline constexpr std::array kOwnOfCamera{
    property("model", &DetectSettings::model, motion_model_type,
             "How the camera may have moved between two frames: a richer model follows more kinds of motion "
             "and needs a picture with more structure; none = it stands still"),
    property("head", &DetectSettings::head, "Name of the head whose pose counts; empty = any"),
};
inline constexpr std::array kOwnOfDifferences{
    property("blur", &DetectSettings::blur,
             "Average 3 x 3 pixels before the difference is taken: quieter, and blind to single pixels"),
    property(
        "compensate-light", &DetectSettings::compensate_light,
        "Take a change of brightness and contrast of the whole picture out before the difference is taken"),
};
inline constexpr std::array kOwnOfThreshold{
    property("weighting", &DetectSettings::weighting, weighting_type,
             "How the histogram's counts weigh: log lets a small object count beside a large background; "
             "with noise-floor it chooses within the range that the noise leaves"),
    property("extremes", &DetectSettings::extremes, extremes_type,
             "Between which levels the membership function of a fuzzy subset runs; with noise-floor it "
             "chooses within the range that the noise leaves"),
    property(
        "order", &DetectSettings::order, 1, 16,
        "Order k of the index of fuzziness (Eq. 8 and 9): 1 is linear, 2 quadratic, higher ones follow the "
        "largest distances alone; with noise-floor it chooses within the range that the noise leaves"),
    property("clip", &DetectSettings::clip,
             "Let the few brightest levels of the histogram not count (weighting=log only); with noise-floor "
             "it chooses within the range that the noise leaves"),
    property("area", &DetectSettings::area, area_type,
             "Which moving area goes out: all that moves, or what an object newly covers (leading), or what "
             "it covered in the frame before too (common); these two are sets of the differences alone, and "
             "the memory is not used"),
    property(
        "noise-floor", &DetectSettings::noise_floor,
        "Hold the threshold between one and one and a half times the floor that the measured noise sets"),
    property("memory", &DetectSettings::memory,
             "Use a memory of the scene, moved along with the camera, where it knows better than two "
             "neighbouring frames; with area=all only"),
    property(
        "burnt-in", &DetectSettings::burnt_in,
        "Leave out what the camera writes into its own pictures (clock, name, logo), learnt within seconds "
        "from what keeps its place while the scene moves and from what changes in place"),
};
inline constexpr std::array kOwnOfRegions{
    property("closing", &DetectSettings::closing, 0, 63,
             "Side of the closing that fills holes and joins fragments, in pixels of an analysis picture 320 "
             "wide (it grows with the picture): larger joins what is farther apart; 0 or 1 = none"),
    property("people", &DetectSettings::people,
             "Join fragments and part groups by the height of a person, learnt from the scene; off: one "
             "region for each connected part of the mask"),
    property("minimum-area", &DetectSettings::minimum_area, 0, 1e6,
             "Moving pixels of the analysis picture that a region needs: larger drops small objects; 0 = "
             "chosen from the picture's size"),
    property("zones", &DetectSettings::zones,
             "Where motion counts: polygons as `include X,Y X,Y X,Y ...; exclude X,Y ...` in fractions of "
             "the picture from its top left corner, or as `include world PAN,TILT ...` in degrees; empty = "
             "everywhere"),
    property("minimum-width", &DetectSettings::minimum_width, 0, kMaximumPixels,
             "Least width in frame pixels of a region as found; 0 = no limit"),
    property("maximum-width", &DetectSettings::maximum_width, 0, kMaximumPixels,
             "Greatest width in frame pixels of a region as found; 0 = no limit"),
    property("minimum-height", &DetectSettings::minimum_height, 0, kMaximumPixels,
             "Least height in frame pixels of a region as found; 0 = no limit"),
    property("maximum-height", &DetectSettings::maximum_height, 0, kMaximumPixels,
             "Greatest height in frame pixels of a region as found; 0 = no limit"),
    property(
        "minimum-width-metres", &DetectSettings::minimum_width_metres, 0, kMaximumMetres,
        "Least width in metres of a region as found, where horizontal-fov tells its distance; 0 = no limit"),
    property("maximum-width-metres", &DetectSettings::maximum_width_metres, 0, kMaximumMetres,
             "Greatest width in metres of a region as found, where horizontal-fov tells its distance; 0 = no "
             "limit"),
    property(
        "minimum-height-metres", &DetectSettings::minimum_height_metres, 0, kMaximumMetres,
        "Least height in metres of a region as found, where horizontal-fov tells its distance; 0 = no limit"),
    property("maximum-height-metres", &DetectSettings::maximum_height_metres, 0, kMaximumMetres,
             "Greatest height in metres of a region as found, where horizontal-fov tells its distance; 0 = "
             "no limit"),
    property("keep-planes", &DetectSettings::keep_planes, keep_planes_type,
             "Whether the record of the stages stays on the frame after it was read here"),
};
inline constexpr std::array kOwnOfTracks{
    property("confirm-time", &DetectSettings::confirm_time,
             "Nanoseconds for which an object must be seen, and move, before it is published: longer drops "
             "flicker and answers later; 0 = every region is one in the frame in which it is first seen"),
    property("coast-time", &DetectSettings::coast_time,
             "Nanoseconds for which a moving object is carried on without being seen; 0 = it ends at once"),
    property(
        "hold-stopped", &DetectSettings::hold_stopped,
        "Nanoseconds for which an object that stopped moving is held where it stands (with "
        "fuzzythreshold's memory, which tells that it is still there), and for which one that walks out of "
        "the picture of a head that stands keeps its identity; 0 = it ends at once"),
    property("away-time", &DetectSettings::away_time,
             "Nanoseconds for which a moving object that the camera has turned away from keeps its identity; "
             "0 = it ends at once"),
    property(
        "hold-time", &DetectSettings::hold_time,
        "Nanoseconds without any object after which the message that motion ended is posted; 0 = at once"),
    property(
        "minimum-speed", &DetectSettings::minimum_speed, 0, 1e6,
        "Objects that never were as fast as this, in frame pixels a second, are not published; 0 = no limit"),
    property("maximum-speed", &DetectSettings::maximum_speed, 0, 1e6,
             "Objects faster than this, in frame pixels a second, are not published, and no jump wider than "
             "it allows is taken for the same object; 0 = no limit"),
    property("minimum-speed-metres", &DetectSettings::minimum_speed_metres, 0, 1000,
             "Objects that never were as fast as this, in metres a second, are not published where their "
             "distance is known (horizontal-fov); 0 = no limit"),
    property("maximum-speed-metres", &DetectSettings::maximum_speed_metres, 0, 1000,
             "Objects faster than this, in metres a second, are not published where their distance is known "
             "(horizontal-fov); 0 = no limit"),
    property("camera-name", &DetectSettings::camera_name, kCameraNameBlurb),
};
// How the camera stands.
inline constexpr std::array kMount{
    property("horizontal-fov", &DetectSettings::horizontal_fov, 0, kMaximumFieldOfView, kFieldOfViewBlurb),
    property("mounting-height", &DetectSettings::mounting_height, 0, kMaximumMountingHeight,
             kMountingHeightBlurb),
    property("tilt", &DetectSettings::tilt, -kMaximumTilt, kMaximumTilt, kTiltBlurb),
};

// Of an element each.
inline constexpr auto kCameraProperties =
    joined(kOwnOfCamera,
           std::array{property("horizontal-fov", &DetectSettings::horizontal_fov, 0, kMaximumFieldOfView,
                               "Angle in degrees that the lens sees over the frame's whole width: with it a "
                               "head's turn is the first guess; 0 = not known")});
inline constexpr auto kRegionsProperties = joined(kOwnOfRegions, kMount);
inline constexpr auto kTracksProperties = joined(kOwnOfTracks, kMount);
inline constexpr auto kDetectProperties =
    joined(kOwnOfCamera, kOwnOfDifferences, kOwnOfThreshold, kOwnOfRegions, kOwnOfTracks, kMount,
           std::array{property("preset", &DetectSettings::preset, preset_type,
                               "What the properties that are not set one by one are set to: people "
                               "(default), the paper's method (paper) or vehicles (traffic)")});

// The same in lib's words. analysis_width: pixels.
vision::DetectorOptions detector_options(const DetectSettings& settings, int analysis_width);

}  // namespace cerberus::plugin
