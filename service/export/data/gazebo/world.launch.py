"""Starts Gazebo with this world and the bridge to ROS 2.

    ros2 launch <this folder>/launch/world.launch.py              # headless:=true without a window

Doors on the ways of robots open by themselves; close one with
    ros2 topic pub --once /door_2/position std_msgs/msg/Float64 '{data: 0.0}'
"""

import os
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, SetEnvironmentVariable
from launch.conditions import IfCondition, UnlessCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

FOLDER = Path(__file__).resolve().parent.parent
MODELS = FOLDER / "models"


def generate_launch_description():
    headless = LaunchConfiguration("headless")
    gz = PythonLaunchDescriptionSource([PathJoinSubstitution([FindPackageShare("ros_gz_sim"), "launch", "gz_sim.launch.py"])])
    paths = lambda name: os.pathsep.join(p for p in (str(MODELS), os.environ.get(name)) if p)
    world = str(FOLDER / "world.sdf")
    return LaunchDescription(
        [
            DeclareLaunchArgument("headless", default_value="false"),
            *(SetEnvironmentVariable(name, paths(name)) for name in ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH")),
            IncludeLaunchDescription(gz, launch_arguments={"gz_args": f"-r {world}"}.items(), condition=UnlessCondition(headless)),
            IncludeLaunchDescription(gz, launch_arguments={"gz_args": f"-r -s {world}"}.items(), condition=IfCondition(headless)),
            Node(package="ros_gz_bridge", executable="parameter_bridge", parameters=[{"config_file": str(FOLDER / "config" / "bridge.yaml"), "use_sim_time": True}]),
        ]
    )
