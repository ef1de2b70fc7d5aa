"""A row for each pose of a ROS 2 odometry, with the rudder of the moment, for `seatrial follow --source stdin`.

Columns: time [s], heading [rad], surge and sway velocity [m/s], yaw rate [rad/s], rudder [rad]; axes of ROS (x east, y
north, body forward and to port) become those of seatrial. It runs where ROS 2 is installed, without seatrial.
"""

import math

import rclpy  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from std_msgs.msg import Float64  # type: ignore[import-not-found]

latest = {"rudder": 0.0}


def steer(message: Float64) -> None:
    """Keep the rudder of the moment."""
    latest["rudder"] = message.data


def row(message: Odometry) -> None:
    """Print one row."""
    q, twist = message.pose.pose.orientation, message.twist.twist
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y**2 + q.z**2))
    stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
    cells = (math.pi / 2 - yaw, twist.linear.x, -twist.linear.y, -twist.angular.z, latest["rudder"])
    print(f"{stamp:.3f}", *(f"{cell:.9g}" for cell in cells), sep=",", flush=True)


rclpy.init()
node = rclpy.create_node("odom_rows")
node.create_subscription(Odometry, "/nav/odom", row, 50)
node.create_subscription(Float64, "/rudder", steer, 50)
rclpy.spin(node)
