"""The folder of a world, as the launch files use it."""

from dataclasses import dataclass
import json
from pathlib import Path


class NotAWorld(ValueError):
    """A folder lacks what a launch file needs; the message says which command writes it."""


@dataclass(frozen=True)
class Robot:
    """A robot of the scenario: where it starts (m, rad) and how large it is (m)."""

    robot_id: str
    x: float
    y: float
    z: float
    yaw: float
    radius: float
    height: float


@dataclass(frozen=True)
class World:
    """A world that d3dgen wrote."""

    folder: Path
    document: dict

    @classmethod
    def load(cls, folder):
        """Return the world in a folder; raises NotAWorld when there is none."""
        folder = Path(folder).expanduser().resolve()
        file = folder / 'world.json'
        if not file.is_file():
            raise NotAWorld(f'{folder} has no world.json: world:= names the folder that `d3dgen generate --out` wrote')
        return cls(folder, json.loads(file.read_text(encoding='utf-8')))

    def part(self, name, format_name):
        """Return a file or folder of the world; raises NotAWorld with the command that writes it."""
        found = sorted(self.folder.glob(name))
        if not found:
            raise NotAWorld(f'{self.folder} has no {name}: d3dgen export {self.folder} --format {format_name}')
        return found[0]

    def robots(self):
        """Return the robots of the scenario, in its order."""
        return [
            Robot(
                robot_id=robot['robot_id'],
                **{axis: float(robot['start'][axis]) for axis in ('x', 'y', 'z')},
                yaw=float(robot['start']['yaw_rad']),
                radius=float(robot['robot']['radius_m']),
                height=float(robot['robot']['height_m']),
            )
            for robot in self.document['scenario']['robots']
        ]

    def robot(self, robot_id=''):
        """Return a robot by its id, the first one without; raises NotAWorld when there is none."""
        robots = self.robots()
        for robot in robots:
            if robot_id in ('', robot.robot_id):
                return robot
        names = ', '.join(robot.robot_id for robot in robots) or 'none: ask for one, "... with a delivery robot"'
        raise NotAWorld(f'no robot {robot_id} in {self.folder}; there are {names}')
