"""Gymnasium environments: a wheeled robot in a world of a sentence, stepped by MuJoCo.

    pip install "d3dgen[gym]"

    import d3dgen.gym
    import gymnasium
    env = gymnasium.make("d3dgen/Nav-v0", prompt="ward with 8 rooms in Germany, for a delivery robot", seed=1)
    observation, info = env.reset(seed=0)

Importing this module makes the environment known: Gymnasium looks for those of installed packages by itself before 1.4 only
(entry point `gymnasium.envs`). What is observed, what the actions are and when an
episode ends is said in `mujoco/scene.py` of the world, which is the environment; a copy of it can be changed at will.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._world import World, generate, load

if TYPE_CHECKING:
    import gymnasium

NAVIGATION = "d3dgen/Nav-v0"
"""A robot drives along routes of the world, through its doors."""


def register() -> None:
    """Makes the environments known to Gymnasium, once."""
    try:
        from gymnasium.envs import registration
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError('Gymnasium is not installed: pip install "d3dgen[gym]"') from missing

    if NAVIGATION not in registration.registry:
        registration.register(NAVIGATION, entry_point="d3dgen.gym:navigation")


def navigation(prompt: str | None = None, *, seed: int = 0, folder: str | Path | None = None, **settings: Any) -> gymnasium.Env:
    """Returns the environment of a world: one of a sentence and a seed, or one in a folder.

    `settings` go to the environment (`doors`, `seconds`, `render_mode`). Raises ValueError without a sentence and a folder,
    Refused for a sentence that cannot be met.
    """
    if prompt is None and folder is None:
        raise ValueError("say what to build with prompt=..., or name a world's folder with folder=...")
    world = load(folder) if folder is not None else generate(str(prompt), seed=seed, formats=("mujoco",))
    env = _scene(world).D3dgenEnv(**settings)
    env.unwrapped.world = world  # a temporary folder lives as long as the environment
    return env


def _scene(world: World) -> Any:
    """Returns the module that a world has beside its MuJoCo file."""
    path = world.to_mujoco().with_name("scene.py")
    spec = importlib.util.spec_from_file_location(f"d3dgen_scene_{world.name}", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} cannot be loaded")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


register()
