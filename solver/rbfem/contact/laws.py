"""Force laws of one contact, as plain scalar functions.

Two bodies overlap by δ along the normal n and approach with speed v; their points in contact slide on each other.
m* is the effective mass 1/(1/m_i + 1/m_j), R* the effective radius, E* and G* the effective moduli.
"""

import math

from rbfem.contact.model import (
    DAMPING,
    FORETOLD,
    FRICTION,
    HERTZ,
    LAST_STIFFNESS,
    LAW,
    NORMAL,
    SHEAR,
    TANGENTIAL,
)

ROOT_5 = math.sqrt(5.0)


def normal_stiffness(law, modulus, overlap, radius):
    """k_n, by which the elastic force is k_n δ: a constant (linear), or 4/3 E* √(R* δ) (Hertz).

    >>> normal_stiffness(HERTZ, 3.0, 0.01, 1.0)
    0.4
    """
    return 4.0 / 3.0 * modulus * math.sqrt(radius * overlap) if law == HERTZ else modulus


def tangential_stiffness(law, modulus, overlap, radius):
    """k_t, by which a slide of du changes the tangential force by k_t du: a constant, or 8 G* √(R* δ) (Mindlin).

    >>> tangential_stiffness(HERTZ, 3.0, 0.01, 1.0)
    2.4000000000000004
    """
    return 8.0 * modulus * math.sqrt(radius * overlap) if law == HERTZ else modulus


def elastic_energy(law, stiffness, overlap):
    """Energy of the normal spring: ½ k_n δ² (linear), 2/5 k_n δ² = 8/15 E* √R* δ^(5/2) (Hertz).

    >>> elastic_energy(HERTZ, 10.0, 0.5)
    1.0
    """
    return (0.4 if law == HERTZ else 0.5) * stiffness * overlap * overlap


def elastic_force(law, stiffness, overlap, travel):
    """k_n δ; half of it and a half of δ/|v|Δt where the bodies have met within the last step, or part within the next.

    Between instants the step keeps ½ k δ_n δ_(n+1) + ½ m v² of a linear spring. Where the earlier or the later of the
    two is a gap this number begins or ends with the wrong value, unless the force is k δ (½ + ½ δ/|v|Δt) there: then an
    elastic impact gives back just the speed that it took. Hertz's law begins so softly that it does not matter.

    >>> elastic_force(HERTZ, 2.0, 0.1, 0.2), elastic_force(0.0, 2.0, 0.1, 0.2)
    (0.2, 0.15000000000000002)
    """
    force = stiffness * overlap
    return force if law == HERTZ or overlap >= travel else force * (0.5 + 0.5 * overlap / travel)


def damping_coefficient(law, ratio, stiffness, mass, overlap, travel, dt):
    """c of the dashpot's force c v: 2 ζ √(k_n m*) (linear) or √5 ζ √(k_n m*) (Hertz).

    Where bodies have met within the last step, or part within the next, the dashpot acts over less or more than a whole
    step. What it takes is ∫ c dδ over the overlaps that there have been, whatever the speed; its mean over the step is
    c (½ + δ/|v|Δt) for a constant c and that much of c ∝ δ^(1/4) for Hertz. This makes the restitution of second order
    in the step: without it the moment of contact, known to half a step only, leaves an error of first order. A linear
    contact is damped by κ²/5 more, κ² = k Δt²/m*: what its two ends and its shorter period lose (measured).

    travel : |v| Δt, m     returns : kg/s
    """
    if law == HERTZ:
        c = ROOT_5 * ratio * math.sqrt(stiffness * mass)
        if overlap >= travel:
            return c
        ahead = 1.0 + 0.5 * travel / overlap
        return c * 0.8 * ahead * math.sqrt(math.sqrt(ahead)) * overlap / travel
    c = 2.0 * ratio * math.sqrt(stiffness * mass) * (1.0 + 0.2 * stiffness * dt * dt / mass)
    return c if overlap >= travel else c * (0.5 + overlap / travel)


