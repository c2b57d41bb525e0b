// SPDX-License-Identifier: LGPL-2.1-or-later
#include "detect_settings.hpp"

namespace cerberus::plugin {

vision::DetectorOptions detector_options(const DetectSettings& s, int analysis_width) {
  const auto seconds = [](GstClockTime time) { return static_cast<double>(time) / GST_SECOND; };
  vision::DetectorOptions options;
  options.analysis_width = analysis_width;
  options.camera.model = static_cast<vision::MotionModel>(s.model);
  options.differences = {s.blur ? 3 : 1, s.compensate_light};
  options.foreground.threshold.weighting = static_cast<vision::Weighting>(s.weighting);
  options.foreground.threshold.extremes = static_cast<vision::Extremes>(s.extremes);
  options.foreground.threshold.order = s.order;
  options.foreground.threshold.clip = s.clip;
  options.foreground.area = static_cast<vision::Area>(s.area);
  options.foreground.noise_floor = s.noise_floor;
  options.foreground.background_model = s.memory;
  options.burnt_in = s.burnt_in;
  options.regions = {s.closing, s.people, s.minimum_area};
  options.size.width = {s.minimum_width, s.maximum_width};
  options.size.height = {s.minimum_height, s.maximum_height};
  options.size.metres_wide = {s.minimum_width_metres, s.maximum_width_metres};
  options.size.metres_high = {s.minimum_height_metres, s.maximum_height_metres};
  options.tracks.confirm_time = seconds(s.confirm_time);
  options.tracks.coast_time = seconds(s.coast_time);
  options.tracks.hold_stopped = seconds(s.hold_stopped);
  options.tracks.away_time = seconds(s.away_time);
  options.tracks.maximum_speed = s.maximum_speed;
  options.speed.pixels = {s.minimum_speed, s.maximum_speed};
  options.speed.metres = {s.minimum_speed_metres, s.maximum_speed_metres};
  options.field_of_view = radians(s.horizontal_fov);
  options.mounting_height = s.mounting_height;
  options.tilt = radians(s.tilt);
  return options;
}

}  // namespace cerberus::plugin
