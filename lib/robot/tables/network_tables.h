// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads the tables of the configuration file by which the robot is reached, and reaches others: [page], [rtsp], [mqtt],
// [webhook], [base].
#pragma once

#include <vector>

#include "robot/tables/camera_settings.h"
#include "robot/tables/table_reader.h"

namespace cerberus::robot {

PageSettings read_page(const text::TomlValue& table, Folders folders, Mistakes& mistakes,
                       std::vector<NamedFile>& files);
RtspSettings read_rtsp(const text::TomlValue& table, Folders folders, Mistakes& mistakes,
                       std::vector<NamedFile>& files);
// The properties of mqttpublish.
Properties read_mqtt(const text::TomlValue& table, Folders folders, bool& list_cameras, Mistakes& mistakes,
                     std::vector<NamedFile>& files);
WebhookSettings read_webhook(const text::TomlValue& table, Folders folders, Mistakes& mistakes,
                             std::vector<NamedFile>& files);
BaseSettings read_base(const text::TomlValue& table, Mistakes& mistakes);

}  // namespace cerberus::robot
