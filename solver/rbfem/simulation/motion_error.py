"""What is known of the error of the motion, and how it became known."""

import math
from dataclasses import dataclass

COMPANION_TOLERANCE = 100.0  # times that of an adaptive run; its error is at least ten times that of the run
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
    unknown_because : why there is no estimate; empty where there is one
    """

    order: float
    ratio: float = math.inf
    position: float = 0.0
    attitude: float = 0.0
    rounding: float = 0.0
    before: float = 0.0
    redone: int = 0
    unknown_because: str = "the run has not come to its first stop yet"

    @property
    def share(self) -> float:
        """Error of this run as a share of its difference from the companion."""
        if self.ratio == 0.0:
            return 1.0 / (COMPANION_TOLERANCE**0.5 - 1.0)
        return 1.0 / (self.ratio**self.order - 1.0) if self.order else 0.0

    @property
    def of_this_attempt(self) -> float | None:
        if self.unknown_because:
            return None
        return SAFETY * self.share * max(self.position, self.attitude) + self.rounding

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
