"""Status of a fitted chain: whether it may be used, and why."""

from __future__ import annotations

from enum import StrEnum

from isotorque.symbolic.common.errors import InputError


class FitStatus(StrEnum):
    """End of the search for a chain.

    That several starts end in the same chain proves nothing: wide false minima are found again
    and again. Only a residual as small as the noise, or as rounding, speaks for a chain.
    """

    ROUNDING = "explains all samples to rounding"
    CHI_SQUARE = "explains all samples within the noise that was stated"
    HELD_OUT = "predicts samples that were left out of the fit"
    TOO_FEW = "too few samples"
    AMBIGUOUS = "chains that differ elsewhere explain the samples equally well"
    MISFIT = "no chain that was found explains the samples"

    @property
    def accepted(self) -> bool:
        """Whether the chain may be used."""
        return self in (FitStatus.ROUNDING, FitStatus.CHI_SQUARE, FitStatus.HELD_OUT)


class NotAccepted(InputError):
    """A chain that was not accepted was asked for what it would say.

    Parameters
    ----------
    verdict : FitStatus
        Why it was not accepted.
    remark : str
        What is missing or speaks against it.
    """

    def __init__(self, verdict: FitStatus, remark: str) -> None:
        self.verdict = verdict
        accepted = remark or "samples of a rigid arm"
        super().__init__("rigid chain", "fit", f"not accepted: {verdict}", accepted)
