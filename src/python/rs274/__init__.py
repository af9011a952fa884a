"""Helpers for previews of G-code programs, on top of the module gcode."""
import pkgutil

# Screens of an installed LinuxCNC name parts of its own package of this name (drawing, tools); those come from there.
__path__ = pkgutil.extend_path(__path__, __name__)

from rs274.interpret import ArcsToSegmentsMixin, Translated  # noqa: E402  (the path first)

__all__ = ["ArcsToSegmentsMixin", "Translated", "interpret"]
