"""A section that somebody else adds to the report of a lift: text, tables and figures, ready to print."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure


@dataclass(frozen=True)
class SectionTable:
    """One table.

    Attributes:
        head: titles of its columns; the first is the table's own.
        rows: one text a column.
        words: how many columns hold words, the others numbers.
    """

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: int = 1


@dataclass(frozen=True)
class SectionFigure:
    """One figure: a name that no other figure of the page has, what it shows, and the drawing."""

    name: str
    caption: str
    figure: Figure


@dataclass(frozen=True)
class ReportSection:
    """One section.

    Attributes:
        name: its address in the page, ``"experiment"``; no other section has it.
        title: its heading.
        holds: what a reader finds there, as the page's first paragraph says it: ``"what was measured"``.
        text: its first paragraph.
        tables, figures: in order, the tables first.
        notes_title: heading of the notes.
        notes: what a reader must know, one sentence each.
    """

    name: str
    title: str
    holds: str
    text: str
    tables: tuple[SectionTable, ...] = ()
    figures: tuple[SectionFigure, ...] = ()
    notes_title: str = "Notes"
    notes: tuple[str, ...] = ()
