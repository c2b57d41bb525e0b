// SPDX-License-Identifier: LGPL-2.1-or-later
// The sectors of PIR sensors: arcs of the full circle.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace cerberus::sensing {

constexpr int kMaxSensors = 16;
// One bit a sensor: bit 0 = infer1.
using SensorBits = std::uint16_t;

// An arc of the circle, radians, both ends belong to it: from `from` clockwise (to the right) to `from` + `width`.
struct Arc {
  double from = 0;   // [-pi, pi)
  double width = 0;  // 0 .. 2 pi; 0 = one direction, 2 pi = the whole circle
};

// A closed interval of pan angles, radians, from <= to. Pan angles lie on a line: they do not wrap.
struct Interval {
  double from = 0;
  double to = 0;
  bool operator==(const Interval&) const = default;
  double width() const { return to - from; }
  double middle() const { return (from + to) / 2; }
  bool holds(double x) const { return x >= from && x <= to; }
  // Returns 0 inside, else the positive distance of x.
  double distance(double x) const { return x < from ? from - x : x > to ? x - to : 0; }
};

// A list without allocation. Surplus items are dropped; the sizes below are large enough that there are none.
template <typename T, int N>
struct FixedList {
  std::array<T, N> items{};
  int count = 0;
  void push(const T& item) {
    if (count < N) items[static_cast<unsigned>(count++)] = item;
  }
  T& operator[](int i) { return items[static_cast<unsigned>(i)]; }
  const T& operator[](int i) const { return items[static_cast<unsigned>(i)]; }
  T* begin() { return items.data(); }
  T* end() { return items.data() + count; }
  const T* begin() const { return items.data(); }
  const T* end() const { return items.data() + count; }
};

// The directions and fields of view of the sensors, as published in pirsrc's caps, so that nothing is configured twice.
class Geometry {
 public:
  // The paper's: ahead, left, right, 120 degrees each (II.A): 0, -120, +120 degrees.
  Geometry();
  // bearings: radians, 1 .. 16 of them, finite (wrapped here). field_of_view: radians, in (0, 2 pi].
  // Returns false and changes nothing for other values.
  bool set(std::span<const double> bearings, double field_of_view);
  // The same for sensors of different make: as many fields of view as bearings.
  bool set(std::span<const double> bearings, std::span<const double> fields_of_view);

  int count() const { return count_; }
  double bearing(int sensor) const { return bearings_[static_cast<unsigned>(sensor)]; }
  double field_of_view(int sensor) const { return fields_of_view_[static_cast<unsigned>(sensor)]; }
  Arc sector(int sensor) const;
  bool operator==(const Geometry&) const = default;

 private:
  std::array<double, kMaxSensors> bearings_{};
  int count_ = 0;
  std::array<double, kMaxSensors> fields_of_view_{};
};

// Arcs may meet in several places (two of 180 degrees, back to back, meet in two points).
constexpr int kMaxOverlaps = kMaxSensors + 1;
using Arcs = FixedList<Arc, kMaxOverlaps>;

// Returns the arcs that all sensors of `fired` cover together; empty if there is none. Sectors that only touch (nearer
// than 1e-6 rad) meet in an arc of width 0: a person on the border triggers both.
Arcs overlap(const Geometry& geometry, SensorBits fired);

}  // namespace cerberus::sensing
