"""Help texts of commands, shown as they are written."""

from __future__ import annotations

from copy import copy
from typing import Any

from typer.core import TyperCommand


class LiteralHelp(TyperCommand):
    """A command whose help may hold brackets.

    Rich would take a unit such as ``[rad]`` for markup, and leave it out.
    """

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help, with brackets escaped where rich writes it."""
        shown = copy(self)
        if self.rich_markup_mode == "rich":
            from rich.markup import escape

            shown.help = escape(self.help or "")
            shown.params = [copy(parameter) for parameter in self.params]
            for parameter in shown.params:
                parameter.help = escape(getattr(parameter, "help", None) or "")  # type: ignore[attr-defined]
        TyperCommand.format_help(shown, ctx, formatter)
