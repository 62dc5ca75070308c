"""Starts nav2 on one storey of this world: map, masks, docks, route graph and parameters of its folder.

    ros2 launch nav2.launch.py level:=0 use_sim_time:=true
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

HERE = Path(__file__).resolve().parent


def servers(context):
    folder = HERE / LaunchConfiguration("level").perform(context)
    sim_time = LaunchConfiguration("use_sim_time").perform(context).lower() in ("true", "1")
    if not (folder / "map.yaml").is_file():
        raise RuntimeError(f"{folder} has no map.yaml; level:= names a folder beside this file")
    nodes, started = [], []

    def start(package, executable, name, **files):
        own = {key: str(folder / file) for key, file in files.items()}
        if not all(Path(path).is_file() for path in own.values()):
            return  # this storey has no docks, or no lanes
        parameters = [str(folder / "params.yaml"), {"use_sim_time": sim_time, **own}]
        nodes.append(Node(package=package, executable=executable, name=name, output="screen", parameters=parameters))
        started.append(name)

    start("nav2_map_server", "map_server", "map_server", yaml_filename="map.yaml")
    for kind in ("keepout", "speed"):
        start("nav2_map_server", "map_server", f"{kind}_filter_mask_server", yaml_filename=f"{kind}_mask.yaml")
        start("nav2_map_server", "costmap_filter_info_server", f"{kind}_costmap_filter_info_server")
    start("nav2_amcl", "amcl", "amcl")
    start("nav2_planner", "planner_server", "planner_server")
    start("nav2_controller", "controller_server", "controller_server")
    start("nav2_behaviors", "behavior_server", "behavior_server")
    start("nav2_bt_navigator", "bt_navigator", "bt_navigator")
    start("nav2_route", "route_server", "route_server", graph_filepath="route_graph.geojson")
    start("opennav_docking", "opennav_docking", "docking_server", dock_database="docks.yaml")
    manager = {"use_sim_time": sim_time, "autostart": True, "node_names": started}
    nodes.append(
        Node(
            package="nav2_lifecycle_manager",
            executable="lifecycle_manager",
            name="lifecycle_manager_navigation",
            output="screen",
            parameters=[manager],
        )
    )
    return nodes


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("level", default_value="0", description="storey: the name of a folder beside this file"),
            DeclareLaunchArgument("use_sim_time", default_value="true"),
            OpaqueFunction(function=servers),
        ]
    )
