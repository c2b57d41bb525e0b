#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A base for cerberusd (docs/manual/base.md): its lines as geometry_msgs/Twist on cmd_vel of ROS 2.

    command = "/bin/sh -c '. /opt/ros/jazzy/setup.sh && exec python3 /opt/robot/ros2_base.py'"
"""
import math
import os
import select

LONGEST = 0.5  # seconds without a line: stops


def read_line(line):
    """(metres a second, radians a second to the left) of a line; ROS turns to the left with a positive rate (REP 103)."""
    words = line.split()
    if len(words) == 3 and words[0] == 'drive':
        speed, yaw = float(words[1]), float(words[2])
        if math.isfinite(speed) and math.isfinite(yaw):
            return speed, math.radians(-yaw)
    return 0.0, 0.0  # stop, and what is not known


def run(publish, descriptor=0):
    """Calls publish(speed, rate) for the newest line, and with zeros after silence and at the end."""
    rest = b''
    try:
        while True:
            if not select.select([descriptor], [], [], LONGEST)[0]:
                publish(0.0, 0.0)
                continue
            more = os.read(descriptor, 4096)
            if not more:
                return
            *lines, rest = (rest + more).split(b'\n')
            if lines:
                publish(*read_line(lines[-1].decode(errors='replace')))
    finally:
        publish(0.0, 0.0)


def main():
    import rclpy
    from geometry_msgs.msg import Twist
    rclpy.init()
    node = rclpy.create_node('cerberus_base')
    publisher = node.create_publisher(Twist, 'cmd_vel', 1)

    def publish(speed, rate):
        twist = Twist()
        twist.linear.x, twist.angular.z = speed, rate
        publisher.publish(twist)

    run(publish)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
