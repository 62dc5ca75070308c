"""Starts Open-RMF on the building of a world of d3dgen: schedule, map, doors, lifts and tasks.

    ros2 launch d3dgen_worlds open_rmf.launch.py world:=/path/to/world

Robots come from a fleet adapter of yours: start it with the world's `rmf/nav_graphs/`, one graph a fleet.
"""

from d3dgen_worlds.world import World
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

CORE = [
    ('rmf_traffic_ros2', 'rmf_traffic_schedule'),
    ('rmf_traffic_ros2', 'rmf_traffic_blockade'),
    ('rmf_fleet_adapter', 'door_supervisor'),
    ('rmf_fleet_adapter', 'lift_supervisor'),
    ('rmf_task_ros2', 'rmf_task_dispatcher'),
]


def start(context):
    """Return the nodes, once the folder is known."""
    building = World.load(LaunchConfiguration('world').perform(context)).part('rmf/*.building.yaml', 'rmf')
    sim_time = LaunchConfiguration('use_sim_time').perform(context).lower() in ('true', '1')
    parameters = [{'use_sim_time': sim_time}]
    nodes = [Node(package=package, executable=name, output='both', parameters=parameters) for package, name in CORE]
    return [
        *nodes,
        Node(package='rmf_building_map_tools', executable='building_map_server', arguments=[str(building)], parameters=parameters),
    ]


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription(
        [
            DeclareLaunchArgument('world', description='folder that d3dgen wrote, with --format rmf'),
            DeclareLaunchArgument('use_sim_time', default_value='false'),
            OpaqueFunction(function=start),
        ]
    )
