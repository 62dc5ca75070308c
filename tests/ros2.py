"""Judges ros2/d3dgen_worlds without ROS: its own tests, its manifest, ament's linter where it can be installed, and what its launch files
would start on a world that is made for it.

    .venv/bin/python tests/ros2.py [--program target/debug/d3dgen]

`launch` and `launch_ros` stand in: they keep what they are told. The robot is given to sdformat where Gazebo's command is.
"""
import argparse
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import types
import xml.etree.ElementTree as ElementTree

WORKSPACE = pathlib.Path(__file__).resolve().parents[1]
PACKAGE = WORKSPACE / "ros2" / "d3dgen_worlds"
LINTER = "ament-lint-flake8==0.14.4"
PROMPT = "studio flat in Germany with a cleaning robot"
LINE = "140"


class Told:
    """An action, substitution or node that keeps what it was made with."""

    def __init__(self, *args, **kwargs):
        self.args, self.kwargs = args, kwargs

    def perform(self, context):
        return context[self.args[0]]


def stand_in():
    """Puts modules in the place of ROS."""
    names = {
        "launch": ["LaunchDescription"],
        "launch.actions": ["DeclareLaunchArgument", "IncludeLaunchDescription", "OpaqueFunction"],
        "launch.launch_description_sources": ["PythonLaunchDescriptionSource"],
        "launch.substitutions": ["LaunchConfiguration"],
        "launch_ros": [],
        "launch_ros.actions": ["Node"],
    }
    for module, classes in names.items():
        sys.modules[module] = types.ModuleType(module)
        for name in classes:
            setattr(sys.modules[module], name, type(name, (Told,), {}))


def started(name, world, **said):
    """Returns what a launch file starts on a world."""
    spec = importlib.util.spec_from_file_location(name, PACKAGE / "launch" / f"{name}.launch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    *arguments, function = module.generate_launch_description().args[0]
    declared = {a.args[0]: a.kwargs.get("default_value") for a in arguments}
    unknown = said.keys() - declared.keys()
    assert not unknown and declared["world"] is None, (name, unknown)
    return function.kwargs["function"]({**declared, "world": str(world), **said})


def executables(actions):
    return [a.kwargs["executable"] for a in actions if "executable" in a.kwargs]


def judge_launches(world):
    """Compares what is started with the files of the world."""
    actions = started("gazebo_nav2", world)
    included = [pathlib.Path(a.args[0].args[0]) for a in actions if type(a).__name__ == "IncludeLaunchDescription"]
    assert [p.parent.name for p in included] == ["launch", "nav2"] and all(p.is_file() for p in included), included
    assert executables(actions) == ["create", "parameter_bridge", "static_transform_publisher"], executables(actions)
    words = next(a for a in actions if a.kwargs.get("executable") == "create").kwargs["arguments"]
    said = dict(zip(words[::2], words[1::2]))
    params = (world / "nav2" / "0" / "params.yaml").read_text()
    assert f"x: {float(said['-x']):g}" in params and f"y: {float(said['-y']):g}" in params, "the robot is not where nav2 takes it to be"
    actions = started("open_rmf", world)
    building = next(a for a in actions if a.kwargs.get("executable") == "building_map_server").kwargs["arguments"]
    assert pathlib.Path(building[0]).is_file() and "rmf_traffic_schedule" in executables(actions)
    return said["-string"]


def depends():
    """Returns the packages that the manifest names, after a look at the rest of it."""
    manifest = ElementTree.parse(PACKAGE / "package.xml").getroot()
    assert manifest.get("format") == "3" and manifest.find("name").text == PACKAGE.name
    assert (PACKAGE / "resource" / PACKAGE.name).is_file()
    return {d.text for d in manifest.findall("exec_depend")}


def judge_depends(world):
    """Every package that a launch file, ours or the world's, starts something of is in the manifest."""
    known = depends()
    nodes = started("gazebo_nav2", world) + started("open_rmf", world)
    used = {n.kwargs["package"] for n in nodes if "package" in n.kwargs}
    text = (world / "nav2" / "nav2.launch.py").read_text()
    used |= {line.split('"')[1] for line in text.splitlines() if line.strip().startswith('start("')}
    assert used <= known, f"not in package.xml: {used - known}"


def lint():
    """Returns what ament's linter is told to have said, or that it is not here."""
    install = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check", LINTER]
    if subprocess.run(install, check=False).returncode != 0:
        return "ament's linter cannot be fetched"
    command = [pathlib.Path(sys.executable).with_name("ament_flake8"), "--linelength", LINE, PACKAGE]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stdout)
    return "clean for ament_flake8"


def sdformat(model, home):
    """Returns what sdformat is told to say of the robot, where its command is."""
    command = shutil.which("gz") or shutil.which("ign")
    if not command:
        return "no sdformat here"
    file = pathlib.Path(home, "robot.sdf")
    file.write_text(model)
    done = subprocess.run([command, "sdf", "-k", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0 or "Valid" not in done.stdout:
        sys.exit(f"sdformat refuses the robot:\n{done.stdout[-1500:]}")
    return "the robot is valid SDF"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, default=WORKSPACE / "target" / "debug" / "d3dgen")
    given = parser.parse_args()
    sys.dont_write_bytecode = True
    env = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    subprocess.run([sys.executable, "-m", "unittest", "discover", "-q", "test"], cwd=PACKAGE, env=env, check=True)
    sys.path.insert(0, str(PACKAGE))
    stand_in()
    with tempfile.TemporaryDirectory() as home:
        world = pathlib.Path(home, "world")
        command = [given.program, "generate", PROMPT, "--seed", "1", "--no-png", "--format", "gazebo,nav2,rmf", "--out", world]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL, env={**env, "D3DGEN_STORE": ""})
        model = judge_launches(world)
        judge_depends(world)
        print(f"the launch files start what is in a world; {lint()}, {sdformat(model, home)}; not started with ROS 2, there is none here")


if __name__ == "__main__":
    main()
