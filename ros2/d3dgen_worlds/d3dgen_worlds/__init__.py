"""What the launch files need of a world of d3dgen: no ROS in here."""
