"""What is known of the error of the motion, and how it became known."""

import math
from dataclasses import dataclass

import numpy as np

COMPANION_TOLERANCE = 100.0  # times that of an adaptive run; its error is at least ten times that of the run
NOISE = 1e-12  # of a difference: it may be rounding
JUMP, STEEPEST = 30.0, 3.0  # a difference that grows by so much more than this power of time has jumped
LARGEST_TRUSTED = 0.1  # a larger difference is no longer small beside the motion: an angle cannot grow beyond π
SAFETY = 2.5  # the printed estimate is this times what Richardson makes of the difference


@dataclass
class MotionError:
    """What is known of the error of the motion: the largest difference from a companion run, over bodies and frames,
    and what Richardson makes of it.

    order      : by which the error falls with the step; 0 where there is no step
    ratio      : steps of the run for one of the companion, the smallest of all spans; 0 for an adaptive method
    position   : share of the bounding radius        attitude : rad
    rounding   : predicted, of attitudes and positions
    before     : estimate for the frames that a coarser attempt has given
    redone     : how often the run was begun again, finer
    has_jumped : whether the difference has grown at once as no power of time does
    first, latest : time and difference at the first and the latest stop
    unknown_because : why there is no estimate; empty where there is one
    """

    order: float
    ratio: float = math.inf
    position: float = 0.0
    attitude: float = 0.0
    rounding: float = 0.0
    before: float = 0.0
    redone: int = 0
    has_jumped: bool = False
    first: tuple[float, float] | None = None
    latest: tuple[float, float] | None = None
    unknown_because: str = "the run has not come to its first stop yet"

    @property
    def difference(self) -> float:
        """From the companion, the largest of any kind."""
        return max(self.position, self.attitude)

    @property
    def share(self) -> float:
        """Error of this run as a share of its difference from the companion; all of it where no power is trusted."""
        if self.has_jumped or self.difference > LARGEST_TRUSTED:
            return 1.0
        if self.ratio == 0.0:
            return 1.0 / (COMPANION_TOLERANCE**0.5 - 1.0)
        return 1.0 / (self.ratio**self.order - 1.0) if self.order else 0.0

    def note(self, time: float, position: float, attitude: float) -> None:
        """Take in the difference from the companion at a stop."""
        before, now = self.latest, (time, float(np.max([position, attitude])))
        self.position = float(np.maximum(self.position, position))
        self.attitude = float(np.maximum(self.attitude, attitude))
        if before is not None and now[1] > NOISE:
            self.has_jumped |= now[1] > JUMP * max(before[1], NOISE) * (time / before[0]) ** STEEPEST
        self.first, self.latest = self.first or now, now

    def magnified(self, time: float) -> float:
        """How many times more than time alone a difference has grown since the first stop: rounding grows alike."""
        if self.first is None or self.first[0] == time:
            return 1.0
        return max(1.0, self.difference / max(self.first[1], NOISE) * (self.first[0] / time) ** 2)

    @property
    def of_this_attempt(self) -> float | None:
        if self.unknown_because:
            return None
        return SAFETY * self.share * self.difference + self.rounding

    @property
    def estimated(self) -> float | None:
        here = self.of_this_attempt
        return None if here is None else max(self.before, here)

    @property
    def how(self) -> str:
        """How the estimate was made, in words."""
        if self.unknown_because:
            return self.unknown_because
        if not self.order:
            return "closed form: the predicted rounding"
        if self.share == 1.0:
            what = "has grown at once" if self.has_jumped else "is so large"
            return (
                f"{SAFETY:g} times the largest difference from a companion run, which {what} that no power of the step "
                "is trusted, and the predicted rounding"
            )
        if self.ratio == 0.0:
            times = f"{COMPANION_TOLERANCE:g} times the tolerance"
            return (
                f"a companion run at {times}: {SAFETY * self.share:.2g} of the difference, and the predicted rounding"
            )
        times = f"{self.ratio:.3g} times as long"
        count = "once" if self.redone == 1 else f"{self.redone} times"
        again = f"; begun again {count}, finer" if self.redone else ""
        return (
            f"Richardson: {SAFETY:g} times the largest difference from a companion run whose steps are {times}, over "
            f"{self.ratio:.3g}^{self.order:.3g} - 1, and the predicted rounding{again}"
        )
