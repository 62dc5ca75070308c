//! What ROS 2 needs beside the world: a launch file, and which topics its bridge carries.

use std::fmt::Write;

use super::doors;
use crate::file::File;
use crate::scene::SimScene;

/// Returns `launch/world.launch.py` and `config/bridge.yaml`.
pub(super) fn files(scene: &SimScene) -> Vec<File> {
    let mut bridge = "# Read by ros_gz_bridge (parameter_bridge); see launch/world.launch.py.\n".to_owned();
    let mut carry = |ros: &str, gz: &str, ros_type: &str, gz_type: &str, direction: &str| {
        let _ = write!(
            bridge,
            "- ros_topic_name: {ros}\n  gz_topic_name: {gz}\n  ros_type_name: {ros_type}\n  gz_type_name: {gz_type}\n  \
             direction: {direction}\n"
        );
    };
    carry("/clock", "/clock", "rosgraph_msgs/msg/Clock", "gz.msgs.Clock", "GZ_TO_ROS");
    for door in scene.doors.iter().filter(|d| d.on_route) {
        for topic in door.leaves.iter().map(|leaf| doors::topic(door, leaf)) {
            carry(&topic, &topic, "std_msgs/msg/Float64", "gz.msgs.Double", "ROS_TO_GZ");
        }
    }
    vec![
        File::new("gazebo/launch/world.launch.py", include_str!("../../../data/gazebo/world.launch.py")),
        File::new("gazebo/config/bridge.yaml", bridge),
    ]
}
