"""Starts Gazebo with a world of d3dgen, puts a robot of the world's size where it starts, and nav2 on one storey.

    ros2 launch d3dgen_worlds gazebo_nav2.launch.py world:=/path/to/world level:=0
"""

from d3dgen_worlds import robot as robots
from d3dgen_worlds.world import World
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def start(context):
    """Return everything that is started, once the folder is known."""
    said = {name: LaunchConfiguration(name).perform(context) for name in ('world', 'level', 'robot', 'headless', 'stamped_cmd_vel')}
    world = World.load(said['world'])
    robot = world.robot(said['robot'])
    gazebo = world.part('gazebo/launch/world.launch.py', 'gazebo')
    nav2 = world.part('nav2/nav2.launch.py', 'nav2')
    x, y, z = (str(value) for value in robots.lidar_offset(robot.radius, robot.height))
    included = [(gazebo, {'headless': said['headless']}), (nav2, {'level': said['level'], 'use_sim_time': 'true'})]
    return [
        *(
            IncludeLaunchDescription(PythonLaunchDescriptionSource(str(file)), launch_arguments=arguments.items())
            for file, arguments in included
        ),
        Node(
            package='ros_gz_sim',
            executable='create',
            output='screen',
            arguments=[
                '-string', robots.sdf(robot.robot_id, robot.radius, robot.height), '-name', robot.robot_id,
                '-x', str(robot.x), '-y', str(robot.y), '-z', str(robot.z + 0.01), '-Y', str(robot.yaw),
            ],
        ),
        Node(
            package='ros_gz_bridge',
            executable='parameter_bridge',
            name='robot_bridge',
            arguments=robots.bridge(said['stamped_cmd_vel'].lower() in ('true', '1')),
            parameters=[{'use_sim_time': True}],
        ),
        Node(
            package='tf2_ros',
            executable='static_transform_publisher',
            arguments=['--x', x, '--y', y, '--z', z, '--frame-id', 'base_link', '--child-frame-id', 'base_scan'],
            parameters=[{'use_sim_time': True}],
        ),
    ]


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription(
        [
            DeclareLaunchArgument('world', description='folder that d3dgen wrote, with --format gazebo,nav2'),
            DeclareLaunchArgument('level', default_value='0', description='storey: the name of a folder in nav2/'),
            DeclareLaunchArgument('robot', default_value='', description='id of the robot in the scenario; the first one without'),
            DeclareLaunchArgument('headless', default_value='false'),
            DeclareLaunchArgument(
                'stamped_cmd_vel', default_value='false', description='true where nav2 sends TwistStamped (enable_stamped_cmd_vel)'
            ),
            OpaqueFunction(function=start),
        ]
    )
