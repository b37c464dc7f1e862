"""Links placed by rotation, position and axis, written as robot TOML."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array

KINDS = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M")

DUST = 16 * np.finfo(float).eps
"""A rotation made of a quaternion has errors of some eps in entries that are 0 or 1."""


@dataclass
class Link:
    """A link: its joint, its frame on the link it hangs on (None: the base), its body.

    `inertia` holds the paper's ten parameters about the origin of the link's frame.
    """

    name: str
    antecedent: str | None
    joint: str
    joint_name: str
    rotation: Array
    origin: Array
    axis: Array
    inertia: Array = field(default_factory=lambda: np.zeros(10))
    armature: float = 0.0
    active: bool = True


@dataclass
class Couple:
    """A joint that follows from others: q = offset + sum of multiplier * q(link)."""

    joint: str
    terms: dict[str, float]
    offset: float


@dataclass
class Loop:
    """A cut joint between two links (None: the base): a rotation and a point on each."""

    between: tuple[str | None, str | None]
    frames: tuple[tuple[Array, Array], tuple[Array, Array]]
    cut: str


def moved(ten: Array, rotation: Array, p: Array) -> Array:
    """Return the ten parameters of a body in the frame in which its own is placed so."""
    xx, xy, xz, yy, yz, zz, *first, mass = ten
    tensor = rotation @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ rotation.T
    s = rotation @ np.array(first)
    one = np.eye(3)
    tensor = tensor + 2 * (p @ s) * one - np.outer(p, s) - np.outer(s, p)
    tensor = tensor + mass * ((p @ p) * one - np.outer(p, p))
    upper = tensor[np.triu_indices(3)]
    return np.array([*upper, *(s + mass * p), mass])


def roll_pitch_yaw(rotation: Array) -> tuple[float, float, float]:
    """Angles about fixed axes, URDF's; right angles come out as such."""
    whole = np.round(rotation)
    r = np.where(np.abs(rotation - whole) <= DUST, whole, rotation)
    level = np.hypot(r[2, 1], r[2, 2])
    roll = float(np.arctan2(r[2, 1], r[2, 2])) if level > 0 else 0.0
    pitch = float(np.arctan2(-r[2, 0], level))
    # Near the pole roll is known badly: yaw is taken from what this roll leaves.
    sin, cos = np.sin(roll), np.cos(roll)
    if float(2 * roll / np.pi).is_integer():
        sin, cos = np.round(sin), np.round(cos)
    yaw = float(np.arctan2(sin * r[0, 2] - cos * r[0, 1], cos * r[1, 1] - sin * r[1, 2]))
    return roll, pitch, yaw


def toml(
    name: str,
    gravity: Sequence[float],
    links: Sequence[Link],
    couples: Sequence[Couple],
    loops: Sequence[Loop] = (),
    warnings: Sequence[str] = (),
) -> str:
    """Write robot TOML; what was left out goes along as its warnings."""
    lines = [f"name = {string(name)}", f"gravity = {vector(gravity)}"]
    if warnings:
        lines.append(f"warnings = [{', '.join(map(string, warnings))}]")
    for link in links:
        antecedent = "base" if link.antecedent is None else link.antecedent
        values = ", ".join(
            f"{kind} = {number(x)}" for kind, x in zip(KINDS, link.inertia, strict=True)
        )
        driven = link.joint != "floating" and link.armature
        rotor = f", Ia = {number(link.armature)}" if driven else ""
        lines += [
            "",
            "[[link]]",
            f"name = {string(link.name)}",
            f"antecedent = {string(antecedent)}",
            f"joint = {string(link.joint)}",
            f"joint_name = {string(link.joint_name)}",
            f"xyz = {vector(link.origin)}",
            f"rpy = {vector(roll_pitch_yaw(link.rotation))}",
            f"axis = {vector(link.axis)}",
            f"inertia = {{ {values}{rotor} }}",
        ]
        if not link.active:
            lines += ["active = false", f"rotor = {'true' if link.armature else 'false'}"]
    for couple in couples:
        terms = ", ".join(f"{string(link)} = {number(x)}" for link, x in couple.terms.items())
        lines += [
            "",
            "[[couple]]",
            f"joint = {string(couple.joint)}",
            f"equals = {{ {terms} }}",
            f"offset = {number(couple.offset)}",
        ]
    moving = (link for link in links if link.joint != "floating")
    near = ", ".join(f"{string(link.name)} = 0" for link in moving)
    for loop in loops:
        between = ", ".join(string("base" if link is None else link) for link in loop.between)
        frames = ", ".join(
            f"{{ xyz = {vector(point)}, rpy = {vector(roll_pitch_yaw(rotation))} }}"
            for rotation, point in loop.frames
        )
        lines += [
            "",
            "[[loop]]",
            f"between = [{between}]",
            f"frames = [{frames}]",
            f"cut = {string(loop.cut)}",
            f"near = {{ {near} }}",
        ]
    return "\n".join(lines) + "\n"


def vector(numbers: Sequence[float] | Array) -> str:
    """Write numbers as a TOML array."""
    return f"[{', '.join(number(x) for x in numbers)}]"


def number(x: float) -> str:
    """Write a number so that it reads back the same."""
    return repr(float(x) + 0.0)


def string(text: str) -> str:
    """Write a TOML string: JSON's escapes are TOML's, but for the surrogates."""
    quoted = json.dumps(text, ensure_ascii=False)
    return quoted.replace("\x7f", "\\u007f")


def unique(name: str, taken: set[str]) -> str:
    """Return the name, or the name with a number where another link has it."""
    free, number = name, 2
    while free in taken or free == "base":
        free, number = f"{name}_{number}", number + 1
    taken.add(free)
    return free
