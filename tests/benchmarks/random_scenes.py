"""Random scenes of smooth motion: tops, springs, drag, gradients of a field, and mixtures of them."""

import json
from pathlib import Path

import numpy as np

import rbfem

KINDS = ("top", "spring", "drag", "gradient", "mixture")
FRAMES = 8


def random_scene(seed: int, folder: Path) -> rbfem.Scene:
    """Scene number `seed`: its kind in turn, everything else at random, the accuracy between 1e-3 and 1e-10."""
    random = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    bodies = _MAKERS[kind](random)
    end = float(random.uniform(1.0, 6.0))
    case = {
        "rbfem": 1,
        "title": f"{kind} {seed}",
        "accuracy": float(10.0 ** random.uniform(-10.0, -3.0)),
        "shapes": {f"box{i}": {"box": {"size": random.uniform(0.1, 0.4, 3).tolist()}} for i in range(len(bodies))},
        "materials": {"wood": {"density": 700}},
        "bodies": [
            {"name": f"body{i}", "shape": f"box{i}", "material": "wood", **body} for i, body in enumerate(bodies)
        ],
        "gravity": [0, 0, -9.81],
        "time": {"end": end},
        "output": {"every": end / FRAMES},
    }
    path = folder / f"random_{seed}.yaml"
    path.write_text(json.dumps(case))
    return rbfem.load(path)


def _spin(random, fastest: float) -> list[float]:
    return (random.normal(size=3) * fastest * random.uniform(0.1, 1.0) / 3.0**0.5).tolist()


def _attitude(random) -> list[float]:
    q = random.normal(size=4)
    return (q / np.linalg.norm(q)).tolist()


def _top(random) -> list[dict]:
    arm = random.normal(size=3)
    pivot = arm / np.linalg.norm(arm) * random.uniform(0.1, 0.3)
    return [{"pivot": pivot.tolist(), "quaternion": _attitude(random), "angular_velocity": _spin(random, 30.0)}]


def _spring(random, damping: float = 0.0) -> list[dict]:
    """Hung from above, by a spring without length or by one that its weight stretches."""
    above = np.array([*random.uniform(-0.3, 0.3, 2), random.uniform(0.6, 1.0)])
    spring = {
        "at": random.uniform(-0.15, 0.15, 3).tolist(),
        "to": above.tolist(),
        "stiffness": float(10.0 ** random.uniform(1.5, 3.5)),
        "damping": damping,
        "rest_length": float(random.choice([0.0, 0.9 * np.linalg.norm(above)])),
    }
    return [{"quaternion": _attitude(random), "angular_velocity": _spin(random, 10.0), "loads": [{"spring": spring}]}]


def _drag(random) -> list[dict]:
    loads = [
        {"drag": {"linear": float(random.uniform(0.1, 5.0)), "angular": float(10.0 ** random.uniform(-3.0, -1.5))}},
        {"torque": (random.normal(size=3) * 0.3).tolist(), "frame": "body"},
    ]
    return [{"velocity": random.normal(size=3).tolist(), "angular_velocity": _spin(random, 20.0), "loads": loads}]


def _gradient(random) -> list[dict]:
    """A satellite, thrown around by the gradient of the field."""
    normal, other = random.normal(size=(2, 3))
    start = np.cross(normal, other)
    rate = float(random.uniform(0.5, 3.0))
    field = {"rate": rate, "normal": normal.tolist(), "start": start.tolist()}
    spin = _spin(random, 3.0 * rate)
    return [{"quaternion": _attitude(random), "angular_velocity": spin, "loads": [{"gravity_gradient": field}]}]


def _mixture(random) -> list[dict]:
    """Two bodies joined by a spring, one of them hung and damped, the other under a torque that comes and goes."""
    first, second = _spring(random, float(random.uniform(0.0, 3.0))) + _drag(random)
    link = {"at": [0.05, 0, 0], "to": {"body": "body1", "at": [0, 0.05, 0]}}
    first["loads"].append({"spring": link | {"stiffness": float(10.0 ** random.uniform(1.0, 2.5)), "rest_length": 0.3}})
    second["loads"][1]["ramp"] = [[0, 0], [0.5, 1], [0.8, 0.2]]
    second["position"] = [0.5, 0.3, 0.0]
    return [first, second]


_MAKERS = {"top": _top, "spring": _spring, "drag": _drag, "gradient": _gradient, "mixture": _mixture}
