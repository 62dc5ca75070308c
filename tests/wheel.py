"""Builds the Python wheel, installs it into a clean environment and makes worlds with it there.

    .venv/bin/python tests/wheel.py [--profile dev] [--all-features]

The program in the wheel is built in target/ with the profile and features given: as the tests build it by default, so that
nothing is compiled twice. The last line says what passed; exit status 1 when something failed.
"""

import argparse
import json
import shutil
import subprocess
import sys
import venv
from pathlib import Path

WORKSPACE = Path(__file__).resolve().parents[1]
HOME = WORKSPACE / "target" / "wheel"

SESSION = '''
import json, os, tempfile
import numpy
import d3dgen

world = d3dgen.generate("two-bedroom flat in Germany with a balcony", seed=3)
assert world.sound and world.report.rules and world.report.asks, world.report
assert "bedroom" in {r.room_type for r in world.rooms}, world.rooms
assert sum(len(r.objects) for r in world.rooms) == len(world.objects) > 20
assert abs(world.area_m2 - sum(r.area_m2 for r in world.rooms)) < 1e-6
assert world._repr_svg_().startswith("<svg") and all(d.clear_width_m > 0.5 for d in world.doors)

# every footprint lies where the world says, and standing things lie in their room's box
for room in world.rooms:
    xs, ys = zip(*room.polygon)
    for thing in (t for t in room.objects if t.z == 0.0):
        assert all(min(xs) - 0.3 <= x <= max(xs) + 0.3 and min(ys) - 0.3 <= y <= max(ys) + 0.3 for x, y in thing.footprint), thing

grid, cell, origin = world.occupancy()
assert set(numpy.unique(grid)) <= {-1, 0, 100} and (grid == 0).any() and (grid == 100).any() and cell == 0.05
shapes = world.polygons()
assert shapes.keys() == {r.id for r in world.rooms} and all(p.shape[1] == 2 for p in shapes.values())

again = d3dgen.generate("two-bedroom flat in Germany with a balcony", seed=3)
assert again.document == world.document
bedroom = next(r for r in world.rooms if r.room_type == "bedroom")
locked = world.edit("lock " + bedroom.id)
assert locked.sound and locked.document != world.document
with tempfile.TemporaryDirectory() as home:
    saved = world.save(os.path.join(home, "flat"))
    assert d3dgen.load(saved.folder).document == world.document
    assert d3dgen.check(saved.folder).sound
    assert (saved.export("nav2") / "nav2").is_dir()
assert d3dgen.brief("office for 12 people")["asks"]
for wrong in [lambda: d3dgen.generate("flat", country="Atlantis"), lambda: world.edit("burn down"), lambda: world.export("word")]:
    try:
        wrong()
    except d3dgen.Refused as refused:
        assert len(str(refused)) > 10 and refused.code and "code:" not in str(refused), (refused, refused.code)
    else:
        raise AssertionError("a wrong request was taken")
print("worlds:", world)
'''

# after the program of docs/gymnasium.md, which steps the environment 1,000 times
DROVE = """
assert env.observation_space.contains(observation) and env.unwrapped.world.sound, observation
print("1,000 steps of", env.spec.id)
"""


def gymnasium_program():
    """Returns the program of the page, as it stands there."""
    page = (WORKSPACE / "docs" / "gymnasium.md").read_text()
    return page.split("```python\n")[1].split("```")[0] + DROVE


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"failed: {Path(str(command[0])).name} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--profile", default="dev")
    parser.add_argument("--all-features", action=argparse.BooleanOptionalAction, default=True)
    asked = parser.parse_args()
    shutil.rmtree(HOME, ignore_errors=True)
    maturin = Path(sys.executable).with_name("maturin")
    features = ["--all-features"] if asked.all_features else []
    run(maturin, "build", "--profile", asked.profile, *features, "--out", HOME, cwd=WORKSPACE / "python")
    wheel = next(HOME.glob("*.whl"))
    venv.create(HOME / "venv", with_pip=True)
    python = HOME / "venv" / "bin" / "python"
    run(python, "-m", "pip", "install", "-q", "--disable-pip-version-check", f"{wheel}[numpy]")
    # a folder of its own: neither the sources nor a program of the checkout are found
    user = {"PATH": "/usr/bin:/bin", "HOME": str(HOME), "D3DGEN_STORE": ""}
    said = run(python, "-c", SESSION, cwd=HOME, env=user)
    command = HOME / "venv" / "bin" / "d3dgen"
    bare = {"PATH": str(HOME / "nothing"), "HOME": str(HOME), "D3DGEN_STORE": ""}
    parts = {p["part"]: p["state"] for p in json.loads(run(command, "doctor", "--json", env=bare))["parts"]}
    helpers = [parts[name] for name in ("python3", "node", "chromium")]
    if parts["kinds of building"] != "ready" or helpers != ["not here"] * 3:
        sys.exit(f"failed: doctor says {parts}")
    run(command, "self-test", "--format", "plan", env=bare)
    print(said.strip())
    run(python, "-m", "pip", "install", "-q", "--disable-pip-version-check", f"{wheel}[gym]")
    print(run(python, "-c", gymnasium_program(), cwd=HOME, env=user).strip().splitlines()[-1])
    print(f"the wheel works in a clean environment, {wheel.stat().st_size / 1e6:.0f} MB")


if __name__ == "__main__":
    main()
