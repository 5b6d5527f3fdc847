"""A work-precision study in words: a row for each method, and what to know when reading it."""

import math
from collections.abc import Iterator

from rbfem.study.work_precision import Point, WorkPrecision

HEAD = ("method", "step, s", "evaluations", "seconds", "error", "order here", "in table")


def by_cost(study: WorkPrecision) -> list[str]:
    """The methods: those that keep the accuracy by their evaluations, then the others by the best error they reach."""

    def key(method: str) -> tuple[bool, float]:
        best = study.cheapest_within(method)
        return (best is None, min(p.error for p in study.of(method)) if best is None else best.evaluations)

    return sorted(study.methods, key=key)


def rows(study: WorkPrecision) -> Iterator[tuple[str, ...]]:
    """For each method its run with the fewest evaluations within the accuracy, under `HEAD`."""
    for method in by_cost(study):
        best = study.cheapest_within(method)
        orders = (order_words(study.order(method)), stated_words(study.orders[method]))
        if best is None:
            reached = min(point.error for point in study.of(method))
            yield (method, "none", "", "", f"≥ {reached:.1e}", *orders)
        else:
            step = step_words(best) if best.tolerance is None else f"tolerance {best.tolerance:g}"
            yield (method, step, f"{best.evaluations}", f"{best.seconds:.2g}", f"{best.error:.1e}", *orders)


def order_words(order: float | None) -> str:
    """An order as it is shown; a dash where too few runs show one.

    >>> order_words(3.987), order_words(None)
    ('4.0', '–')
    """
    return "–" if order is None else f"{order:.1f}"


def stated_words(order: float) -> str:
    """An order as the table of methods states it.

    >>> stated_words(4), stated_words(math.inf)
    ('4', '∞')
    """
    return "∞" if math.isinf(order) else f"{order:g}"


def step_words(point: Point) -> str:
    """The step of a run; for an adaptive method the mean one and the tolerance that brought it about."""
    return f"{point.step:.3g}" + ("" if point.tolerance is None else f" (tolerance {point.tolerance:g})")


def notes(study: WorkPrecision) -> Iterator[tuple[str, str]]:
    """Labels and words: what the plan's own run came to, the reference, what is unstable and what does not apply."""
    chosen = study.chosen
    verdict = "within" if chosen.is_stable and chosen.error <= study.accuracy else "ABOVE"
    yield (
        "auto" if study.is_auto else "as asked",
        f"{chosen.method}, step {step_words(chosen)} s: error {chosen.error:.2g}, {verdict} the {study.accuracy:g} "
        f"accepted; {chosen.evaluations} evaluations and {chosen.seconds:.2g} s with pilot and check, which "
        "the table is without",
    )
    yield (
        "signs",
        "order here: by which the errors of this case fall with the step, – where too few runs show one; ≥: no run of "
        "the method is within, this is its smallest error",
    )
    yield "reference", f"{study.reference}; other methods agree with it to {study.floor:.1g}"
    wild = [f"{method} ({_longest_stable(study, method)})" for method in study.methods if _is_unstable(study, method)]
    none = "nothing: the outputs cut every step short enough; --set output.every=… asks for fewer"
    yield "unstable", f"at longer steps: {', '.join(wild)}" if wild else none
    for reason in dict.fromkeys(study.left_out.values()):
        yield "left out", ", ".join(name for name, why in study.left_out.items() if why == reason) + f": {reason}"


def _is_unstable(study: WorkPrecision, method: str) -> bool:
    return not all(point.is_stable for point in study.of(method))


def _longest_stable(study: WorkPrecision, method: str) -> str:
    stable = [point.step for point in study.of(method) if point.is_stable]
    return f"stable from {max(stable):.3g} s" if stable else "never stable"
