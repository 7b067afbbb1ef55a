"""The error of bad input."""


class PlotError(Exception):
    """Input that cannot be drawn; its text is the whole message to the user."""
