#!/usr/bin/env python3
"""A Gymnasium environment of this world: a wheeled robot drives along the routes of paths.json.

    pip install mujoco gymnasium
    python scene.py                 # drives at random for 10 s and says what happened
    python scene.py --view          # shows it

    env = D3dgenEnv(folder)         # action: speed ahead (m/s) and turn (rad/s), each -1 to 1 of the largest
                                    # observation: distances of 36 rays (m), way to the goal in the robot's frame (m), speeds

The robot is a disc with two driven wheels and two casters. The doors on its route stand open unless doors="closed".
"""

import argparse
import json
import math
from pathlib import Path

import gymnasium
import mujoco
import numpy as np

MOST_SPEED = 0.8  # m/s
MOST_TURN = 1.5  # rad/s
RAYS = 36
RANGE = 8.0  # m
CONTROL_S = 0.1
ARRIVED = 0.3  # m
WHEEL = 0.08  # m, radius


def add_robot(spec, radius, height, at, yaw):
    """Adds a robot with two driven wheels, a body of this radius and height, at a place on the floor."""
    wheel = min(WHEEL, radius / 3)
    body = spec.worldbody.add_body(name="robot", pos=[at[0], at[1], at[2] + 0.002], quat=[math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)])
    body.add_freejoint(name="robot_free")
    low = wheel * 0.6
    body.add_geom(
        name="robot_base", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[radius, (height - low) / 4, 0], pos=[0, 0, low + (height - low) / 4], mass=20.0, rgba=[0.2, 0.35, 0.6, 1]
    )
    body.add_geom(
        name="robot_mast", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[radius * 0.5, (height - low) / 4, 0], pos=[0, 0, low + (height - low) * 0.75], mass=2.0, rgba=[0.9, 0.9, 0.9, 1]
    )
    for name, x in (("front", 0.8), ("back", -0.8)):
        size = wheel * 0.3
        body.add_geom(name=f"robot_caster_{name}", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[size, 0, 0], pos=[x * radius, 0, size], mass=0.2, friction=[0.01, 0.001, 0.0001], priority=1, condim=1)
    for name, y in (("left", 0.75), ("right", -0.75)):
        hub = body.add_body(name=f"robot_wheel_{name}", pos=[0, y * radius, wheel])
        hub.add_joint(name=f"robot_{name}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 1, 0], damping=0.01)
        hub.add_geom(name=f"robot_tire_{name}", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[wheel, 0.015, 0], quat=[math.sqrt(0.5), math.sqrt(0.5), 0, 0], mass=0.5, friction=[1.0, 0.01, 0.001], rgba=[0.1, 0.1, 0.1, 1])
        motor = spec.add_actuator(name=f"robot_{name}", target=f"robot_{name}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_velocity(kv=5.0)
    body.add_site(name="robot_eye", pos=[0, 0, min(height, 0.3)])
    return wheel, 2 * 0.75 * radius


class D3dgenEnv(gymnasium.Env):
    """The robot drives from the start of a route to its end; it fails when it hits something."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(self, folder=Path(__file__).parent, doors="open", render_mode=None, seconds=60.0):
        folder = Path(folder)
        plan = json.loads((folder / "paths.json").read_text())
        spec = mujoco.MjSpec.from_file(str(folder / "world.xml"))
        self.keys = {key.name: np.array(key.qpos) for key in spec.keys}
        for key in list(spec.keys):
            spec.delete(key)  # they do not know the robot
        self.routes = [np.array([(list(p) + [0.0])[:3] for p in path["waypoints"]]) for path in plan["paths"]]
        self.radius = plan["radius"]
        start = self.routes[0][0]
        self.wheel, self.track = add_robot(spec, self.radius, plan["height"], start, 0.0)
        spec.option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)  # what rests costs nothing until it is touched
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.doors, self.render_mode, self.seconds = doors, render_mode, seconds
        self.free = self.model.jnt_qposadr[self.model.joint("robot_free").id]
        self.body = self.model.body("robot").id
        names = [self.model.geom(g).name or "" for g in range(self.model.ngeom)]
        self.is_own = np.array([self.model.body(b).name.startswith("robot") for b in self.model.geom_bodyid])
        self.is_floor = np.array(["_floor_" in name or name == "ground" for name in names])
        self.renderer = None
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)
        low = np.array([0.0] * RAYS + [-np.inf] * 4, dtype=np.float32)
        high = np.array([RANGE] * RAYS + [np.inf] * 4, dtype=np.float32)
        self.observation_space = gymnasium.spaces.Box(low, high)

    def reset(self, seed=None, options=None):
        super().reset(seed=seed)
        mujoco.mj_resetData(self.model, self.data)
        known = self.keys.get(f"doors_{self.doors}")
        if known is not None:
            self.data.qpos[: len(known)] = known
        route = (options or {}).get("route")
        self.route = self.routes[int(self.np_random.integers(len(self.routes))) if route is None else route]
        ahead = self.route[1] - self.route[0]
        yaw = math.atan2(ahead[1], ahead[0])
        self.data.qpos[self.free : self.free + 7] = [self.route[0][0], self.route[0][1], self.route[0][2] + 0.002, math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)]
        mujoco.mj_forward(self.model, self.data)
        self.last = self.left()
        return self.observation(), {}

    def pose(self):
        w, x, y, z = self.data.xquat[self.body]
        return self.data.xpos[self.body], math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    def left(self):
        return float(np.linalg.norm(self.route[-1][:2] - self.data.xpos[self.body][:2]))

    def observation(self):
        at, yaw = self.pose()
        eye = self.data.site("robot_eye").xpos.copy()
        hit = np.zeros(1, dtype=np.int32)
        groups = np.array([1, 0, 0, 1, 0, 0], dtype=np.uint8)  # what collides: the building and the boxes of things
        rays = []
        for k in range(RAYS):
            angle = yaw + 2 * math.pi * k / RAYS
            ahead = np.array([math.cos(angle), math.sin(angle), 0.0])
            # from the rim of the robot, whose own wheels are not looked at
            found = mujoco.mj_ray(self.model, self.data, eye + ahead * self.radius * 1.02, ahead, groups, 1, self.body, hit)
            rays.append(RANGE if found < 0 else min(found, RANGE))
        to = self.route[-1][:2] - at[:2]
        goal = [math.cos(yaw) * to[0] + math.sin(yaw) * to[1], -math.sin(yaw) * to[0] + math.cos(yaw) * to[1]]
        velocity = self.data.cvel[self.body]
        return np.array([*rays, *goal, float(np.linalg.norm(velocity[3:5])), float(velocity[2])], dtype=np.float32)

    def hits(self):
        pairs = self.data.contact.geom
        own = self.is_own[pairs]
        others = own.any(axis=1) & ~own.all(axis=1) & ~self.is_floor[pairs].any(axis=1)
        return bool((others & (self.data.contact.dist < 0)).any())

    def step(self, action):
        ahead, turn = np.clip(action, -1, 1) * [MOST_SPEED, MOST_TURN]
        sides = {"left": ahead - turn * self.track / 2, "right": ahead + turn * self.track / 2}
        for side, speed in sides.items():
            self.data.actuator(f"robot_{side}").ctrl = speed / self.wheel
        hit = False
        for _ in range(round(CONTROL_S / self.model.opt.timestep)):
            mujoco.mj_step(self.model, self.data)
            hit = hit or self.hits()
        left = self.left()
        reward, self.last = self.last - left - (1.0 if hit else 0.0), left
        arrived = left < ARRIVED
        return self.observation(), reward + (10.0 if arrived else 0.0), arrived or hit, self.data.time > self.seconds, {"hit": hit, "left_m": left}

    def render(self):
        if self.renderer is None:
            self.renderer = mujoco.Renderer(self.model, 480, 640)
        self.renderer.update_scene(self.data)
        return self.renderer.render()


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--view", action="store_true")
    arguments.add_argument("--seconds", type=float, default=10.0)
    arguments.add_argument("--doors", choices=["open", "closed"], default="open")
    given = arguments.parse_args()
    env = D3dgenEnv(doors=given.doors)
    env.reset(seed=0)
    viewer = None
    if given.view:
        import mujoco.viewer

        viewer = mujoco.viewer.launch_passive(env.model, env.data)
    total, hits = 0.0, 0
    while env.data.time < given.seconds:
        _, reward, ended, late, told = env.step(env.action_space.sample())
        total, hits = total + reward, hits + told["hit"]
        if viewer is not None:
            viewer.sync()
        if ended or late:
            env.reset()
            if viewer is None:
                break
    print(json.dumps({"seconds": round(float(env.data.time), 3), "reward": round(total, 4), "hits": hits, "bodies": int(env.model.nbody), "left_m": round(env.left(), 3)}))


if __name__ == "__main__":
    main()
