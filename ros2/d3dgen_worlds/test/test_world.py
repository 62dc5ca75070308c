"""The parts without ROS: what is read of a world's folder, and the robot that is made of it."""

import json
from pathlib import Path
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from d3dgen_worlds import robot as robots  # noqa: E402
from d3dgen_worlds.world import NotAWorld, World  # noqa: E402

START = {'x': 1.5, 'y': 2.0, 'z': 0.0, 'yaw_rad': 3.0}
ROBOT = {'robot_id': 'delivery_robot_1', 'robot': {'radius_m': 0.3, 'height_m': 1.2}, 'start': START}


class Worlds(unittest.TestCase):
    """A folder with as much of a world as is read."""

    def setUp(self):
        """Write it."""
        self.home = tempfile.TemporaryDirectory()
        self.folder = Path(self.home.name)
        (self.folder / 'world.json').write_text(json.dumps({'scenario': {'robots': [ROBOT]}}))

    def tearDown(self):
        """Remove it."""
        self.home.cleanup()

    def test_the_robot_is_where_the_scenario_has_it(self):
        """Its place, heading and size are those of the document."""
        robot = World.load(self.folder).robot()
        self.assertEqual((robot.x, robot.y, robot.yaw, robot.radius), (1.5, 2.0, 3.0, 0.3))

    def test_what_is_missing_is_said_with_the_command_that_writes_it(self):
        """No world, no such format, no such robot."""
        with self.assertRaisesRegex(NotAWorld, 'world.json'):
            World.load(self.folder / 'nowhere')
        with self.assertRaisesRegex(NotAWorld, '--format rmf'):
            World.load(self.folder).part('rmf/*.building.yaml', 'rmf')
        with self.assertRaisesRegex(NotAWorld, 'delivery_robot_1'):
            World.load(self.folder).robot('tug')

    def test_the_robot_stands_on_its_wheels(self):
        """The wheels touch the floor, the casters nearly, the body does not; the joints are those that are driven."""
        model = ElementTree.fromstring(robots.sdf('r', 0.3, 1.2)).find('model')
        for link in model.findall('link')[1:]:
            height = float(link.find('pose').text.split()[2])
            self.assertAlmostEqual(height, float(link.find('collision/geometry/cylinder/radius').text), places=4)
        body = model.find("link[@name='base_link']/collision[@name='body']")
        bottom = float(body.find('pose').text.split()[2]) - float(body.find('geometry/cylinder/length').text) / 2
        self.assertGreater(bottom, 0.03)
        for link in model.findall('link'):
            names = [part.get('name') for part in link if part.get('name')]
            self.assertEqual(len(names), len(set(names)), 'SDF wants different names of all parts of a link')
        joints = {joint.get('name') for joint in model.findall('joint')}
        self.assertEqual(joints, {model.find('plugin/left_joint').text, model.find('plugin/right_joint').text})


if __name__ == '__main__':
    unittest.main()
