"""What a reader of a result should know, as facts rather than sentences alone."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Note:
    """One note.

    Args:
        code: what kind of note it is, a word that never changes, such as "beyond-law".
        text: the sentence for people.
        joint: the joint that it is about; "" for the whole structure.
        load: the preload of the first bolt [N] at which it holds; None for all.
        share: the share of the joint's area that it concerns [-]; None where that means nothing.
    """

    code: str
    text: str
    joint: str = ""
    load: float | None = None
    share: float | None = None

    def __str__(self) -> str:
        return self.text
