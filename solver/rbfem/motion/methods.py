"""The methods, as data: the coefficients that the one stepper in `advance` reads, and the facts everyone else reads."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """One row of the table.

    summary      : what it does, for the plan and the docs
    order        : of the global error on smooth loads
    nodes        : stage s is evaluated at the state y + nodes[s] dt k_(s-1) and the time t + nodes[s] dt
    weights      : y(t + dt) = y + dt Σ weights[s] k_s
    is_world     : the rotational variable is ω in world axes, else the angular momentum in body axes
    is_symplectic_euler : the new velocities move position and attitude (one stage only)
    normalizes   : the quaternion gets unit length after every step
    oscillation_limit : largest dt ω for which an undamped oscillation does not grow; 0 if it grows at every step
    source       : where the method is described
    """

    summary: str
    order: int
    nodes: tuple[float, ...]
    weights: tuple[float, ...]
    is_world: bool
    is_symplectic_euler: bool
    normalizes: bool
    oscillation_limit: float
    source: str

    @property
    def evaluations(self) -> int:
        """Load evaluations a step."""
        return len(self.weights)


_RK4_NODES = (0.0, 0.5, 0.5, 1.0)
_RK4_WEIGHTS = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
_RK4_LIMIT = 2.0 * 2.0**0.5

METHODS = {
    "rk4": Method(
        "classical Runge-Kutta on the stacked state, angular momentum in body axes",
        order=4,
        nodes=_RK4_NODES,
        weights=_RK4_WEIGHTS,
        is_world=False,
        is_symplectic_euler=False,
        normalizes=True,
        oscillation_limit=_RK4_LIMIT,
        source="Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, table II.1.2",
    ),
    "rk4_world": Method(
        "classical Runge-Kutta on the stacked state, angular velocity in world axes, quaternion left as it comes out",
        order=4,
        nodes=_RK4_NODES,
        weights=_RK4_WEIGHTS,
        is_world=True,
        is_symplectic_euler=False,
        normalizes=False,
        oscillation_limit=_RK4_LIMIT,
        source="Rigid body game physics, part 1, 24 October 2019",
    ),
    "semi_implicit_euler": Method(
        "velocities first, then positions with the new velocities; angular velocity in world axes",
        order=1,
        nodes=(0.0,),
        weights=(1.0,),
        is_world=True,
        is_symplectic_euler=True,
        normalizes=True,
        oscillation_limit=2.0,
        source="FEM for Rigid Body Dynamics: Quaternion-based Rotation Handling and Inertia Tensors, 20 April 2026",
    ),
    "euler": Method(
        "explicit Euler on the stacked state, angular momentum in body axes",
        order=1,
        nodes=(0.0,),
        weights=(1.0,),
        is_world=False,
        is_symplectic_euler=False,
        normalizes=True,
        oscillation_limit=0.0,
        source="Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section I.7",
    ),
}