def touch(
    nx, ny, nz, curvature, overlap, ux, uy, uz, sx, sy, sz, spin, mass, radius, dt, row, laws, k, touches, memory
):
    """One contact at one instant: its force, and its memory carried on by a step.

    The elastic force k_n δ is that of this instant. The dashpot acts on the approach speed of this instant, half a step
    ahead of the speeds that are known: v = v₋ + ½ (v₋ - foretold) - ½ Δt f / m*. The difference is what other contacts
    and loads did to the approach in the step before, the last term what this contact does now; solved for f this gives
    f = (k_n δ + c (v₋ + ½ (v₋ - foretold))) / (1 + ½ c Δt / m*). A contact does not pull: f ≥ 0.

    The tangential force follows the slide by k_t, turns with the normal and about it with the bodies, falls with k_t
    where the contact opens, and is capped at friction times the whole normal force f.

    n            : normal, from the other body to this one     curvature : 1/m, how fast it turns as they move across it
    u            : velocity of this body's centre seen from the other's
    s            : Σ arm ω of both, so that the points in contact slide by u - (u·n) n - s × n
    spin         : rad/s, of both about the normal, mean       mass, radius : m*, R*
    row          : of `laws`                                   k : of `touches` and `memory`
    returns : f, tangential force (3) on this body, energy that the dashpot takes in this step, and friction
    Source: Thornton, Cummins, Cleary, Powder Technology 233:30, 2013, for the tangential spring of Hertz's law.
    """
    law, is_old = laws[row, LAW], touches[k] != 0
    away = ux * nx + uy * ny + uz * nz
    stiffness = normal_stiffness(law, laws[row, NORMAL], overlap, radius)
    c = damping_coefficient(law, laws[row, DAMPING], stiffness, mass, overlap, abs(away) * dt, dt)
    ahead = -1.5 * away - 0.5 * memory[k, FORETOLD] if is_old else -away
    elastic = elastic_force(law, stiffness, overlap, abs(away) * dt)
    normal = max((elastic + c * ahead) / (1.0 + 0.5 * dt * c / mass), 0.0)
    change = dt * normal / mass
    memory[k, FORETOLD] = -away - change
    by_damping = (normal - elastic) * (ahead - 0.5 * change) * dt

    ux, uy, uz = ux - away * nx, uy - away * ny, uz - away * nz
    gx, gy, gz, by_friction = 0.0, 0.0, 0.0, 0.0
    k_t = tangential_stiffness(law, laws[row, TANGENTIAL], overlap, radius)
    if is_old:
        gx, gy, gz = memory[k, SHEAR], memory[k, SHEAR + 1], memory[k, SHEAR + 2]
        along, about = gx * nx + gy * ny + gz * nz, dt * spin
        tilt = 0.5 * along * dt * curvature
        gx, gy, gz = gx + tilt * ux - along * nx, gy + tilt * uy - along * ny, gz + tilt * uz - along * nz
        kept = 1.0 - 0.5 * about * about  # or the force would grow as it turns
        gx, gy, gz = (
            kept * gx + about * (ny * gz - nz * gy),
            kept * gy + about * (nz * gx - nx * gz),
            kept * gz + about * (nx * gy - ny * gx),
        )
        before = memory[k, LAST_STIFFNESS]
        if k_t != before:  # opening takes some of the force and closing stiffens the spring: both lose energy
            share = min(1.0, k_t / before)
            by_friction = 0.5 * (1.0 / before - share * share / k_t) * (gx * gx + gy * gy + gz * gz)
            gx, gy, gz = share * gx, share * gy, share * gz
    slide, turn = k_t * dt, 0.5 * dt * curvature * (sx * nx + sy * ny + sz * nz)
    # u and s are those of half a step ago: (s × n) of then, in the plane of now, is s × n - turn (n × u)
    hx = gx - slide * (ux - (sy * nz - sz * ny) + turn * (ny * uz - nz * uy))
    hy = gy - slide * (uy - (sz * nx - sx * nz) + turn * (nz * ux - nx * uz))
    hz = gz - slide * (uz - (sx * ny - sy * nx) + turn * (nx * uy - ny * ux))
    limit, squared = laws[row, FRICTION] * normal, hx * hx + hy * hy + hz * hz
    if squared > limit * limit:
        share = limit / math.sqrt(squared)
        cx, cy, cz = share * hx, share * hy, share * hz
        slip = 0.5 * (1.0 - share) / k_t
        by_friction += slip * (hx * (gx + cx) + hy * (gy + cy) + hz * (gz + cz))
        hx, hy, hz = cx, cy, cz
    memory[k, SHEAR], memory[k, SHEAR + 1], memory[k, SHEAR + 2] = hx, hy, hz
    memory[k, LAST_STIFFNESS] = k_t
    touches[k] = 1
    return normal, hx, hy, hz, by_damping, by_friction
