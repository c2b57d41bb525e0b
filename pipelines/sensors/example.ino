// SPDX-License-Identifier: LGPL-2.1-or-later
// Three PIR sensors at an Arduino, for pirsrc driver=external device=serial:/dev/ttyUSB0
// (docs/manual/sensor-protocol.md). Not yet tried on hardware.
const int kPins[] = {2, 3, 4};  // infer1 ahead, infer2 left, infer3 right
const int kSensors = sizeof kPins / sizeof *kPins;
const unsigned long kHeartbeat = 1000;  // ms after which the levels are repeated

int levels[kSensors];
unsigned long said = 0;

void say() {
  Serial.print("levels");
  for (int i = 0; i < kSensors; ++i) {
    Serial.print(levels[i] ? " 1" : " 0");
  }
  Serial.println();
  said = millis();
}

bool look() {
  bool changed = false;
  for (int i = 0; i < kSensors; ++i) {
    const int level = digitalRead(kPins[i]);
    changed = changed || level != levels[i];
    levels[i] = level;
  }
  return changed;
}

void setup() {
  Serial.begin(115200);
  for (int i = 0; i < kSensors; ++i) pinMode(kPins[i], INPUT);
  Serial.println();
  Serial.println("cerberus-pir 1 3");
  look();
  say();
}

void loop() {
  if (look() || millis() - said >= kHeartbeat) say();
}
