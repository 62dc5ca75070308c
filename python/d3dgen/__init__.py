"""Simulator-ready, robot-ready indoor worlds from a sentence, checked against citable building rules.

>>> import d3dgen
>>> world = d3dgen.generate("studio flat in Germany", seed=1)
>>> world.sound
True
"""

from ._command import Refused, Unsound, program
from ._world import Door, Object, Report, Room, World, brief, check, generate, load

__all__ = [
    "Door",
    "Object",
    "Refused",
    "Report",
    "Room",
    "Unsound",
    "World",
    "brief",
    "check",
    "generate",
    "load",
    "program",
]
