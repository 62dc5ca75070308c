"""A plain robot for Gazebo, as large as the one that a world was made for: two driven wheels, two casters, a lidar."""

WHEEL_WIDTH = 0.03
LIDAR_RANGE = 12.0
LIDAR_RAYS = 360
BODY_KG = 20.0


def sdf(name, radius, height):
    """Return the model; frames and topics are those of nav2 (`base_link`, `odom`, `scan`, `cmd_vel`). Lengths are in m."""
    wheel = min(0.08, radius / 3)
    low = wheel * 0.6
    body = height - low
    track = 2 * 0.75 * radius
    inertia = inertia_of_cylinder(BODY_KG, radius, body)
    casters = ''.join(caster(side, x * radius, wheel * 0.3) for side, x in (('front', 0.8), ('back', -0.8)))
    wheels = ''.join(wheel_link(side, y * track / 2, wheel) for side, y in (('left', 1), ('right', -1)))
    return f"""<?xml version="1.0"?>
<sdf version="1.9">
  <model name="{name}" canonical_link="base_link">
    <link name="base_link">
      <inertial><pose>0 0 {low + body / 3:.4f} 0 0 0</pose><mass>{BODY_KG}</mass>{inertia}</inertial>
      <collision name="body">
        <pose>0 0 {low + body / 2:.4f} 0 0 0</pose>
        <geometry><cylinder><radius>{radius}</radius><length>{body:.4f}</length></cylinder></geometry>
      </collision>
      <visual name="body_visual">
        <pose>0 0 {low + body / 2:.4f} 0 0 0</pose>
        <geometry><cylinder><radius>{radius * 0.98:.4f}</radius><length>{body:.4f}</length></cylinder></geometry>
        <material><diffuse>0.2 0.35 0.6 1</diffuse></material>
      </visual>{casters}
      <sensor name="lidar" type="gpu_lidar">
        <pose>{radius + 0.01:.4f} 0 {min(height, 0.2):.4f} 0 0 0</pose>
        <topic>scan</topic>
        <gz_frame_id>base_scan</gz_frame_id>
        <update_rate>10</update_rate>
        <lidar>
          <scan><horizontal><samples>{LIDAR_RAYS}</samples><min_angle>-2.2</min_angle><max_angle>2.2</max_angle></horizontal></scan>
          <range><min>0.05</min><max>{LIDAR_RANGE}</max></range>
        </lidar>
      </sensor>
    </link>{wheels}
    <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
      <left_joint>wheel_left</left_joint>
      <right_joint>wheel_right</right_joint>
      <wheel_separation>{track:.4f}</wheel_separation>
      <wheel_radius>{wheel:.4f}</wheel_radius>
      <topic>cmd_vel</topic>
      <odom_topic>odom</odom_topic>
      <tf_topic>tf</tf_topic>
      <frame_id>odom</frame_id>
      <child_frame_id>base_link</child_frame_id>
      <odom_publish_frequency>30</odom_publish_frequency>
    </plugin>
  </model>
</sdf>
"""


def inertia_of_cylinder(mass, radius, length):
    """Return the inertia of an upright cylinder around its middle."""
    across = mass * (3 * radius**2 + length**2) / 12
    return f'<inertia><ixx>{across:.5f}</ixx><iyy>{across:.5f}</iyy><izz>{mass * radius**2 / 2:.5f}</izz></inertia>'


def caster(side, x, size):
    """Return a ball without friction under the body."""
    return f"""
      <collision name="caster_{side}">
        <pose>{x:.4f} 0 {size:.4f} 0 0 0</pose>
        <geometry><sphere><radius>{size:.4f}</radius></sphere></geometry>
        <surface><friction><ode><mu>0.0</mu><mu2>0.0</mu2></ode></friction></surface>
      </collision>"""


def wheel_link(side, y, radius):
    """Return a wheel with its joint; its axis lies along y."""
    across = radius**2 / 4 + WHEEL_WIDTH**2 / 12
    shape = f'<geometry><cylinder><radius>{radius:.4f}</radius><length>{WHEEL_WIDTH}</length></cylinder></geometry>'
    return f"""
    <link name="tire_{side}">
      <pose>0 {y:.4f} {radius:.4f} -1.570796 0 0</pose>
      <inertial>
        <mass>1.0</mass>
        <inertia><ixx>{across:.6f}</ixx><iyy>{across:.6f}</iyy><izz>{radius**2 / 2:.6f}</izz></inertia>
      </inertial>
      <collision name="tire">{shape}</collision>
      <visual name="tire_visual">{shape}<material><diffuse>0.1 0.1 0.1 1</diffuse></material></visual>
    </link>
    <joint name="wheel_{side}" type="revolute">
      <parent>base_link</parent>
      <child>tire_{side}</child>
      <axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis>
    </joint>"""


def bridge(stamped):
    """Return the topics that go between Gazebo and ROS 2, as lines of ros_gz_bridge; `stamped` as nav2's controller sends."""
    velocity = 'TwistStamped' if stamped else 'Twist'
    return [
        f'/cmd_vel@geometry_msgs/msg/{velocity}]gz.msgs.Twist',
        '/odom@nav_msgs/msg/Odometry[gz.msgs.Odometry',
        '/tf@tf2_msgs/msg/TFMessage[gz.msgs.Pose_V',
        '/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan',
    ]


def lidar_offset(radius, height):
    """Return where the lidar stands in `base_link`, m."""
    return radius + 0.01, 0.0, min(height, 0.2)
